//! A whole hand: solved bodies where there are some, a kernel everywhere else.
//!
//! Parts of the skin, such as fingers cut out by [`cut_out`](crate::surface::cut_out()), answer with the compliance of their
//! body; the rest answers with a kernel. Forces on a part move that part alone, forces elsewhere move the rest alone:
//! across a cut nothing is felt, as each body is held there. So a connected patch of candidates must lie on one
//! side of every cut; one that straddles is an error that names the part.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Isometry3, Vector3};

use crate::response::body::levels::coarseness::BodyDoubt;
use crate::response::body::levels::on_mesh::BodyOnMesh;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::kernel::skin::KernelSkin;
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::response::skin::pieces::{Piece, Pieces};
use crate::response::skin::prepared_body::PreparedBody;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// Largest distance, in mean edge lengths, between a part's vertices and those of the whole skin.
const SAME_PLACE_DISTANCE: f64 = 1e-6;

/// A part of the skin with the compliance of its body.
#[derive(Debug, Clone)]
pub struct Part {
    /// For messages.
    pub name: String,
    /// The body's compliance, prepared for the part's own surface.
    pub prepared: PreparedBody,
    /// For each vertex of the whole skin its vertex in the part, if it belongs to it.
    pub part_vertices: Vec<Option<usize>>,
    /// Vertices of the part that do not move with the body: its cut, rim included. Those of the whole skin answer
    /// with the kernel.
    pub fixed: Vec<bool>,
}

impl Part {
    /// Vertex of the part that moves with the body.
    fn moving(&self, vertex: usize) -> Option<usize> {
        self.part_vertices[vertex].filter(|&own| !self.fixed[own])
    }

    fn check(&self, surface: &Surface) -> Result<(), ResponseError> {
        let mismatch = |what: String| ResponseError::PartMismatch { part: self.name.clone(), what };
        let (found, expected) = (self.part_vertices.len(), surface.vertices().len());
        if found != expected {
            return Err(mismatch(format!("{found} entries for the {expected} vertices of the whole skin")));
        }
        let own_count = self.prepared.nodes().vertices().len();
        if self.fixed.len() != own_count {
            return Err(mismatch(format!(
                "{} entries tell which of its {own_count} vertices are fixed",
                self.fixed.len()
            )));
        }
        let allowed = SAME_PLACE_DISTANCE * surface.mean_edge_length();
        for (vertex, own) in self.part_vertices.iter().enumerate() {
            let Some(own) = *own else { continue };
            let place = self.prepared.nodes().vertices().get(own);
            let place = place.ok_or_else(|| mismatch(format!("vertex {own} of {own_count}")))?;
            let distance = (surface.vertices()[vertex] - place).norm();
            if distance > allowed {
                return Err(mismatch(format!(
                    "its vertex {own} is {distance:.3e} m from vertex {vertex} of the whole skin (allowed \
                     {allowed:.1e} m); move the part with the skin"
                )));
            }
        }
        Ok(())
    }
}

/// Bodies on parts of a skin, a kernel elsewhere; goes wherever a [`KernelSkin`] goes.
#[derive(Debug, Clone)]
pub struct CombinedSkin {
    background: KernelSkin,
    parts: Vec<Part>,
    /// Number of the part that each vertex moves with.
    owner: Arc<[Option<usize>]>,
}

impl CombinedSkin {
    /// Joins parts of `surface` with the kernel `background`.
    ///
    /// # Errors
    /// - [`ResponseError::PartMismatch`]: a part does not fit the surface, is no body, or shares vertices with another
    /// - [`ResponseError::PartsNeedLinear`]: the kernel or a part averages gaps, or the kernel spreads forces over one-rings
    pub fn new(surface: &Surface, background: KernelSkin, parts: Vec<Part>) -> Result<Self, ResponseError> {
        let of_parts = parts.iter().map(|part| part.prepared.own_traits().discretization);
        let mut all = of_parts.chain([background.discretization()]);
        if all.any(|one| one != Discretization::Collocation) || background.basis() != PressureBasis::Linear {
            return Err(ResponseError::PartsNeedLinear);
        }
        let mut owner: Vec<Option<usize>> = vec![None; surface.vertices().len()];
        for (number, part) in parts.iter().enumerate() {
            part.check(surface)?;
            for (vertex, owner) in owner.iter_mut().enumerate() {
                if part.moving(vertex).is_none() {
                    continue;
                }
                if let Some(first) = owner.replace(number) {
                    let what = format!("vertex {vertex} belongs to part {:?} too", parts[first].name);
                    return Err(ResponseError::PartMismatch { part: part.name.clone(), what });
                }
            }
        }
        Ok(Self { background, parts, owner: owner.into() })
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The same after a rigid motion of the whole skin.
    ///
    /// # Errors
    /// As [`PreparedBody::moved`].
    pub fn moved(&self, motion: &Isometry3<f64>) -> Result<Self, ResponseError> {
        let move_part = |part: &Part| Ok(Part { prepared: part.prepared.moved(motion)?, ..part.clone() });
        let parts = self.parts.iter().map(move_part).collect::<Result<_, ResponseError>>()?;
        Ok(Self { parts, ..self.clone() })
    }

    /// The body that a vertex moves with, and its vertex there.
    fn body_at(&self, vertex: usize) -> Option<(&PreparedBody, usize)> {
        let part = &self.parts[self.owner[vertex]?];
        Some((&part.prepared, part.moving(vertex)?))
    }

    fn pieces(&self) -> Pieces<'_> {
        fn piece(part: &Part) -> Piece<'_> {
            (&part.name, &part.prepared, Box::new(|vertex| part.moving(vertex)))
        }
        let parts = self.parts.iter().map(piece).collect();
        Pieces { owner: &self.owner, background: &self.background, parts }
    }
}

