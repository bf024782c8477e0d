//! Pointwise pressure recovered from Galerkin coefficients by a least-squares quadratic (patch recovery; Zienkiewicz, Zhu
//! 1992, doi:10.1002/nme.1620330702).

use nalgebra::{DMatrix, DVector, Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};

use crate::geometry::direction::tangents;
use crate::mesh::distinct::distinct;
use crate::surface::checked::Surface;

/// Coefficients of a quadratic in two variables.
const QUADRATIC_TERMS: usize = 6;

/// Most rings of neighbours that a quadratic is fitted over.
const MOST_RINGS: usize = 2;

/// A quadratic counts as determined where the smallest singular value of its fit is above this share of the largest. The
/// share is some 0.15 on good triangles, and seldom below 0.03 where vertices are moved by a third of an edge.
const DETERMINED_SHARE: f64 = 0.02;

/// A hat whose integral is a smaller share of the mean of those around it has no coefficient of its own.
const THIN_HAT: f64 = 0.25;

/// Pointwise pressure from the Galerkin coefficients `f_i / S_i` of hats.
///
/// The coefficients are right in their averages against hats; at the vertices they overshoot a smooth pressure by half
/// the hat's second moment times its second derivative (h² |Δp| / 16 on equilateral triangles of edge h, h² |Δp| / 12 on
/// squares with one diagonal), and beside the rim they alternate. Where a vertex and all its neighbours carry force, the
/// pressure is the quadratic whose averages against their hats, as forces, fit those of the coefficients best: exact for a
/// quadratic pressure on any flat mesh. Elsewhere in the contact it is the mean of `f_i / S_i` and of the average
/// against the hat, the same to second order on these two meshes; without force it is zero.
///
/// A hat that lies on slivers alone has its gap averaged along a line, where flat triangles differ from their mean by the
/// bulge of the skin. The force against that is small, but not as the hat is: its `f_i / S_i` has no bound. By force it
/// hardly weighs in a fit, and where there is none the pressure is `Σ f / Σ S` of the vertex and its neighbours.
///
/// * `coefficients`: (n, Pa) `f_i / S_i`
/// * `active`: vertices with f > 0, ascending
///
/// Returns the pressure at the vertices (n, Pa), and the largest that each stands for.
pub(crate) fn recover_pressure(
    surface: &Surface,
    coefficients: Vec<f64>,
    active: &[usize],
) -> (Vec<f64>, Vec<f64>) {
    let means: Vec<f64> = active.iter().map(|&vertex| hat_average(surface, &coefficients, vertex)).collect();
    let moments: Vec<Moments> = active.iter().map(|&vertex| Moments::of_hat(surface, vertex)).collect();
    let quadratic = |vertex: usize| {
        fit_around(surface, active, vertex, &means, &moments).filter(|quadratic| quadratic.value > 0.0)
    };
    let quadratics: Vec<Option<Quadratic>> = active.iter().map(|&vertex| quadratic(vertex)).collect();
    let mut at_vertices = coefficients.clone();
    for ((&vertex, quadratic), mean) in active.iter().zip(&quadratics).zip(&means) {
        at_vertices[vertex] = match quadratic {
            Some(quadratic) => quadratic.value,
            None => thin_hat_pressure(surface, &coefficients, vertex)
                .unwrap_or(0.5 * (coefficients[vertex] + mean)),
        };
    }
    let mut peak = at_vertices.clone();
    for (&vertex, quadratic) in active.iter().zip(&quadratics) {
        let own = at_vertices[vertex];
        let is_highest = surface.neighbours(vertex).iter().all(|&other| at_vertices[other as usize] <= own);
        if let (true, Some(quadratic)) = (is_highest, quadratic) {
            peak[vertex] = quadratic.peak();
        }
    }
    (at_vertices, peak)
}

/// Average of a piecewise linear field against the hat of a vertex.
fn hat_average(surface: &Surface, field: &[f64], vertex: usize) -> f64 {
    let share = |&face: &u32| {
        let corners: f64 = surface.faces()[face as usize].iter().map(|&corner| field[corner as usize]).sum();
        surface.face_areas()[face as usize] * (corners + field[vertex]) / 12.0
    };
    surface.faces_around(vertex).iter().map(share).sum::<f64>() / surface.vertex_areas()[vertex]
}

