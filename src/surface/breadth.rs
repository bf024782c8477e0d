//! How broad the body that a surface bounds is at a vertex.

use nalgebra::Vector3;

use crate::geometry::ray::first_hit;
use crate::surface::checked::Surface;

impl Surface {
    /// Way from a vertex along a unit direction to where it leaves the surface again (m); `None` where it does not.
    pub(crate) fn breadth_along(&self, vertex: usize, direction: &Vector3<f64>) -> Option<f64> {
        let others = self.faces().iter().filter(|corners| !corners.contains(&(vertex as u32)));
        let triangles = others.map(|corners| corners.map(|corner| self.vertices()[corner as usize]));
        first_hit(&self.vertices()[vertex], direction, triangles)
    }
}
