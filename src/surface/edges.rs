//! Lengths of the edges at a vertex.

use crate::surface::checked::Surface;

impl Surface {
    /// Lengths of the edges at a vertex (m), in the order of its neighbours.
    pub(crate) fn edge_lengths(&self, vertex: usize) -> impl Iterator<Item = f64> + '_ {
        let own = self.vertices()[vertex];
        self.neighbours(vertex).iter().map(move |&other| (self.vertices()[other as usize] - own).norm())
    }

    /// Length of the shortest edge at a vertex (m).
    pub(crate) fn shortest_edge(&self, vertex: usize) -> f64 {
        self.edge_lengths(vertex).fold(f64::INFINITY, f64::min)
    }

    /// Length of the longest edge at a vertex (m).
    pub(crate) fn longest_edge(&self, vertex: usize) -> f64 {
        self.edge_lengths(vertex).fold(0.0, f64::max)
    }

    /// Mean length of the edges at each vertex (n, m).
    pub(crate) fn mean_edges(&self) -> Vec<f64> {
        let mean = |vertex| self.edge_lengths(vertex).sum::<f64>() / self.neighbours(vertex).len() as f64;
        (0..self.vertices().len()).map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use crate::sample::one_diagonal_grid;
    use crate::surface::checked::Surface;

    #[test]
    fn a_vertex_of_a_grid_has_sides_and_diagonals() {
        let (vertices, faces) = one_diagonal_grid(2);
        let surface = Surface::new(vertices, faces).expect("a sound mesh");
        let middle = surface.vertices().iter().position(|vertex| vertex.x == 1.0 && vertex.y == 1.0);
        let middle = middle.expect("a vertex inside");
        let diagonal = f64::sqrt(2.0);
        assert_eq!(surface.edge_lengths(middle).count(), 6);
        assert_eq!((surface.shortest_edge(middle), surface.longest_edge(middle)), (1.0, diagonal));
        // Two diagonals among six edges: rounding of six sums.
        let mean = (4.0 + 2.0 * diagonal) / 6.0;
        assert_relative_eq!(surface.mean_edges()[middle], mean, max_relative = 6.0 * f64::EPSILON);
    }
}
