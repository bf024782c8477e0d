//! What factors of a dense matrix share: why there is none, and work in strips that can be interrupted.

use faer::MatMut;
use faer::prelude::ReborrowMut;
use faer::traits::RealField;
use rayon::prelude::*;

/// Columns of the rest that one task updates. It depends on no number of threads, so neither do the results.
pub(crate) const STRIP_COLUMNS: usize = 256;
/// Right sides that one task solves for.
pub(crate) const RIGHT_SIDES: usize = 32;
/// Multiplications between two asks of the interrupt: some tens of milliseconds on one core.
pub(crate) const GROUP_WORK: usize = 1 << 28;

/// A number in single or double precision.
pub(crate) trait Real: RealField + Copy + From<f32> + Into<f64> + 'static {
    /// Distance from one to the next larger number.
    const EPSILON: f64;

    /// The nearest to a number in double precision.
    fn nearest(value: f64) -> Self;
}

impl Real for f64 {
    const EPSILON: f64 = f64::EPSILON;

    fn nearest(value: f64) -> Self {
        value
    }
}

impl Real for f32 {
    const EPSILON: f64 = f32::EPSILON as f64;

    fn nearest(value: f64) -> Self {
        value as f32
    }
}

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
pub(crate) fn in_strips<T: Send>(
    mut columns: MatMut<'_, T>,
    width: usize,
    cost: usize,
    stop: &mut dyn FnMut() -> bool,
    update: impl Fn(usize, MatMut<'_, T>) + Sync,
) {
    let at_once = (GROUP_WORK / width.saturating_mul(cost).max(1)).max(4);
    let group = width.saturating_mul(at_once);
    for first in (0..columns.ncols()).step_by(group) {
        if first > 0 && stop() {
            return;
        }
        let columns_left = columns.ncols() - first;
        let part = columns.rb_mut().subcols_mut(first, group.min(columns_left));
        let strips = part.par_col_chunks_mut(width).enumerate();
        strips.for_each(|(k, strip)| update(first + k * width, strip));
    }
}

#[cfg(test)]
mod tests {
    use faer::{Mat, Par};

    use super::*;
    use crate::linalg::cholesky::Cholesky;
    use crate::linalg::dense::Dense;
    use crate::linalg::lu::{Blocking, Lu};
    use crate::sample::Random;

    const WIDE: Blocking = Blocking { panel: 512, strip: usize::MAX, par: Par::Seq };

    fn some_matrix(n: usize) -> Mat<f64> {
        let mut random = Random(3);
        Mat::from_fn(n, n, |_, _| random.signed())
    }

    fn assert_solves(a: &Mat<f64>, solve: impl Fn(&[f64]) -> Vec<f64>) {
        let n = a.nrows();
        let x = Mat::from_fn(n, 1, |i, _| (i % 7) as f64 - 3.0);
        for (found, expected) in solve((a * &x).col_as_slice(0)).iter().zip(x.col_as_slice(0)) {
            assert!((found - expected).abs() < 1e-8, "{found} is not {expected} at n = {n}");
        }
    }

    fn in_place(b: &[f64], solve: impl Fn(MatMut<f64>)) -> Vec<f64> {
        let mut x = b.to_vec();
        solve(MatMut::from_column_major_slice_mut(&mut x, b.len(), 1));
        x
    }

    #[test]
    fn every_factor_solves_at_every_size_around_a_panel() {
        for n in [0, 1, 2, 3, 127, 128, 129, 300, 511, 512, 513, 700, 1100] {
            let a = some_matrix(n);
            let lu = Lu::new(Dense::of(&a), &|| false).expect("regular");
            assert_solves(&a, |b| lu.solve(b));
            assert_solves(&a, |b| in_place(b, |right| lu.solve_in_place(right, &|| false)));
            let wide = Lu::with_blocking(Dense::of(&a), WIDE, &mut |_| false).expect("regular");
            let last = n - n / 3;
            assert_solves(&a, |b| {
                let solved = in_place(b, |right| wide.solve_last(right, last, &|| false));
                [&lu.solve(b)[..n - last], &solved[n - last..]].concat()
            });
            let mut transposed = Dense::of(&a.transpose().to_owned());
            transposed.transpose();
            assert_eq!(transposed.as_ref(), a.as_ref());
            assert!(wide.pivot_ratio() > 0.0);
            let definite = &a * a.transpose() + Mat::<f64>::identity(n, n) * n as f64;
            let cholesky = Cholesky::new(Dense::of(&definite), &|| false).expect("definite");
            assert_solves(&definite, |b| cholesky.solve(b));
            assert_solves(&definite, |b| in_place(b, |right| cholesky.solve_in_place(right, &|| false)));
        }
    }

    #[test]
    fn a_factor_in_single_precision_solves_to_its_rounding() {
        let a = some_matrix(600) + Mat::<f64>::identity(600, 600) * 30.0;
        let rounded =
            a.as_ref().col_iter().flat_map(|column| column.iter().map(|&value| f32::nearest(value)));
        let lu = Lu::with_blocking(Dense::from_columns(rounded.collect(), 600, 600), WIDE, &mut |_| false);
        let right = &a * Mat::<f64>::from_fn(600, 1, |i, _| i as f64);
        let mut x: Vec<f32> = right.col_as_slice(0).iter().map(|&value| f32::nearest(value)).collect();
        lu.expect("regular").solve_last(MatMut::from_column_major_slice_mut(&mut x, 600, 1), 600, &|| false);
        let error = x.iter().enumerate().map(|(i, &x)| (f64::from(x) - i as f64).abs()).fold(0.0, f64::max);
        // Up to 600 times the rounding, and a condition below 100.
        assert!(error < 600.0 * 100.0 * <f32 as Real>::EPSILON && error > 600.0 * f64::EPSILON, "{error}");
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

    #[test]
    fn a_stop_ends_it_and_the_work_done_rises_to_one() {
        let mut seen = Vec::new();
        let lu = Lu::with_blocking(Dense::of(&some_matrix(1100)), WIDE, &mut |done| {
            seen.push(done);
            false
        });
        assert!(lu.is_ok() && seen.is_sorted() && seen.first() == Some(&0.0) && seen.last() == Some(&1.0));
        assert!(seen.len() > 3);
        let stopped = Lu::with_blocking(Dense::of(&some_matrix(600)), WIDE, &mut |done| done > 0.0);
        assert_eq!(stopped.err(), Some(NoFactor::Interrupted));
    }
}
