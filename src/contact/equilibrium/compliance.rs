//! The response as the pipeline uses it: a square matrix over candidates, displacement anywhere under forces.

use faer::Mat;
use nalgebra::Vector3;

use crate::contact::equilibrium::forces::AppliedForces;
use crate::contact::error::ContactError;
use crate::contact::options::ContactOptions;
use crate::response::body::levels::coarseness::BodyDoubt;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::{Displacements, ElasticSkin, Request, Traits};
use crate::surface::checked::Surface;

/// Relative quadrature tolerance of displacements that are drawn and summed to a volume but enter no complementarity.
const DRAWN_TOLERANCE: f64 = 1e-3;

/// A skin's response on a surface.
pub(crate) struct Compliance<'a> {
    surface: &'a Surface,
    pub skin: &'a dyn ElasticSkin,
    pub traits: Traits,
    options: AssemblyOptions<'a>,
}

impl<'a> Compliance<'a> {
    pub fn new(
        surface: &'a Surface,
        skin: &'a dyn ElasticSkin,
        traits: Traits,
        options: &ContactOptions<'a>,
    ) -> Self {
        let options = AssemblyOptions {
            tolerance: options.tolerance,
            memory_limit: options.memory_limit,
            interrupt: options.interrupt,
            ..AssemblyOptions::default()
        };
        Self { surface, skin, traits, options }
    }

    /// R over `nodes` along the obstacle's normals there (k × k, m/N).
    pub fn matrix(&self, nodes: &[usize], normals: &[Vector3<f64>]) -> Result<Mat<f64>, ContactError> {
        let asked = Request { surface: self.surface, nodes, options: &self.options };
        Ok(self.skin.matrix(&asked, normals)?)
    }

    /// What the mesh that a body was solved on costs a contact of so many m in depth with `forces` (N) at `nodes`;
    /// `None` of a kernel or a matrix.
    pub fn doubt(
        &self,
        nodes: &[usize],
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<Option<BodyDoubt>, ContactError> {
        let asked = Request { surface: self.surface, nodes, options: &self.options };
        Ok(self.skin.doubt(&asked, forces, depth)?)
    }

    /// Displacement of `vertices`, each under the forces of its own finger, to the tolerance of R itself.
    pub fn displace(&self, forces: AppliedForces, vertices: &[usize]) -> Result<Displacements, ContactError> {
        self.displace_to(&self.options, forces, vertices)
    }

    /// The same to no more than [`DRAWN_TOLERANCE`].
    pub fn displace_coarsely(
        &self,
        forces: AppliedForces,
        vertices: &[usize],
    ) -> Result<Displacements, ContactError> {
        let tolerance = self.options.tolerance.max(DRAWN_TOLERANCE);
        self.displace_to(&AssemblyOptions { tolerance, ..self.options }, forces, vertices)
    }

    fn displace_to(
        &self,
        options: &AssemblyOptions,
        forces: AppliedForces,
        vertices: &[usize],
    ) -> Result<Displacements, ContactError> {
        let under = |active: &[usize], vertices: &[usize]| {
            let pushed: Vec<Vector3<f64>> = active.iter().map(|&vertex| forces.vectors[vertex]).collect();
            let asked = Request { surface: self.surface, nodes: active, options };
            self.skin.displace(&asked, &pushed, vertices)
        };
        let fingers = forces.fingers;
        if fingers.candidates.len() == 1 {
            return Ok(under(forces.active, vertices)?);
        }
        let mut all = Displacements {
            vectors: vec![Vector3::zeros(); vertices.len()],
            along_normal: vec![Some(0.0); vertices.len()],
        };
        for finger in 0..fingers.candidates.len() {
            let is_own = |vertex: usize| fingers.finger_of(vertex) == Some(finger);
            let rows: Vec<usize> = (0..vertices.len()).filter(|&row| is_own(vertices[row])).collect();
            let own: Vec<usize> = rows.iter().map(|&row| vertices[row]).collect();
            let active: Vec<usize> = forces.active.iter().copied().filter(|&vertex| is_own(vertex)).collect();
            let moved = under(&active, &own)?;
            for (row, (vector, along)) in
                rows.into_iter().zip(moved.vectors.into_iter().zip(moved.along_normal))
            {
                (all.vectors[row], all.along_normal[row]) = (vector, along);
            }
        }
        Ok(all)
    }
}
