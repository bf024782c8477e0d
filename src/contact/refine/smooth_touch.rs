//! First touch of the smooth skin that the mesh's normals imply, wherever a contact is refined later.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::first_touch::first_touch;
use crate::contact::options::ContactOptions;
use crate::contact::refine::mark::with_pressed_edge;
use crate::contact::scene::{Approach, Start};
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;
use crate::surface::refined::MeshRefinement;

/// Most times that a triangle is cut to find a first touch: each quarters how far its edges stand out.
const MOST_CUTS: usize = 8;

impl Approach {
    /// The same with the first touch of the whole skin known, as one that turns may then touch only a part of it.
    pub fn on_part(
        self,
        surface: &Surface,
        obstacle: &Obstacle,
        options: &ContactOptions,
    ) -> Result<Self, ContactError> {
        if self.start == Start::Current || options.target_error.is_none() {
            return Ok(self);
        }
        let touch = touch_of_smooth_skin(surface, obstacle, &self.direction)?;
        Ok(Self { known_touch: Some(touch), ..self })
    }
}

/// Travel (m) at which the obstacle, coming from infinity along a unit direction, first touches the smooth skin: triangles
/// are cut until no curved edge is touched before the vertices.
fn touch_of_smooth_skin(
    surface: &Surface,
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
) -> Result<f64, ContactError> {
    let mut travel = first_touch(surface, obstacle, direction)?;
    let pressed_at = |mesh: &MeshRefinement, travel: f64| {
        let placed = obstacle.translated(&(travel * direction));
        with_pressed_edge(mesh, (0..mesh.leaf_count()).collect(), &placed, |_| 0.0, |_| Vector3::zeros())
    };
    let mask = surface.skin_mask();
    let may_touch = |face: &u32| surface.faces()[*face as usize].iter().all(|&corner| mask[corner as usize]);
    let all = MeshRefinement::new(surface, (0..surface.faces().len() as u32).filter(may_touch));
    let faces: Vec<u32> = pressed_at(&all, travel)?.into_iter().map(|leaf| all.face(leaf)).collect();
    let mut mesh = MeshRefinement::new(surface, faces);
    for _ in 0..MOST_CUTS {
        let pressed = pressed_at(&mesh, travel)?;
        if pressed.is_empty() {
            break;
        }
        let mut marked = vec![false; mesh.leaf_count()];
        pressed.into_iter().for_each(|leaf| marked[leaf] = true);
        mesh.refine(&marked);
        travel = travel.min(first_touch(&mesh.part().surface, obstacle, direction)?);
    }
    Ok(travel)
}
