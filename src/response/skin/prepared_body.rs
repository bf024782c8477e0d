//! A body solved once for unit forces at chosen nodes.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Isometry3, Vector3};

use crate::response::body::levels::coarseness::{BodyDoubt, Coarseness};
use crate::response::body::levels::on_mesh::BodyOnMesh;
use crate::response::body::levels::one_level::OneLevel;
use crate::response::body::levels::sizing::OnCoarse;
use crate::response::body::levels::two_levels::TwoLevels;
use crate::response::body::options::BodyOptions;
use crate::response::body::solve::Body;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::response::skin::levels::Levels;
use crate::response::skin::nodes::PreparedNodes;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// The compliance of a body; it turns with the surface and serves every product.
#[derive(Debug, Clone)]
pub struct PreparedBody {
    levels: Levels,
    nodes: PreparedNodes,
    coarseness: Coarseness,
    discretization: Discretization,
}

impl PreparedBody {
    /// Solves `body` for unit forces at `nodes`, on the coarse skin that it asks for; at every vertex that moves, where that
    /// skin is finer at the nodes than elsewhere.
    ///
    /// # Errors
    /// [`ResponseError::Body`] as [`Body::prepare`].
    pub fn new(
        surface: &Surface,
        body: &Body,
        shear_modulus: f64,
        poisson_ratio: f64,
        nodes: &[usize],
        options: &BodyOptions,
    ) -> Result<Self, ResponseError> {
        options.with_threads(|options| {
            let held = body.held_vertices(surface)?;
            let coarse = body.coarse_skin(surface, &held, nodes, options.interrupt)?;
            if let Some(OnCoarse { skin, nodes }) = coarse {
                let material = [shear_modulus, poisson_ratio];
                let two = TwoLevels::solve(body, surface, skin, &held, material, &nodes, options)?;
                return Self::from_levels(surface, &nodes, Levels::Two(two));
            }
            let one = OneLevel {
                compliance: body.prepare(surface, shear_modulus, poisson_ratio, nodes, options)?,
                thickness: body.tissue_thickness(surface, &held).map(Into::into),
            };
            Self::from_levels(surface, nodes, Levels::One(one))
        })
    }

    /// Takes a compliance that was computed or measured before; vertices that it keeps at rest stay.
    ///
    /// # Errors
    /// [`ResponseError::Nodes`]; [`ResponseError::Body`] of a compliance that does
    /// not fit the surface or the nodes.
    pub fn from_levels(surface: &Surface, nodes: &[usize], levels: Levels) -> Result<Self, ResponseError> {
        let nodes = PreparedNodes::new(surface, nodes)?;
        levels.check(surface.vertices().len(), nodes.list())?;
        let edges = match &levels {
            Levels::One(_) => surface.mean_edges().into(),
            Levels::Two(two) => Arc::clone(&two.coarse_edges),
        };
        let ratio = levels.compliance().parts().poisson_ratio;
        let coarseness = Coarseness::new(surface, edges, levels.thickness(), ratio);
        let discretization = Discretization::Collocation;
        Ok(Self { levels, nodes, coarseness, discretization })
    }

    /// The same body in another discretization: in Galerkin form its near kernel is averaged, and the rest of it, which is
    /// smooth, is taken at the nodes.
    pub fn with_discretization(self, discretization: Discretization) -> Self {
        Self { discretization, ..self }
    }

    pub(crate) fn discretization(&self) -> Discretization {
        self.discretization
    }

    /// What the compliance is made of.
    pub fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Vertices whose response is known.
    pub fn nodes(&self) -> &PreparedNodes {
        &self.nodes
    }

    /// The same body after a rigid motion of its surface.
    ///
    /// # Errors
    /// [`ResponseError::Body`] if the compliance refuses the rotation.
    pub fn moved(&self, motion: &Isometry3<f64>) -> Result<Self, ResponseError> {
        let rotation = motion.rotation.to_rotation_matrix();
        let levels = match &self.levels {
            Levels::One(one) => Levels::One(OneLevel {
                compliance: one.compliance.moved(rotation.matrix())?,
                thickness: one.thickness.clone(),
            }),
            Levels::Two(two) => Levels::Two(two.moved(rotation.matrix())?),
        };
        Ok(Self { levels, nodes: self.nodes.moved(motion), ..self.clone() })
    }

    /// On a refinement of the skin, or of a skin that this one is a part of.
    ///
    /// * `own`: vertex of this skin for a given vertex
    pub(crate) fn on_refined(
        &self,
        mesh: &RefinedSurface,
        own: impl Fn(usize) -> Option<usize>,
    ) -> Result<BodyOnMesh, ResponseError> {
        let response = match &self.levels {
            Levels::One(one) => one.near_and_far(self.nodes.surface(), self.discretization)?,
            Levels::Two(two) => two.near_and_far(self.discretization),
        };
        let coarseness = self.coarseness.on_refined(mesh, &own);
        Ok(BodyOnMesh { response: response.on_refined(mesh, own)?, coarseness })
    }

