//! A whole hand: solved bodies where there are some, a kernel everywhere else.
//!
//! Parts of the skin, such as fingers cut out by [`cut_out`](crate::surface::cut_out()), answer with the compliance of their
//! body; the rest answers with a kernel. Forces on a part move that part alone, forces elsewhere move the rest alone:
//! across a cut nothing is felt, as each body is held there. So a connected patch of candidates must lie on one
//! side of every cut; one that straddles is an error that names the part.

use nalgebra::Isometry3;

use crate::response::error::ResponseError;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::kernel::skin::KernelSkin;
use crate::response::skin::body_part::{BodyPart, RefinedPart};
use crate::response::skin::combination::Combination;
use crate::response::skin::elastic::ElasticSkin;
use crate::response::skin::nodes::SAME_SHAPE_DISTANCE;
use crate::response::skin::prepared_body::PreparedBody;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

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

impl BodyPart for Part {
    fn name(&self) -> &str {
        &self.name
    }

    fn body(&self) -> &dyn ElasticSkin {
        &self.prepared
    }

    fn moving(&self, vertex: usize) -> Option<usize> {
        self.part_vertices[vertex].filter(|&own| !self.fixed[own])
    }

    fn is_held(&self, vertex: usize) -> bool {
        self.part_vertices[vertex].is_some_and(|own| self.fixed[own])
    }

    fn refines(&self) -> bool {
        true
    }

    fn refined(&self, mesh: &RefinedSurface) -> Result<Option<RefinedPart>, ResponseError> {
        let body = self.prepared.on_refined(mesh, |vertex| self.moving(vertex))?;
        Ok(Some(RefinedPart { name: self.name.clone(), body }))
    }

    fn check(&self, surface: &Surface) -> Result<(), ResponseError> {
        let mismatch = |what: String| ResponseError::PartMismatch { part: self.name.clone(), what };
        let (found, expected) = (self.part_vertices.len(), surface.vertices().len());
        if found != expected {
            return Err(mismatch(format!("{found} entries for the {expected} vertices of the whole skin")));
        }
        let own_count = self.prepared.nodes().surface().vertices().len();
        if self.fixed.len() != own_count {
            return Err(mismatch(format!(
                "{} entries tell which of its {own_count} vertices are fixed",
                self.fixed.len()
            )));
        }
        let allowed = SAME_SHAPE_DISTANCE * surface.mean_edge_length();
        for (vertex, own) in self.part_vertices.iter().enumerate() {
            let Some(own) = *own else { continue };
            let place = self.prepared.nodes().surface().vertices().get(own);
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
pub type CombinedSkin = Combination<Part>;

impl CombinedSkin {
    /// Joins parts of `surface` with the kernel `background`.
    ///
    /// # Errors
    /// - [`ResponseError::PartMismatch`]: a part does not fit the surface, is no body, or shares vertices with another
    /// - [`ResponseError::PartsNeedLinear`]: the kernel or a part averages gaps, or the kernel spreads forces over one-rings
    pub fn new(surface: &Surface, background: KernelSkin, parts: Vec<Part>) -> Result<Self, ResponseError> {
        let of_parts = parts.iter().map(|part| part.prepared.discretization());
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
}
