//! A mesh that was refined for one contact, and what it costs another.

use std::sync::Arc;
use std::time::Instant;

use crate::contact::error::ContactError;
use crate::contact::figures::accuracy::Accuracy;
use crate::contact::figures::area::cells::mean_edge;
use crate::contact::in_place::Known;
use crate::contact::outcome::{Contact, ContactStatus, Patch, RefinementEnd};
use crate::contact::refine::estimate::ErrorEstimate;
use crate::contact::refine::mark::too_large;
use crate::contact::refine::meshes::{Meshes, is_of_another_size};
use crate::contact::refine::rounds::FEW_NODES;
use crate::contact::scene::{Inherited, Touch};
use crate::response::skin::elastic::ElasticSkin;
use crate::response::skin::kept::KeptMatrices;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

const REFINED: &str = "a contact on a refined mesh";
/// A contact that would come to so many times the nodes of that one gets a mesh of its own.
const MORE_NODES: f64 = 1.5;

/// A contact on a refined mesh that the next one begins from.
pub(crate) struct WarmMesh {
    /// The last one is that of the contact.
    pub meshes: Meshes,
    pub refined_for: RefinedFor,
    /// On the refined mesh.
    pub touch: Touch,
    pub inherited: Arc<Inherited>,
    pub kept: Arc<KeptMatrices>,
    pub known: Option<Known>,
}

/// The contact that a mesh was refined for.
pub(crate) struct RefinedFor {
    accuracy: Accuracy,
    /// Its area (m²).
    area: f64,
    nodes: usize,
    /// Whether a sharp edge carried force.
    is_on_edge: bool,
    /// Mean length of the edges of its triangles, and of those at the rim (m).
    edge: f64,
    rim_edge: f64,
    /// How long those at the rim may be with the target met (m).
    longest: f64,
}

impl RefinedFor {
    /// `None` where there is no estimate, or no room for more nodes.
    ///
    /// * `target`: of the relative error
    pub fn new(surface: &Surface, contact: &Contact, target: f64, max_nodes: usize) -> Option<Self> {
        let [of_force, of_area] = ErrorEstimate::room(contact, target)?;
        let (edge, rim_edge) = (mean_edge(surface, &contact.active), rim_edge(surface, contact));
        let nodes = contact.candidates.len();
        (MORE_NODES * nodes as f64 <= max_nodes as f64).then(|| Self {
            accuracy: contact.accuracy.clone(),
            area: contact.resultant.contact_area,
            nodes,
            is_on_edge: contact.clues.edge.is_some(),
            edge,
            rim_edge,
            longest: (of_force * edge).min(of_area * rim_edge),
        })
    }
}

impl WarmMesh {
    pub fn last(&self) -> (&RefinedSurface, &Contact) {
        let (part, contact) = self.meshes.last.as_ref().expect(REFINED);
        (part, contact)
    }

    pub fn put_contact(&mut self, contact: Contact) {
        self.meshes.last.as_mut().expect(REFINED).1 = contact;
    }

    pub fn put_part(&mut self, part: RefinedSurface) {
        self.meshes.last.as_mut().expect(REFINED).0 = part;
    }

    /// Whether the mesh was made for a contact of about that size, on no sharp edge more, and leaves no penetration between its
    /// nodes that more of them would end.
    pub fn serves(&self, contact: &Contact) -> bool {
        let nodes = contact.candidates.len();
        contact.status == ContactStatus::Solved
            && (contact.clues.edge.is_none() || self.refined_for.is_on_edge)
            && contact.clues.unfelt.is_empty()
            && (contact.is_free_of_penetration() || nodes > FEW_NODES)
            && !is_of_another_size(contact.resultant.contact_area, self.refined_for.area)
            && nodes <= self.most_nodes()
    }

    /// Whether a contact at a depth (m) is likely to come to too many nodes: they grow with the depth at least, as the area does
    /// under a ball.
    pub fn is_outgrown_at(&self, depth: f64) -> bool {
        let last = &self.last().1;
        let growth = last.depth.map_or(1.0, |before| depth / before);
        growth * last.candidates.len() as f64 > self.most_nodes() as f64
    }

    /// What the mesh costs a contact; `Err` with the edges (m) to cut longer ones to where its rim is too coarse.
    pub fn error(&self, contact: &Contact) -> Result<Option<ErrorEstimate>, f64> {
        let known = &self.refined_for;
        let scale = (contact.resultant.contact_area / known.area).sqrt();
        let rim_edge = rim_edge(&self.last().0.surface, contact) / scale;
        if rim_edge > known.longest {
            // With some way to go until they are too long again.
            return Err(scale * (known.rim_edge * known.longest).sqrt());
        }
        Ok(ErrorEstimate::carried_over(&known.accuracy, rim_edge / known.edge, rim_edge / known.rim_edge))
    }

    /// Cuts the triangles at the rim of a contact with edges longer than so many m; whether the nodes stay few enough.
    pub fn cut(&mut self, contact: &Contact, longest: f64) -> bool {
        let (part, _) = self.last();
        let at_rim = |&vertex: &usize| is_at_rim(&part.surface, contact, vertex);
        let rim: Vec<usize> = contact.active.iter().copied().filter(at_rim).collect();
        let near = part.numbers(&part.surface.k_ring(&rim, 1));
        let known = self.meshes.mesh.added_count();
        self.meshes.mesh.refine(&too_large(&self.meshes.mesh, |vertex| {
            near.binary_search(&vertex).is_ok().then_some(longest)
        }));
        contact.candidates.len() + self.meshes.mesh.added_count() - known <= self.most_nodes()
    }

    fn most_nodes(&self) -> usize {
        (MORE_NODES * self.refined_for.nodes as f64) as usize
    }

    /// The contact in the numbers of the whole skin.
    pub fn conclude(
        &mut self,
        mut contact: Contact,
        error: Option<ErrorEstimate>,
        started: Instant,
        target: f64,
        skin: &dyn ElasticSkin,
    ) -> Result<Contact, ContactError> {
        contact.note_round(error, started);
        self.put_contact(contact);
        self.meshes.clone().conclude(RefinementEnd::Target, target, skin)
    }
}

/// Whether a vertex lies beside one without force.
fn is_at_rim(surface: &Surface, contact: &Contact, vertex: usize) -> bool {
    surface.neighbours(vertex).iter().any(|&other| contact.node_force[other as usize] == 0.0)
}

/// Mean length of the edges along the rim of the patch where that is largest (m).
fn rim_edge(surface: &Surface, contact: &Contact) -> f64 {
    let along = |patch: &Patch| {
        let at_rim = patch.vertices.iter().filter(|&&vertex| is_at_rim(surface, contact, vertex));
        let lengths = at_rim.flat_map(|&vertex| surface.edge_lengths(vertex));
        // Each stands for as much of the rim as it is long.
        let (squares, sum) = lengths.fold((0.0, 0.0), |(squares, sum), l| (squares + l * l, sum + l));
        squares / sum
    };
    contact.patches.iter().map(along).fold(0.0, f64::max)
}
