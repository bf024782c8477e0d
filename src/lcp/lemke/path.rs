//! Where the path stands: the basis, the values on it, and how both follow from M and q.

use std::collections::HashSet;

use crate::lcp::basis::Basis;
use crate::lcp::lemke::basic_columns::BasicColumns;
use crate::lcp::product::add_terms;
use crate::lcp::reduced::ReducedProblem;
use crate::linalg::factor::{Interrupt, NoFactor};

/// Values closer than this are equal, relative to the largest.
const TIE_TOLERANCE: f64 = 64.0 * f64::EPSILON;
/// No place.
pub(super) const NOWHERE: usize = usize::MAX;

/// State of the path. M's columns are scaled to magnitude one, so every tolerance here is dimensionless.
pub(super) struct Path<'a> {
    pub(super) q: &'a [f64],
    pub(super) d: Vec<f64>,
    pub(super) n: usize,
    pub(super) entered: BasicColumns<'a>,
    pub(super) basis: Basis,
    /// B, in the order of the factor's rows.
    pub(super) rows: Vec<usize>,
    /// A and z0 (written n), in the order of the factor's columns.
    pub(super) columns: Vec<usize>,
    pub(super) row_place: Vec<usize>,
    /// Values of the basic variables and of the second right-hand side.
    pub(super) x: Vec<f64>,
    pub(super) x_lex: Vec<f64>,
    pub(super) w: Vec<f64>,
    pub(super) w_lex: Vec<f64>,
    pub(super) perturbation: Vec<f64>,
    /// Rates of change along the entering variable, and the transform of its column.
    pub(super) dx: Vec<f64>,
    pub(super) dw: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) pivots: usize,
    pub(super) visited: HashSet<u64>,
    pub(super) active_hash: u64,
    pub(super) draws: u64,
    pub(super) stale: bool,
    /// Whether the last factor came about.
    pub(super) factored: Result<(), NoFactor>,
    pub(super) work: f64,
    pub(super) pivot_tol: f64,
    pub(super) interrupted: Interrupt<'a>,
}

impl<'a> Path<'a> {
    pub(super) fn new(source: &'a ReducedProblem<'a>, d: Vec<f64>, pivot_tol: f64) -> Self {
        let n = source.size();
        Self {
            q: &source.q,
            d,
            n,
            entered: BasicColumns::new(source),
            basis: Basis::default(),
            rows: Vec::new(),
            columns: Vec::new(),
            row_place: vec![NOWHERE; n],
            x: Vec::new(),
            x_lex: Vec::new(),
            w: vec![0.0; n],
            w_lex: vec![0.0; n],
            perturbation: vec![0.0; n],
            dx: Vec::new(),
            dw: vec![0.0; n],
            y: Vec::new(),
            pivots: 0,
            visited: HashSet::new(),
            active_hash: 0,
            draws: 0,
            stale: false,
            factored: Ok(()),
            work: 0.0,
            pivot_tol,
            interrupted: source.interrupted,
        }
    }

    pub(super) fn push_row(&mut self, row: usize) {
        self.row_place[row] = self.rows.len();
        self.rows.push(row);
        self.w[row] = 0.0;
        self.w_lex[row] = 0.0;
    }

    pub(super) fn append_row(&mut self, row: usize) {
        let mut entries: Vec<f64> = self.columns.iter().map(|&c| self.column(c)[row]).collect();
        self.basis.append_row(&mut entries);
        self.push_row(row);
    }

    pub(super) fn remove_column(&mut self, c: usize) {
        self.basis.delete_column(c);
        let index = self.columns.remove(c);
        self.x.remove(c);
        self.x_lex.remove(c);
        if index != self.n {
            self.active_hash ^= hash(index as u64);
        }
    }

    /// A basic column, scaled; the covering vector for z0.
    fn column(&self, c: usize) -> &[f64] {
        if c == self.n { &self.d } else { self.entered.column(c) }
    }

    /// `y += Σ x_c (column c)` over the basic columns.
    pub(super) fn combine(&self, x: &[f64], y: &mut [f64]) {
        add_terms(y, x.len(), |k| (self.column(self.columns[k]), x[k]), &|| false);
    }

    pub(super) fn refactor(&mut self) {
        let (entered, d, n, rows, columns) = (&self.entered, &self.d, self.n, &self.rows, &self.columns);
        let fill = |j: usize, out: &mut [f64]| {
            let source = if columns[j] == n { &d[..] } else { entered.column(columns[j]) };
            out.iter_mut().zip(rows).for_each(|(entry, &i)| *entry = source[i]);
        };
        self.factored = self.basis.factor(columns.len(), fill, self.interrupted);
        self.stale = false;
    }

    /// Factor and values anew; `false` where there is no factor.
    pub(super) fn renew(&mut self) -> bool {
        self.refactor();
        if self.factored.is_ok() {
            self.refresh();
        }
        self.factored.is_ok()
    }

    /// Values of the basic variables from q (and from p), with one step of refinement.
    pub(super) fn refresh(&mut self) {
        (self.x, self.w) = self.values(self.q);
        (self.x_lex, self.w_lex) = self.values(&self.perturbation);
    }

    pub(super) fn values(&self, q: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut x = vec![0.0; self.columns.len()];
        let mut w = q.to_vec();
        for _ in 0..2 {
            let mut error: Vec<f64> = self.rows.iter().map(|&i| w[i]).collect();
            self.basis.solve(&mut error);
            x.iter_mut().zip(error).for_each(|(x, e)| *x -= e);
            w.copy_from_slice(q);
            self.combine(&x, &mut w);
            if (self.interrupted)() {
                break;
            }
        }
        self.rows.iter().for_each(|&i| w[i] = 0.0);
        (x, w)
    }

    /// Draws positive values of the second right-hand side here and works out the p that belongs to them.
    pub(super) fn perturb(&mut self) {
        self.draws += 1;
        self.visited.clear();
        let draw = |k: usize| draw(k, self.draws);
        self.x_lex = self.columns.iter().map(|&c| draw(c)).collect();
        let mut perturbation: Vec<f64> = (0..self.n).map(|i| draw(self.n + 1 + i)).collect();
        self.rows.iter().for_each(|&i| perturbation[i] = 0.0);
        self.w_lex = perturbation.clone();
        let down: Vec<f64> = self.x_lex.iter().map(|x| -x).collect();
        self.combine(&down, &mut perturbation);
        self.perturbation = perturbation;
    }

    pub(super) fn tie_tolerance(&self) -> f64 {
        TIE_TOLERANCE * self.x.iter().fold(1.0, |size: f64, x| size.max(x.abs()))
    }
}

/// A value in [1, 2) for each index and seed.
pub(in crate::lcp) fn draw(index: usize, seed: u64) -> f64 {
    1.0 + (hash(index as u64 ^ (seed << 40)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// SplitMix64 (Steele, Lea, Flood 2014).
pub(super) fn hash(seed: u64) -> u64 {
    let mut x = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