    /// Pressure (Pa) on every vertex of the bone under a force (N) at every vertex of the surface; `None` if the
    /// body was not asked for it.
    ///
    /// # Errors
    /// [`ResponseError::ForceCount`]; [`ResponseError::NotPrepared`] for a force where the response is not known.
    pub fn bone_pressures(&self, forces: &[Vector3<f64>]) -> Result<Option<Vec<f64>>, ResponseError> {
        let (found, expected) = (forces.len(), self.nodes.surface().vertices().len());
        if found != expected {
            return Err(ResponseError::ForceCount { found, expected });
        }
        let loaded: Vec<usize> = (0..found).filter(|&vertex| forces[vertex] != Vector3::zeros()).collect();
        self.nodes.rows(&loaded)?;
        let at_nodes: Vec<Vector3<f64>> = self.nodes.list().iter().map(|&vertex| forces[vertex]).collect();
        Ok(match &self.levels {
            Levels::One(one) => one.compliance.bone_pressures(&at_nodes)?,
            Levels::Two(two) => two.remainder.bone_pressures(&two.on_coarse(self.nodes.list(), &at_nodes))?,
        })
    }
}

impl ElasticSkin for PreparedBody {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        self.nodes.check_surface(surface)?;
        Ok(Traits { discretization: self.discretization, ..Traits::of_matrix(true, true) })
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.nodes.row(vertex).is_some()
    }

    fn is_held(&self, vertex: usize) -> bool {
        match &self.levels {
            Levels::One(one) => one.is_still(vertex),
            Levels::Two(two) => two.fixed[vertex],
        }
    }

    fn shear_modulus_at(&self, _: usize) -> Option<f64> {
        Some(self.levels.compliance().parts().shear_modulus)
    }

    fn tissue_at(&self, vertex: usize) -> Option<f64> {
        Some(self.levels.thickness()?[vertex])
    }

    fn refined(&self, mesh: &RefinedSurface) -> Result<Option<Box<dyn ElasticSkin + '_>>, ResponseError> {
        Ok(Some(Box::new(self.on_refined(mesh, Some)?)))
    }

    fn doubt(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<Option<BodyDoubt>, ResponseError> {
        let lost = match &self.levels {
            Levels::Two(two) => two.near_and_far(self.discretization).lost_displacement(asked, forces)?,
            Levels::One(_) => 0.0,
        };
        Ok(Some(self.coarseness.doubt(asked.nodes, forces, lost / depth)))
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        let rows = self.nodes.checked_rows(asked.nodes, directions)?;
        let asked = &Request { surface: self.nodes.surface(), ..*asked };
        match &self.levels {
            Levels::One(one) => {
                let at_nodes = one.compliance.response_among(&rows, directions);
                match self.discretization {
                    Discretization::Collocation => Ok(at_nodes),
                    Discretization::Galerkin => Ok(at_nodes + one.averaging(asked, directions)?),
                }
            }
            Levels::Two(two) => two.near_and_far(self.discretization).matrix(asked, directions),
        }
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        let rows = self.nodes.rows(asked.nodes)?;
        Ok(match &self.levels {
            Levels::One(one) => one.compliance.displacements_among(vertices, &rows, forces),
            Levels::Two(two) => two.near_and_far(self.discretization).displacements(
                &Request { surface: self.nodes.surface(), ..*asked },
                forces,
                vertices,
            )?,
        })
    }
}

impl ElasticSkin for BodyOnMesh {
    fn traits(&self, _: &Surface) -> Result<Traits, ResponseError> {
        Ok(Traits { discretization: self.response.discretization, ..Traits::of_matrix(true, false) })
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.response.is_prepared(vertex)
    }

    fn expect(&self, lists: Vec<Vec<usize>>) {
        self.response.kept.expect(lists);
    }

    fn shear_modulus_at(&self, _: usize) -> Option<f64> {
        Some(self.response.near.shear_modulus())
    }

    fn doubt(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<Option<BodyDoubt>, ResponseError> {
        let lost = self.response.lost_displacement(asked, forces)?;
        Ok(Some(self.coarseness.doubt(asked.nodes, forces, lost / depth)))
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        self.response.check_nodes(asked.nodes)?;
        self.response.matrix(asked, directions)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        self.response.check_nodes(asked.nodes)?;
        self.response.displacements(asked, forces, vertices)
    }
}