/// A combined skin on a refinement of its surface.
struct RefinedCombination {
    background: KernelSkin,
    /// Name and response of each part.
    parts: Vec<(String, BodyOnMesh)>,
    owner: Vec<Option<usize>>,
}

impl RefinedCombination {
    fn pieces(&self) -> Pieces<'_> {
        fn piece((name, body): &(String, BodyOnMesh)) -> Piece<'_> {
            (name, body, Box::new(Some))
        }
        let parts = self.parts.iter().map(piece).collect();
        Pieces { owner: &self.owner, background: &self.background, parts }
    }
}

impl ElasticSkin for CombinedSkin {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        let background = self.background.traits(surface)?;
        self.parts.iter().try_for_each(|part| part.check(surface))?;
        let refines = self.parts.iter().all(|part| part.prepared.own_traits().refines);
        Ok(if self.parts.is_empty() { background } else { Traits::of_matrix(true, refines) })
    }

    fn is_scalar(&self, vertex: usize) -> bool {
        self.owner[vertex].is_none()
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.pieces().is_prepared(vertex)
    }

    fn is_held(&self, vertex: usize) -> bool {
        self.parts.iter().any(|part| part.part_vertices[vertex].is_some_and(|own| part.fixed[own]))
    }

    fn kernel_at(&self, vertex: usize) -> Option<&KernelSkin> {
        self.owner[vertex].is_none().then_some(&self.background)
    }

    fn shear_modulus_at(&self, vertex: usize) -> Option<f64> {
        self.body_at(vertex)
            .map_or(Some(self.background.shear_modulus()), |(body, own)| body.shear_modulus_at(own))
    }

    fn tissue_at(&self, vertex: usize) -> Option<f64> {
        match self.body_at(vertex) {
            Some((body, own)) => body.tissue_at(own),
            None => self.background.layer_at(vertex),
        }
    }

    fn refined(&self, mesh: &RefinedSurface) -> Result<Option<Box<dyn ElasticSkin + '_>>, ResponseError> {
        let Some(background) = self.background.on_refined(mesh) else { return Ok(None) };
        let mut parts = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let Some(body) = part.prepared.on_refined(mesh, |vertex| part.moving(vertex))? else {
                return Ok(None);
            };
            parts.push((part.name.clone(), body));
        }
        // A vertex between a part and the rest stays with the rest, as the cut's rim does.
        let owner = mesh.inherit(|vertex| self.owner[vertex], |a, b| a.filter(|a| Some(*a) == *b));
        Ok(Some(Box::new(RefinedCombination { background, parts, owner })))
    }

    fn doubt(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<Option<BodyDoubt>, ResponseError> {
        self.pieces().doubt(asked, forces, depth)
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        self.pieces().matrix(asked, directions)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        self.pieces().displace(asked, forces, vertices)
    }
}

impl ElasticSkin for RefinedCombination {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        let background = self.background.traits(surface)?;
        Ok(if self.parts.is_empty() { background } else { Traits::of_matrix(true, false) })
    }

    fn is_scalar(&self, vertex: usize) -> bool {
        self.owner[vertex].is_none()
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.pieces().is_prepared(vertex)
    }

    fn as_kernel(&self) -> Option<&KernelSkin> {
        self.parts.is_empty().then_some(&self.background)
    }

    fn expect(&self, lists: Vec<Vec<usize>>) {
        for (number, (_, body)) in self.parts.iter().enumerate() {
            let is_own = |vertex: &&usize| self.owner[**vertex] == Some(number);
            body.expect(lists.iter().map(|list| list.iter().filter(is_own).copied().collect()).collect());
        }
    }

    fn refined(&self, _: &RefinedSurface) -> Result<Option<Box<dyn ElasticSkin + '_>>, ResponseError> {
        Ok(None)
    }

    fn doubt(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<Option<BodyDoubt>, ResponseError> {
        self.pieces().doubt(asked, forces, depth)
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        self.pieces().matrix(asked, directions)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        self.pieces().displace(asked, forces, vertices)
    }
}
