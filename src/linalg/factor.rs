//! What factors of a dense matrix share: why there is none, and work in strips that can be interrupted.

use faer::MatMut;
use faer::prelude::ReborrowMut;
use rayon::prelude::*;

/// Columns of the rest that one task updates. It depends on no number of threads, so neither do the results.
pub(crate) const STRIP: usize = 256;
/// Multiplications between two asks of the interrupt: some tens of milliseconds on one core.
pub(crate) const WORK: usize = 1 << 28;

/// Asked now and then by the calling thread; `true` says stop.
pub(crate) type Interrupt<'a> = &'a (dyn Fn() -> bool + Sync);

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoFactor {
    /// A pivot was zero, not a number, or not positive.
    Singular,
    /// The interrupt said stop.
    Interrupted,
}

/// Columns of a panel; between panels the interrupt is asked, so those of a tall matrix are narrow.
pub(crate) fn panel_width(n: usize) -> usize {
    if n > 2048 { 64 } else { 128 }
}

/// Runs `update` on strips of `width` columns, with the number of the first; several at a time where there are many,
/// and `stop` asked in between. Each column takes `cost` multiplications.
pub(crate) fn in_strips(
    columns: MatMut<'_, f64>,
    width: usize,
    cost: usize,
    stop: &mut dyn FnMut() -> bool,
    update: impl Fn(usize, MatMut<'_, f64>) + Sync,
) {
    let at_once = (WORK / width.saturating_mul(cost).max(1)).max(4);
    for_groups(columns, width.saturating_mul(at_once), stop, |first, part| {
        if part.ncols() <= width {
            update(first, part);
        } else {
            let strips = part.par_col_chunks_mut(width).enumerate();
            strips.for_each(|(k, strip)| update(first + k * width, strip));
        }
    });
}

/// Runs `update` on groups of columns one after the other, asking in between.
pub(crate) fn for_groups(
    mut columns: MatMut<'_, f64>,
    group: usize,
    stop: &mut dyn FnMut() -> bool,
    update: impl Fn(usize, MatMut<'_, f64>),
) {
    for first in (0..columns.ncols()).step_by(group) {
        if first > 0 && stop() {
            return;
        }
        let width = group.min(columns.ncols() - first);
        update(first, columns.rb_mut().subcols_mut(first, width));
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;
    use crate::linalg::cholesky::Cholesky;
    use crate::linalg::dense::Dense;
    use crate::linalg::lu::Lu;

    fn matrix(n: usize) -> Mat<f64> {
        let mut seed = 3_u64;
        Mat::from_fn(n, n, |_, _| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
    }

    fn assert_solves(a: &Mat<f64>, solve: impl Fn(&[f64]) -> Vec<f64>) {
        let n = a.nrows();
        let x: Vec<f64> = (0..n).map(|i| (i % 7) as f64 - 3.0).collect();
        let b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a[(i, j)] * x[j]).sum()).collect();
        for (found, expected) in solve(&b).iter().zip(&x) {
            assert!((found - expected).abs() < 1e-8, "{found} is not {expected} at n = {n}");
        }
    }

    #[test]
    fn both_factors_solve_at_every_size_around_a_panel() {
        for n in [0, 1, 2, 3, 127, 128, 129, 300, 700] {
            let a = matrix(n);
            let lu = Lu::new(Dense::of(&a), &|| false).ok().unwrap();
            assert_solves(&a, |b| lu.solve(b));
            let definite = &a * a.transpose() + Mat::<f64>::identity(n, n) * n as f64;
            let cholesky = Cholesky::new(Dense::of(&definite), &|| false).ok().unwrap();
            assert_solves(&definite, |b| cholesky.solve(b));
        }
    }

    #[test]
    fn singular_indefinite_and_interrupted_give_no_factor() {
        let zero = Mat::<f64>::zeros(3, 3);
        assert_eq!(Lu::new(Dense::of(&zero), &|| false).err(), Some(NoFactor::Singular));
        assert_eq!(Cholesky::new(Dense::of(&zero), &|| false).err(), Some(NoFactor::Singular));
        let indefinite = Mat::<f64>::identity(200, 200) * -1.0;
        assert_eq!(Cholesky::new(Dense::of(&indefinite), &|| false).err(), Some(NoFactor::Singular));
        assert_eq!(Lu::new(Dense::of(&zero), &|| true).err(), Some(NoFactor::Interrupted));
    }
}