/// Force over area of a vertex and its neighbours (Pa), where the hat of the vertex is thin.
fn thin_hat_pressure(surface: &Surface, coefficients: &[f64], vertex: usize) -> Option<f64> {
    let (areas, ring) = (surface.vertex_areas(), surface.k_ring(&[vertex], 1));
    let area: f64 = ring.iter().map(|&other| areas[other]).sum();
    let force = || ring.iter().map(|&other| areas[other] * coefficients[other]).sum::<f64>();
    (areas[vertex] * (ring.len() as f64) < THIN_HAT * area).then(|| force() / area)
}

/// First (m) and second (m²) moments of a hat about its vertex, by its integral.
struct Moments {
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

impl Moments {
    fn of_hat(surface: &Surface, vertex: usize) -> Self {
        let (mut first, mut second) = (Vector3::zeros(), Matrix3::zeros());
        let origin = surface.vertices()[vertex];
        for &face in surface.faces_around(vertex) {
            // The corners' places from the vertex; its own is zero and adds nothing.
            let places = surface.faces()[face as usize].map(|v| surface.vertices()[v as usize] - origin);
            let sum = places[0] + places[1] + places[2];
            let squares: Matrix3<f64> = places.iter().map(|place| place * place.transpose()).sum();
            // ∫ l_a l_b dA = A/12, ∫ l_a l_b² dA = A/30, ∫ l_a l_b l_c dA = A/60
            let area = surface.face_areas()[face as usize];
            first += area / 12.0 * sum;
            second += area / 60.0 * (squares + sum * sum.transpose());
        }
        let integral = surface.vertex_areas()[vertex];
        Self { first: first / integral, second: second / integral }
    }
}

/// A quadratic about a vertex, in its tangent plane.
struct Quadratic {
    /// At the vertex (Pa).
    value: f64,
    gradient: Vector2<f64>,
    hessian: Matrix2<f64>,
    /// Distance of the farthest neighbour, in the unit of the coordinates.
    reach: f64,
}

impl Quadratic {
    /// Its largest value, where it has one no farther than the neighbours; else that at the vertex (Pa).
    fn peak(&self) -> f64 {
        if !(self.hessian[(0, 0)] < 0.0 && self.hessian.determinant() > 0.0) {
            return self.value;
        }
        match self.hessian.try_inverse().map(|inverse| -inverse * self.gradient) {
            Some(place) if place.norm() <= self.reach => self.value + 0.5 * self.gradient.dot(&place),
            _ => self.value,
        }
    }
}

/// The quadratic that fits best over a vertex and its neighbours, all of which must carry force. The next ring is added
/// where these do not determine it.
fn fit_around(
    surface: &Surface,
    active: &[usize],
    vertex: usize,
    means: &[f64],
    moments: &[Moments],
) -> Option<Quadratic> {
    let mut region = vec![vertex];
    for _ in 0..MOST_RINGS {
        let around = |&vertex: &usize| surface.neighbours(vertex).iter().map(|&other| other as usize);
        let next: Vec<usize> = region.iter().flat_map(around).collect();
        region = distinct(region.into_iter().chain(next));
        let rows: Option<Vec<usize>> = region.iter().map(|other| active.binary_search(other).ok()).collect();
        let quadratic = fit(surface, active, &rows?, vertex, means, moments);
        if quadratic.is_some() {
            return quadratic;
        }
    }
    None
}

/// The quadratic whose averages against the hats of `active[rows]` fit `means` best, each by the integral of its hat;
/// `None` where they do not determine it.
fn fit(
    surface: &Surface,
    active: &[usize],
    rows: &[usize],
    vertex: usize,
    means: &[f64],
    moments: &[Moments],
) -> Option<Quadratic> {
    if rows.len() < QUADRATIC_TERMS {
        return None;
    }
    let weight = |row: usize| surface.vertex_areas()[active[row]];
    // The area for each coefficient: the same share counts for few rings and many.
    let mean_weight = rows.iter().copied().map(weight).sum::<f64>() / QUADRATIC_TERMS as f64;
    let length = mean_weight.sqrt();
    let across = tangents(&surface.vertex_normals()[vertex]).map(|tangent| tangent.transpose());
    let to_plane = Matrix2x3::from_rows(&across) / length;
    let place = |other: usize| to_plane * (surface.vertices()[other] - surface.vertices()[vertex]);
    let mut averages = DMatrix::zeros(rows.len(), QUADRATIC_TERMS);
    let mut found = DVector::zeros(rows.len());
    for (k, &row) in rows.iter().enumerate() {
        let (x, first) = (place(active[row]), to_plane * moments[row].first);
        let second = to_plane * moments[row].second * to_plane.transpose();
        // averages of 1, x, y, x², x y, y² against the hat
        let square = x * x.transpose() + x * first.transpose() + first * x.transpose() + second;
        let terms = [1.0, x.x + first.x, x.y + first.y, square[(0, 0)], square[(0, 1)], square[(1, 1)]];
        let weight = weight(row) / mean_weight;
        averages.row_mut(k).copy_from_slice(&terms.map(|term| weight * term));
        found[k] = weight * means[row];
    }
    let decomposed = averages.svd(true, true);
    let largest = decomposed.singular_values.max();
    if decomposed.rank(DETERMINED_SHARE * largest) < QUADRATIC_TERMS {
        return None;
    }
    let c = decomposed.solve(&found, 0.0).ok()?;
    let neighbours = surface.neighbours(vertex);
    Some(Quadratic {
        value: c[0],
        gradient: Vector2::new(c[1], c[2]),
        hessian: Matrix2::new(2.0 * c[3], c[4], c[4], 2.0 * c[5]),
        reach: neighbours.iter().map(|&other| place(other as usize).norm()).fold(0.0, f64::max),
    })
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use nalgebra::{Rotation3, Vector2, Vector3};

    use super::{Moments, fit_around};
    use crate::response::kernel::basis::PressureBasis;
    use crate::response::matrix::average::pressure_average;
    use crate::sample::grid;
    use crate::surface::checked::Surface;

    /// A flat grid of squares of 1 mm with alternating diagonals (4 and 8 neighbours), its vertices moved by some
    /// 0.2 mm, turned out of the plane by `turn`.
    fn uneven(turn: &Rotation3<f64>) -> Surface {
        let (mut vertices, faces) = grid(8, 8, 1e-3);
        for (k, vertex) in vertices.iter_mut().enumerate() {
            let shift = |phase: f64| 0.2e-3 * (2.4 * (k * k % 97) as f64 + phase).sin();
            *vertex = turn * (*vertex + Vector3::new(shift(0.3), shift(1.7), 0.0));
        }
        Surface::new(vertices, faces).expect("a valid surface")
    }

    #[test]
    fn a_quadratic_pressure_and_its_peak_come_back_from_its_averages_against_hats() {
        let turn = Rotation3::from_euler_angles(0.4, -0.7, 1.1);
        let surface = uneven(&turn);
        let active: Vec<usize> = (0..surface.vertices().len()).collect();
        // Largest, 7 Pa, at (4.2, 3.9) mm.
        let field = |x: &Vector3<f64>| {
            let x = (turn.inverse() * x).xy() * 1e3 - Vector2::new(4.2, 3.9);
            7.0 - 0.2 * x.x * x.x - 0.3 * x.y * x.y + 0.1 * x.x * x.y
        };
        let points = surface.vertices();
        let at_vertices: Vec<f64> = points.iter().map(field).collect();
        let at_middle = |a: u32, b: u32| field(&(0.5 * (points[a as usize] + points[b as usize])));
        let mean = |&vertex: &usize| {
            pressure_average(&surface, PressureBasis::Linear, vertex, |v| at_vertices[v as usize], at_middle)
        };
        let means: Vec<f64> = active.iter().map(mean).collect();
        let moments: Vec<Moments> = active.iter().map(|&vertex| Moments::of_hat(&surface, vertex)).collect();
        let mut at_peak = 0;
        for &vertex in &active {
            let Some(found) = fit_around(&surface, &active, vertex, &means, &moments) else {
                let is_on_border = [vertex % 9, vertex / 9].iter().any(|place| place % 8 == 0);
                assert!(is_on_border, "only there do all neighbours lie on one side");
                continue;
            };
            // Rounding grows with the condition of a fit, some 100.
            assert_relative_eq!(found.value, field(&points[vertex]), max_relative = 1e-11);
            if found.peak() > found.value {
                assert_relative_eq!(found.peak(), 7.0, max_relative = 1e-11);
                at_peak += 1;
            }
        }
        assert!(at_peak > 0, "some vertex sees the peak beside it");
    }
}
