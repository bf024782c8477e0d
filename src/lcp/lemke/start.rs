//! Where the path begins: from nothing, or from the basis of a guess.

use crate::lcp::lemke::path::{NOWHERE, Path, hash};
use crate::lcp::lemke::pivot::Entering;

impl Path<'_> {
    /// The whole of z0 covers every deficit; the row that needs most leaves.
    pub(super) fn start_cold(&mut self) -> Entering {
        let need = |i: usize| -self.q[i] / self.d[i];
        let row = (0..self.n).reduce(|a, b| if need(b) > need(a) { b } else { a }).expect("a row has q < 0");
        let z0 = need(row);
        for i in 0..self.n {
            self.w[i] = (self.q[i] + self.d[i] * z0).max(0.0);
        }
        self.columns.push(self.n);
        self.push_row(row);
        self.x.push(z0);
        self.x_lex.push(0.0);
        let pivot = self.d[row];
        self.factored = self.basis.factor(1, |_, column| column[0] = pivot, &|| false);
        self.pivots = 1;
        self.perturb();
        Entering::Z(row)
    }

    /// Crash basis: z of `active` and w of the rest are basic. `Some(None)` where that is feasible already.
    pub(super) fn start_warm(&mut self, active: &[usize]) -> Option<Option<Entering>> {
        for &i in active {
            self.entered.fetch(i);
            self.push_row(i);
            self.columns.push(i);
            self.active_hash ^= hash(i as u64);
        }
        self.x = vec![0.0; active.len()];
        self.x_lex = self.x.clone();
        self.refactor();
        if self.factored.is_err() {
            return None;
        }
        self.refresh();
        if !self.x.iter().chain(&self.w).all(|value| value.is_finite()) {
            return None;
        }
        // Lift every basic variable alike: d = B·1 for the basis matrix B of the guess.
        let mut d = vec![1.0; self.n];
        self.rows.iter().for_each(|&i| d[i] = 0.0);
        self.combine(&vec![-1.0; active.len()], &mut d);
        let lowest =
            |values: &[f64]| (0..values.len()).reduce(|a, b| if values[b] < values[a] { b } else { a });
        let column = lowest(&self.x).filter(|&c| self.x[c] < -self.tie_tolerance());
        let row = lowest(&self.w).filter(|&i| self.w[i] < -self.tie_tolerance());
        let value = column.map_or(0.0, |c| self.x[c]).min(row.map_or(0.0, |i| self.w[i]));
        if value == 0.0 {
            return Some(None);
        }
        self.d = d;
        for i in 0..self.n {
            if self.row_place[i] == NOWHERE {
                self.w[i] = (self.w[i] - value).max(0.0);
            }
        }
        self.x.iter_mut().for_each(|x| *x = (*x - value).max(0.0));
        let right: Vec<f64> = self.rows.iter().map(|&i| self.d[i]).collect();
        let mut y = Vec::new();
        self.basis.transform(&right, &mut y);
        self.basis.append_column(&y);
        self.columns.push(self.n);
        self.x.push(-value);
        self.x_lex.push(0.0);
        self.pivots = 1;
        let entering = match (column, row) {
            (Some(c), _) if self.x[c] == 0.0 => {
                let index = self.columns[c];
                self.remove_column(c);
                Entering::W(index)
            }
            (_, row) => {
                let row = row.expect("the lowest value is a w");
                self.append_row(row);
                Entering::Z(row)
            }
        };
        self.perturb();
        Some(Some(entering))
    }
}
