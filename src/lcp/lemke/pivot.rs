//! One pivot: the direction along the entering variable, the variable that blocks it, the exchange.

use crate::lcp::certificate::nan_max;
use crate::lcp::lemke::path::{NOWHERE, Path, hash};
use crate::linalg::kernels;

/// Multiple of rows (see [`Basis::delete_row`](crate::lcp::basis::Basis::delete_row)) above which the basis is
/// factored anew.
const GROWTH_LIMIT: f64 = 1e6;

/// The variable that grows from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Entering {
    Z(usize),
    W(usize),
}

/// The basic variable that reaches zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Leaving {
    /// The basic variable at this place of `columns`.
    Column(usize),
    /// w of this row.
    Row(usize),
}

impl Path<'_> {
    /// Fills `dx`, `dw` and `y`; returns how far the rows of B are from what they should be.
    pub(super) fn direction(&mut self, entering: Entering) -> f64 {
        let mut a = vec![0.0; self.rows.len()];
        match entering {
            Entering::Z(r) => {
                self.entered.fetch(r);
                let column = self.entered.column(r);
                a.iter_mut().zip(&self.rows).for_each(|(a, &i)| *a = column[i]);
            }
            Entering::W(r) => a[self.row_place[r]] = -1.0,
        }
        self.basis.transform(&a, &mut self.y);
        self.dx.clone_from(&self.y);
        self.basis.back_substitute(&mut self.dx);
        self.dx.iter_mut().for_each(|x| *x = -*x);
        self.measure_direction(entering)
    }

    fn measure_direction(&mut self, entering: Entering) -> f64 {
        let mut dw = match entering {
            Entering::Z(r) => self.entered.column(r).to_vec(),
            Entering::W(_) => vec![0.0; self.n],
        };
        self.combine(&self.dx, &mut dw);
        if let Entering::W(r) = entering {
            dw[r] -= 1.0;
        }
        let size = self.dx.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        let worst = self.rows.iter().fold(0.0, |worst: f64, &i| nan_max(worst, dw[i].abs()));
        self.dw = dw;
        worst / size
    }

    pub(super) fn refine_direction(&mut self, entering: Entering) -> f64 {
        let mut error: Vec<f64> = self.rows.iter().map(|&i| self.dw[i]).collect();
        self.basis.solve(&mut error);
        self.dx.iter_mut().zip(error).for_each(|(x, e)| *x -= e);
        self.measure_direction(entering)
    }

    /// The basic variable that reaches zero first; z0 before others, then by the second right-hand side.
    pub(super) fn ratio_test(&self) -> Option<Leaving> {
        let size = self.dx.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        let smallest = self.pivot_tol * size;
        let step = kernels::first_to_zero(&self.x, &self.dx, smallest)
            .min(kernels::first_to_zero(&self.w, &self.dw, smallest));
        if !step.is_finite() {
            return None;
        }
        let slack = self.tie_tolerance();
        let mut best: Option<(f64, f64, Leaving)> = None;
        let mut consider = |x: f64, rate: f64, x_lex: f64, leaving: Leaving| {
            if rate < -smallest && x.max(0.0) + rate * step <= slack {
                let ratio = x_lex / -rate;
                if best.is_none_or(|(lowest, _, _)| ratio < lowest) {
                    best = Some((ratio, rate, leaving));
                }
            }
        };
        for (c, &column) in self.columns.iter().enumerate() {
            let x_lex = if column == self.n { f64::NEG_INFINITY } else { self.x_lex[c] };
            consider(self.x[c], self.dx[c], x_lex, Leaving::Column(c));
        }
        for i in 0..self.n {
            consider(self.w[i], self.dw[i], self.w_lex[i], Leaving::Row(i));
        }
        best.map(|(_, _, leaving)| leaving)
    }

    /// Moves to the next basis; `None` once z0 has left.
    pub(super) fn pivot(&mut self, entering: Entering, leaving: Leaving) -> Option<Entering> {
        let (step, step_lex) = match leaving {
            Leaving::Column(c) => (self.x[c].max(0.0) / -self.dx[c], self.x_lex[c] / -self.dx[c]),
            Leaving::Row(i) => (self.w[i].max(0.0) / -self.dw[i], self.w_lex[i] / -self.dw[i]),
        };
        advance(&mut self.x, &self.dx, step);
        advance(&mut self.x_lex, &self.dx, step_lex);
        advance(&mut self.w, &self.dw, step);
        advance(&mut self.w_lex, &self.dw, step_lex);
        if let Entering::Z(r) = entering {
            self.basis.append_column(&self.y);
            self.columns.push(r);
            self.x.push(step);
            self.x_lex.push(step_lex);
            self.active_hash ^= hash(r as u64);
        }
        let next = match leaving {
            Leaving::Row(row) => {
                self.append_row(row);
                Some(Entering::Z(row))
            }
            Leaving::Column(c) => {
                let index = self.columns[c];
                self.remove_column(c);
                (index != self.n).then_some(Entering::W(index))
            }
        };
        if let Entering::W(r) = entering {
            let place = self.row_place[r];
            if self.basis.delete_row(place) > GROWTH_LIMIT {
                self.stale = true;
            }
            self.rows.swap_remove(place);
            self.row_place[r] = NOWHERE;
            if let Some(&moved) = self.rows.get(place) {
                self.row_place[moved] = place;
            }
            self.w[r] = step;
            self.w_lex[r] = step_lex;
        }
        next
    }
}

impl Entering {
    pub(super) fn hash(self) -> u64 {
        match self {
            Self::Z(i) => hash((1 << 62) | i as u64),
            Self::W(i) => hash((1 << 63) | i as u64),
        }
    }
}

fn advance(values: &mut [f64], rates: &[f64], step: f64) {
    values.iter_mut().zip(rates).for_each(|(value, rate)| *value += step * rate);
}
