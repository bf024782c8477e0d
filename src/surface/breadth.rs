//! How broad the body that a surface bounds is at a vertex.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::geometry::bounds::Bounds;
use crate::geometry::ray::first_hit;
use crate::surface::checked::Surface;

impl Surface {
    /// Way from a vertex along a unit direction to where it leaves the surface again (m); `None` where it does not.
    pub(crate) fn breadth_along(&self, vertex: usize, direction: &Vector3<f64>) -> Option<f64> {
        self.breadth_among(self.faces(), vertex, direction)
    }

    /// Breadth at each of some vertices into the body, against the normal (m); `None` where it is `within` (m) or more.
    pub(crate) fn breadths(
        &self,
        vertices: &[usize],
        within: impl Fn(usize) -> f64 + Sync,
    ) -> Vec<Option<f64>> {
        let inward = |vertex: usize| -self.vertex_normals()[vertex];
        let ways = vertices.iter().flat_map(|&vertex| {
            [0.0, within(vertex)].map(|way| self.vertices()[vertex] + way * inward(vertex))
        });
        let around = Bounds::around_each(ways);
        let corners = |face: &[u32; 3]| face.map(|corner| self.vertices()[corner as usize]);
        let is_near = |face: &&[u32; 3]| Bounds::around_each(corners(face)).meets(&around);
        let near: Vec<[u32; 3]> = self.faces().iter().filter(is_near).copied().collect();
        let breadth = |&vertex: &usize| {
            self.breadth_among(&near, vertex, &inward(vertex)).filter(|breadth| *breadth < within(vertex))
        };
        vertices.par_iter().map(breadth).collect()
    }

    fn breadth_among(&self, faces: &[[u32; 3]], vertex: usize, direction: &Vector3<f64>) -> Option<f64> {
        let others = faces.iter().filter(|corners| !corners.contains(&(vertex as u32)));
        let triangles = others.map(|corners| corners.map(|corner| self.vertices()[corner as usize]));
        first_hit(&self.vertices()[vertex], direction, triangles)
    }
}
