//! The skin as it looks under the solved forces, and the volume it moves: computed when somebody asks.

use nalgebra::Vector3;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::equilibrium::compliance::{AppliedForces, Compliance};
use crate::contact::error::ContactError;
use crate::contact::figures::motion::fade::Fade;
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::outcome::{Contact, ContactStatus};
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

/// The skin under the forces of a contact.
#[derive(Debug, Clone)]
pub struct DrawnSkin {
    /// u (n, m). Under a scalar kernel it is faded to zero at `fade_distance` from the candidates; the fade enters no
    /// figure.
    pub displacement: Vec<Vector3<f64>>,
    /// Distance along the skin at which the displacement has faded to zero (m); infinite where nothing fades.
    pub fade_distance: f64,
    /// Change of the volume under the skin to first order, `Σ S_i N_i · u_i` over the skin without the fade, N outward (m³).
    pub volume_change: f64,
    /// The surface moved by `displacement`.
    pub deformed: Surface,
}

impl Contact {
    /// Displaces the skin under the forces of this contact.
    ///
    /// Under a kernel w `u_i = Σ_j w_ij f_j n_j`, of the forces on the finger nearest along the skin. A body moves each of its
    /// vertices.
    ///
    /// * `skin`, `options`: those that the contact was solved with
    ///
    /// # Errors
    /// [`ContactError::Response`]: the skin does not fit, or the work was interrupted.
    pub fn drawn_skin(
        &self,
        skin: &dyn ElasticSkin,
        options: &ContactOptions,
    ) -> Result<DrawnSkin, ContactError> {
        if self.status != ContactStatus::Solved {
            let displacement = vec![Vector3::zeros(); self.surface().vertices().len()];
            let deformed = self.surface().clone();
            return Ok(DrawnSkin { displacement, fade_distance: 0.0, volume_change: 0.0, deformed });
        }
        with_threads(options, || match self.refined_surface() {
            None => self.draw(skin, options),
            Some(mesh) => {
                // Another skin than that of the contact may not refine, and says that this is not its surface.
                let finer = skin.refined(mesh)?;
                self.draw(finer.as_deref().unwrap_or(skin), options)
            }
        })
    }

    fn draw(&self, skin: &dyn ElasticSkin, options: &ContactOptions) -> Result<DrawnSkin, ContactError> {
        let surface = self.surface();
        let motion = &self.drawing.motion;
        let fingers = &self.known_fingers();
        let everywhere: Vec<usize> = (0..surface.vertices().len()).collect();
        let mut displacement = self.displacements(skin, fingers, &everywhere, options)?;
        // At the candidates the forces answer for more than the drawing's tolerance.
        for (&vertex, u) in self.candidates.iter().zip(&*motion.of_skin()) {
            displacement[vertex] = *u;
        }
        let volume_change = volume_change(surface, &displacement);
        let fade = Fade::new(surface, fingers, &self.candidates, &motion.scalar);
        for (vertex, u) in displacement.iter_mut().enumerate() {
            if skin.is_scalar(vertex) {
                *u *= fade.share(vertex);
            }
        }
        let moved = surface.vertices().iter().zip(&displacement).map(|(x, u)| x + u).collect();
        let deformed = surface.with_vertices(moved);
        Ok(DrawnSkin { displacement, fade_distance: fade.distance, volume_change, deformed })
    }

    /// How some vertices move (m), without a fade.
    ///
    /// * `skin`: that of the mesh that the contact was solved on
    pub(crate) fn moved(
        &self,
        skin: &dyn ElasticSkin,
        vertices: &[usize],
        options: &ContactOptions,
    ) -> Result<Vec<Vector3<f64>>, ContactError> {
        self.displacements(skin, &self.known_fingers(), vertices, options)
    }

    fn known_fingers(&self) -> Fingers {
        let Fingers { candidates, coupling, .. } = &self.drawing.fingers;
        Fingers::known(self.surface(), candidates.clone(), coupling)
    }

    fn displacements(
        &self,
        skin: &dyn ElasticSkin,
        fingers: &Fingers,
        vertices: &[usize],
        options: &ContactOptions,
    ) -> Result<Vec<Vector3<f64>>, ContactError> {
        let surface = self.surface();
        let response = Compliance::new(surface, skin, skin.traits(surface)?, options);
        let forces = AppliedForces {
            fingers,
            on_product: fingers,
            active: &self.active,
            vectors: &self.force_vectors,
        };
        response.displace_coarsely(forces, vertices)
    }
}

/// `Σ S_i N_i · u_i` over the skin (m³).
fn volume_change(surface: &Surface, displacement: &[Vector3<f64>]) -> f64 {
    let swept = |vertex: usize| {
        surface.vertex_areas()[vertex] * surface.vertex_normals()[vertex].dot(&displacement[vertex])
    };
    (0..displacement.len()).filter(|&vertex| surface.skin_mask()[vertex]).map(swept).sum()
}
