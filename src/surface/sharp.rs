//! Sharp edges of the skin: where a finger is cut, and on a mesh too coarse for its shape.

use crate::surface::checked::Surface;
use crate::surface::refined::smooth;

impl Surface {
    /// The other end of a sharp convex edge at a vertex, where there is one; refinement leaves such edges as they are.
    pub(crate) fn sharp_edge_at(&self, vertex: usize) -> Option<usize> {
        let sharp = |&face: &u32| {
            let corners = self.faces()[face as usize];
            let side = corners.iter().position(|&corner| corner as usize == vertex)?;
            let end = corners[(side + 1) % 3];
            if !smooth(self).is_sharp(face, side) {
                return None;
            }
            let across = self.faces()[self.topology().across(face as usize, side)?];
            let apex = across.into_iter().find(|&corner| corner as usize != vertex && corner != end)?;
            let beyond = self.vertices()[apex as usize] - self.vertices()[vertex];
            (beyond.dot(&self.face_normals()[face as usize]) < 0.0).then_some(end as usize)
        };
        self.faces_around(vertex).iter().find_map(sharp)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn only_the_top_of_a_steep_roof_is_a_sharp_edge() {
        let roof = |height: f64| {
            let place = |x: f64, y: f64| Vector3::new(x, y, height * (1.0 - y.abs()));
            let vertices =
                [-1.0, 0.0, 1.0].into_iter().flat_map(|y| [place(0.0, y), place(1.0, y)]).collect();
            let faces = vec![[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4]];
            Surface::new(vertices, faces).expect("a roof")
        };
        let found = |height| (0..6).map(|vertex| roof(height).sharp_edge_at(vertex)).collect::<Vec<_>>();
        assert_eq!(found(0.6), [None, None, Some(3), Some(2), None, None]);
        // Turned by 44 degrees, and a valley.
        assert_eq!(found(0.4), [None; 6]);
        assert_eq!(found(-0.6), [None; 6]);
    }
}
