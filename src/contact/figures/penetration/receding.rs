//! Where the obstacle recedes or stands out between vertices under force, as grooves and bumps finer than the skin's triangles
//! do.

use nalgebra::Vector3;

/// What the corners of the deformed skin's triangles know.
pub(crate) struct DeformedCorners<'a> {
    /// Places (m).
    pub points: &'a [Vector3<f64>],
    /// Distance from the obstacle (m) and its outward normal there.
    pub distance: &'a [f64],
    pub normal: &'a [Vector3<f64>],
    /// Pressure (Pa), 0 off the force.
    pub pressure: &'a [f64],
}

/// How much of the skin under force the obstacle recedes from between the vertices, and how it presses where it stands out.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Receding {
    /// Share of the area of triangles with all corners under force.
    pub share: f64,
    /// How far, in the mean over all of that area (m).
    pub height: f64,
    /// The largest pressure (Pa) under what stands out there instead.
    pub pressure: f64,
}

impl Receding {
    /// Looks in triangles with all corners under force.
    ///
    /// A hollow that is told by the normals at the corners is that of a smooth obstacle; another counts where the pressure is too
    /// low to press the skin to its ground: below π E* Δ / λ, Δ half its depth and λ the length of an edge (Johnson 1985, §13.2).
    /// A bump that the normals do not tell adds as much to the pressure.
    ///
    /// * `middles`: how far the middle of each triangle is from the obstacle at the least (m)
    /// * `modulus`: E* of the skin (Pa)
    pub fn new(triangles: &[[u32; 3]], middles: &[f64], corners: &DeformedCorners, modulus: f64) -> Self {
        let (mut all, mut open, mut volume, mut most) = (0.0, 0.0, 0.0, 0.0_f64);
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
            let height = middle - at_corners;
            let edge = along.iter().map(Vector3::norm).sum::<f64>() / 3.0;
            let flattening = |height: f64| 0.5 * std::f64::consts::PI * modulus * height / edge;
            let pressure = pressure.iter().sum::<f64>() / 3.0;
            let hollow = height - smooth.max(0.0);
            if flattening(hollow) > pressure {
                open += area;
                volume += hollow * area;
            }
            most = most.max(pressure + flattening(smooth.min(0.0) - height));
        }
        let over_all = |sum: f64| if all == 0.0 { 0.0 } else { sum / all };
        Self { share: over_all(open), height: over_all(volume), pressure: most }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of edges 1.
    fn one_triangle() -> ([u32; 3], [Vector3<f64>; 3]) {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.75f64.sqrt()]];
        ([0, 1, 2], corners.map(|[x, y]| Vector3::new(x, y, 0.0)))
    }

    /// Share and height where the middle of a triangle of edges 1 is 0.02 off the obstacle, under a skin of modulus 1.
    fn in_one(pressure: [f64; 3], tilt: f64) -> [f64; 2] {
        let (triangle, points) = one_triangle();
        let middle = (points[0] + points[1] + points[2]) / 3.0;
        // Into a hollow.
        let normal = points.map(|point| Vector3::z() - tilt * (point - middle));
        let corners =
            DeformedCorners { points: &points, distance: &[0.0; 3], normal: &normal, pressure: &pressure };
        let found = Receding::new(&[triangle], &[0.02], &corners, 1.0);
        [found.share, found.height]
    }

    /// Pressure where the middle of that triangle stands in an obstacle.
    fn over_bump(depth: f64, tilt: f64) -> f64 {
        let (triangle, points) = one_triangle();
        let middle = (points[0] + points[1] + points[2]) / 3.0;
        let normal = points.map(|point| Vector3::z() + tilt * (point - middle));
        let corners =
            DeformedCorners { points: &points, distance: &[0.0; 3], normal: &normal, pressure: &[0.5; 3] };
        Receding::new(&[triangle], &[-depth], &corners, 1.0).pressure
    }

    #[test]
    fn a_hollow_between_vertices_counts_where_the_pressure_leaves_it_open() {
        // A wave of height 0.02 and length 1 closes under π 0.01.
        assert_eq!(in_one([0.031; 3], 0.0), [1.0, 0.02]);
        assert_eq!(in_one([0.032; 3], 0.0), [0.0, 0.0]);
        assert_eq!(in_one([0.01, 0.01, 0.0], 0.0), [0.0, 0.0]);
    }

    #[test]
    fn a_bump_between_vertices_adds_what_flattens_it_unless_the_normals_tell_it() {
        // A wave of height 0.02 and length 1 is flat under π 0.01.
        assert!((over_bump(0.02, 0.0) - 0.5 - 0.01 * std::f64::consts::PI).abs() < 1e-15);
        // The middle is 1/√3 from the corners: a ball of curvature 0.12 is 0.02 deep there.
        assert!((over_bump(0.02, 0.12) - 0.5).abs() < 1e-15);
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
