//! What a mesh costs force, area and peak pressure in each discretization, and how they settle as it becomes finer.

use std::ops::Sub;

use nalgebra::Vector3;

use crate::response::kernel::basis::Discretization;

/// Errors of force, area and peak, and what finer meshes leave of them.
pub(super) struct MeshErrors {
    /// Some two or three times the root mean square error of a smooth contact with one cell a radius, and the power of the
    /// number of cells that it falls with (docs/accuracy.md).
    pub of_cells: [(f64, f64); 3],
    /// From round to round: fitted to smooth skin and to scanned fingers, whose curvature is rough.
    pub settling: [Settling; 3],
    /// What the rim adds to the error of force where it is a sharp edge of the obstacle, over the share of the area there:
    /// fitted to flat punches, which have too much force.
    pub on_rim: f64,
    /// Shares of the errors of force and area that a finer rim leaves, fitted to fingers, and to fingertips under plates.
    pub left_by_rim: [f64; 2],
}

const COLLOCATION: MeshErrors = MeshErrors {
    of_cells: [(0.28, 2.0), (0.5, 1.5), (0.25, 2.0)],
    settling: [
        Settling { next: 3.0 / 7.0, least: 0.2 },
        Settling { next: 0.4, least: 0.2 },
        Settling { next: 3.0 / 7.0, least: 0.2 },
    ],
    on_rim: 0.0,
    left_by_rim: [0.75, 0.33],
};

/// The rim is felt from the triangles beside it, so that the area settles more slowly.
const GALERKIN: MeshErrors = MeshErrors {
    of_cells: [(0.12, 3.0), (0.25, 1.5), (0.2, 2.0)],
    settling: [COLLOCATION.settling[0], Settling { next: 0.5, least: 0.35 }, COLLOCATION.settling[2]],
    on_rim: 0.08,
    left_by_rim: [1.0, 0.45],
};

/// The largest share of a round's change that the last rounds are taken to show for the next: what keeps more does not settle.
pub(super) const SLOWEST_CHANGE: f64 = 0.8;

impl MeshErrors {
    pub fn of(discretization: Discretization) -> &'static Self {
        match discretization {
            Discretization::Collocation => &COLLOCATION,
            Discretization::Galerkin => &GALERKIN,
        }
    }
}

/// How a figure settles from round to round.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settling {
    /// A round's change as a share of that before.
    pub next: f64,
    /// Least share of an estimate that a round leaves, as two rounds may agree by chance.
    pub least: f64,
}

/// What settles: a number, or a force with its direction.
pub(super) trait Figure: Copy + Sub<Output = Self> {
    fn size(self) -> f64;
}

impl Figure for f64 {
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Figure for Vector3<f64> {
    fn size(self) -> f64 {
        self.norm()
    }
}

impl Settling {
    /// Error that a round leaves, over the figure.
    ///
    /// * `known`: what the round before was estimated to leave
    /// * `earlier`: two rounds before, where the change of that round counts too
    pub fn left<F: Figure>(self, known: Option<f64>, earlier: Option<F>, before: F, last: F) -> f64 {
        if last.size() == 0.0 {
            // Penetration without force: nothing is known.
            return f64::INFINITY;
        }
        // An infinite one was that of a sharp edge.
        let known = known.filter(|error| error.is_finite()).unwrap_or(0.0);
        // Over the mean of both, as logarithms would: areas fall to a third in the first rounds on an edge.
        let change = |from: F, to: F| 2.0 * (to - from).size() / (to.size() + from.size());
        let last_change = change(before, last);
        let slowed = earlier.map_or(0.0, |earlier| last_change / change(earlier, before));
        let next = slowed.clamp(self.next, SLOWEST_CHANGE);
        // All changes to come, each that share of the one before.
        (next / (1.0 - next) * last_change).max(self.least * known)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_that_turns_has_not_settled() {
        let [of_force, ..] = COLLOCATION.settling;
        let turned = of_force.left(None, None, Vector3::x(), Vector3::y());
        // Each change is three sevenths of the one before: all to come are three quarters of the last, √2 long.
        assert!((turned - 0.75 * f64::sqrt(2.0)).abs() < 1e-12, "{turned}");
        assert_eq!(of_force.left(None, None, Vector3::x(), Vector3::x()), 0.0);
        assert_eq!(of_force.left(None, None, Vector3::x(), Vector3::zeros()), f64::INFINITY);
    }
}
