//! Where the obstacle recedes between vertices under force, as grooves finer than the skin's triangles do.

use nalgebra::Vector3;

/// What the corners of the deformed skin's triangles know.
pub(crate) struct Corners<'a> {
    /// Places (m).
    pub points: &'a [Vector3<f64>],
    /// Distance from the obstacle (m) and its outward normal there.
    pub distance: &'a [f64],
    pub normal: &'a [Vector3<f64>],
    /// Pressure (Pa), 0 off the force.
    pub pressure: &'a [f64],
}

/// How much of the skin under force the obstacle recedes from between the vertices.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Receding {
    /// Share of the area of triangles with all corners under force.
    pub share: f64,
    /// How far, in the mean over all of that area (m).
    pub height: f64,
}

impl Receding {
    /// Looks in triangles with all corners under force.
    ///
    /// A hollow that is told by the normals at the corners is that of a smooth obstacle; another counts where the pressure is too
    /// low to press the skin to its ground: below π E* Δ / λ, Δ half its depth and λ the length of an edge (Johnson 1985, §13.2).
    ///
    /// * `middles`: how far the middle of each triangle is from the obstacle at the least (m)
    /// * `modulus`: E* of the skin (Pa)
    pub fn new(triangles: &[[u32; 3]], middles: &[f64], corners: &Corners, modulus: f64) -> Self {
        let (mut all, mut open, mut volume) = (0.0, 0.0, 0.0);
        for (triangle, middle) in triangles.iter().zip(middles) {
            let [a, b, c] = triangle.map(|corner| corner as usize);
            let pressure = [a, b, c].map(|corner| corners.pressure[corner]);
            if pressure.contains(&0.0) {
                continue;
            }
            let edges = [[a, b], [b, c], [c, a]];
            let along = edges.map(|[from, to]| corners.points[to] - corners.points[from]);
            let area = 0.5 * along[0].cross(&along[1]).norm();
            all += area;
            // Of a quadratic through the corners: four ninths of what the middles of the three edges have.
            let smooth: f64 = edges
                .iter()
                .zip(&along)
                .map(|([from, to], along)| (corners.normal[*from] - corners.normal[*to]).dot(along) / 18.0)
                .sum();
            let at_corners = [a, b, c].map(|corner| corners.distance[corner]).iter().sum::<f64>() / 3.0;
            let height = middle - at_corners - smooth.max(0.0);
            let edge = along.iter().map(Vector3::norm).sum::<f64>() / 3.0;
            let closing = 0.5 * std::f64::consts::PI * modulus * height / edge;
            if closing > pressure.iter().sum::<f64>() / 3.0 {
                open += area;
                volume += height * area;
            }
        }
        if all == 0.0 { Self::default() } else { Self { share: open / all, height: volume / all } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share and height where the middle of a triangle of edges 1 is 0.02 off the obstacle, under a skin of modulus 1.
    fn in_one(pressure: [f64; 3], tilt: f64) -> [f64; 2] {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.75f64.sqrt()]].map(|[x, y]| Vector3::new(x, y, 0.0));
        let middle = (points[0] + points[1] + points[2]) / 3.0;
        // Into a hollow.
        let normal = points.map(|point| Vector3::z() - tilt * (point - middle));
        let corners = Corners { points: &points, distance: &[0.0; 3], normal: &normal, pressure: &pressure };
        let found = Receding::new(&[[0, 1, 2]], &[0.02], &corners, 1.0);
        [found.share, found.height]
    }

    #[test]
    fn a_hollow_between_vertices_counts_where_the_pressure_leaves_it_open() {
        // A wave of height 0.02 and length 1 closes under π 0.01.
        assert_eq!(in_one([0.031; 3], 0.0), [1.0, 0.02]);
        assert_eq!(in_one([0.032; 3], 0.0), [0.0, 0.0]);
        assert_eq!(in_one([0.01, 0.01, 0.0], 0.0), [0.0, 0.0]);
    }

    #[test]
    fn a_smooth_hollow_that_the_normals_tell_does_not_count() {
        // The middle is 1/√3 from the corners: a bowl of curvature 0.12 is 0.02 deep there.
        assert_eq!(in_one([0.001; 3], 0.121), [0.0, 0.0]);
        let [share, height] = in_one([0.001; 3], 0.06);
        assert!(share == 1.0 && (height - 0.01).abs() < 1e-12, "{height}");
        // Nor do normals that turn the other way make a hollow deeper.
        assert_eq!(in_one([0.001; 3], -0.1), [1.0, 0.02]);
    }
}
