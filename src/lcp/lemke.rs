//! Lemke's complementary pivoting on a factor of the active block.
//!
//! The path keeps `w = q + M z + d z0` with all variables >= 0 and `w·z = 0`, and drives the covering variable
//! z0 to zero. Let A be the unknowns whose z is basic and B = A plus the one unknown that has neither z nor w
//! basic. Then `[M_BA d_B] [z_A; z0] = -q_B`, so the basis is no larger than the active set: a pivot costs one
//! product with M's active columns and O(|A|²) for the factor, and no tableau exists.
//!
//! Ties in the ratio test are broken lexicographically over (q, p), p a perturbation carried along as a second
//! right-hand side. Every basis is remembered by a hash; should rounding bring one back, p is drawn anew.

use std::collections::HashSet;

use rayon::prelude::*;

use super::basis::Basis;
use super::certificate::nan_max;
use super::dense::NoFactor;
use super::kernels;
use super::options::LcpOptions;
use super::problem::{Columns, SHARED, row_block};
use super::reduced::power_of_two;
use super::solution::LcpStatus;

/// What a run of the method gives back, in the reduced problem's terms.
pub(super) struct Outcome {
    pub(super) status: LcpStatus,
    pub(super) z: Vec<f64>,
    pub(super) pivots: usize,
    /// Direction of z and of z0 where the status is a ray.
    pub(super) ray: Option<(Vec<f64>, f64)>,
    /// Multiplications, roughly.
    pub(super) work: f64,
}

/// Pivots after which values are recomputed from q.
const REFRESH: usize = 64;
/// Relative error of a direction above which it is refined, and above which the basis is factored anew.
const REFINE: f64 = 1e-12;
const REFACTOR: f64 = 1e-8;
/// Multiple of rows (see [`Basis::delete_row`]) above which the basis is factored anew.
const GROWTH: f64 = 1e6;
/// Ratios closer than this are ties, relative to the largest value.
const TIE: f64 = 64.0 * f64::EPSILON;
/// Perturbations drawn before the run is given up as a breakdown.
const PERTURBATIONS: u64 = 8;
const NOWHERE: usize = usize::MAX;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Entering {
    Z(usize),
    W(usize),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Leaving {
    /// The basic variable at this place of `columns`.
    Column(usize),
    /// w of this row.
    Row(usize),
}

/// Solves `w = M z + q` from z = 0 with covering vector `d`.
pub(super) fn solve_cold(
    m: Columns<'_>,
    q: &[f64],
    d: Vec<f64>,
    pivot_tol: f64,
    options: &LcpOptions,
) -> Outcome {
    let mut path = Path::new(m, q, d, options);
    path.pivot_tol = pivot_tol;
    let entering = path.start_cold();
    path.run(entering)
}

/// Solves from the basis of a guessed active set; `None` where that basis is singular.
pub(super) fn solve_warm(
    m: Columns<'_>,
    q: &[f64],
    active: &[usize],
    options: &LcpOptions,
) -> Option<Outcome> {
    let mut path = Path::new(m, q, vec![0.0; q.len()], options);
    match path.start_warm(active)? {
        None => Some(path.finish(LcpStatus::Solved)),
        Some(entering) => Some(path.run(entering)),
    }
}

/// State of the path. M's columns are scaled to magnitude one, so every tolerance here is dimensionless.
struct Path<'a> {
    m: Columns<'a>,
    q: &'a [f64],
    d: Vec<f64>,
    n: usize,
    /// Factor by which column j is scaled; 0 until it is first needed.
    scale: Vec<f64>,
    basis: Basis,
    /// B, in the order of the factor's rows.
    rows: Vec<usize>,
    /// A and z0 (written n), in the order of the factor's columns.
    columns: Vec<usize>,
    row_place: Vec<usize>,
    /// Values of the basic variables and of the second right-hand side.
    x: Vec<f64>,
    x_tie: Vec<f64>,
    w: Vec<f64>,
    w_tie: Vec<f64>,
    tie: Vec<f64>,
    /// Rates of change along the entering variable, and the transform of its column.
    dx: Vec<f64>,
    dw: Vec<f64>,
    y: Vec<f64>,
    pivots: usize,
    visited: HashSet<u64>,
    active_hash: u64,
    perturbations: u64,
    stale: bool,
    /// Whether the last factor came about.
    factored: Result<(), NoFactor>,
    work: f64,
    pivot_tol: f64,
    options: &'a LcpOptions<'a>,
}

impl<'a> Path<'a> {
    fn new(m: Columns<'a>, q: &'a [f64], d: Vec<f64>, options: &'a LcpOptions<'a>) -> Self {
        let n = q.len();
        Self {
            m,
            q,
            d,
            n,
            scale: vec![0.0; n],
            basis: Basis::default(),
            rows: Vec::new(),
            columns: Vec::new(),
            row_place: vec![NOWHERE; n],
            x: Vec::new(),
            x_tie: Vec::new(),
            w: vec![0.0; n],
            w_tie: vec![0.0; n],
            tie: vec![0.0; n],
            dx: Vec::new(),
            dw: vec![0.0; n],
            y: Vec::new(),
            pivots: 0,
            visited: HashSet::new(),
            active_hash: 0,
            perturbations: 0,
            stale: false,
            factored: Ok(()),
            work: 0.0,
            pivot_tol: options.pivot_tol,
            options,
        }
    }

    /// The whole of z0 covers every deficit; the row that needs most leaves.
    fn start_cold(&mut self) -> Entering {
        let need = |i: usize| -self.q[i] / self.d[i];
        let row = (0..self.n).reduce(|a, b| if need(b) > need(a) { b } else { a }).expect("a row has q < 0");
        let z0 = need(row);
        for i in 0..self.n {
            self.w[i] = (self.q[i] + self.d[i] * z0).max(0.0);
        }
        self.columns.push(self.n);
        self.push_row(row);
        self.x.push(z0);
        self.x_tie.push(0.0);
        let pivot = self.d[row];
        self.factored = self.basis.factor(1, |_, column| column[0] = pivot, &|| false);
        self.pivots = 1;
        self.perturb();
        Entering::Z(row)
    }

    /// Crash basis: z of `active` and w of the rest are basic. `Some(None)` where that is feasible already.
    fn start_warm(&mut self, active: &[usize]) -> Option<Option<Entering>> {
        for &i in active {
            self.scale_column(i);
            self.push_row(i);
            self.columns.push(i);
            self.active_hash ^= hash(i as u64);
        }
        self.x = vec![0.0; active.len()];
        self.x_tie = self.x.clone();
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
        self.x_tie.push(0.0);
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

    fn run(&mut self, mut entering: Entering) -> Outcome {
        let budget = self.options.pivot_budget(self.n);
        loop {
            if self.options.is_interrupted() {
                return self.finish(LcpStatus::Interrupted);
            }
            if self.pivots >= budget {
                return self.finish(LcpStatus::PivotLimit);
            }
            if self.stale || self.pivots.is_multiple_of(REFRESH) {
                if self.stale {
                    self.refactor();
                }
                self.refresh();
            }
            if !self.visited.insert(self.active_hash ^ entering.hash()) {
                if self.perturbations >= PERTURBATIONS {
                    return self.finish(LcpStatus::Breakdown);
                }
                self.refactor();
                self.refresh();
                self.perturb();
            }
            let k = self.columns.len() as f64;
            self.work += k * (self.n as f64 + 2.0 * k);
            let mut leaving = self.try_direction(entering);
            if leaving.is_none() {
                self.refactor();
                self.refresh();
                leaving = self.try_direction(entering);
            }
            if let Err(reason) = self.factored {
                return self.finish(reason.into());
            }
            let Some(leaving) = leaving else {
                if !self.dx.iter().chain(&self.dw).all(|rate| rate.is_finite()) {
                    return self.finish(LcpStatus::Breakdown);
                }
                let ray = self.ray(entering);
                return Outcome { ray: Some(ray), ..self.finish(LcpStatus::Ray) };
            };
            self.pivots += 1;
            match self.pivot(entering, leaving) {
                Some(next) => entering = next,
                None => return self.finish(LcpStatus::Solved),
            }
        }
    }

    /// Rates of change along `entering` and the variable that blocks it first.
    fn try_direction(&mut self, entering: Entering) -> Option<Leaving> {
        let mut error = self.direction(entering);
        if error > REFINE {
            error = self.refine_direction(entering);
        }
        if error > REFACTOR {
            self.refactor();
            self.refresh();
            self.direction(entering);
            self.refine_direction(entering);
        }
        for &i in &self.rows {
            self.dw[i] = 0.0;
        }
        self.ratio_test()
    }

    /// Fills `dx`, `dw` and `y`; returns how far the rows of B are from what they should be.
    fn direction(&mut self, entering: Entering) -> f64 {
        let mut a: Vec<f64> = match entering {
            Entering::Z(r) => {
                self.scale_column(r);
                let column = self.m.col(r).as_slice();
                self.rows.iter().map(|&i| self.scale[r] * column[i]).collect()
            }
            Entering::W(r) => {
                let mut a = vec![0.0; self.rows.len()];
                a[self.row_place[r]] = -1.0;
                a
            }
        };
        self.basis.transform(&a, &mut self.y);
        a.copy_from_slice(&self.y);
        self.basis.back_substitute(&mut a);
        a.iter_mut().for_each(|x| *x = -*x);
        self.dx = a;
        self.measure_direction(entering)
    }

    fn measure_direction(&mut self, entering: Entering) -> f64 {
        let mut dw = std::mem::take(&mut self.dw);
        match entering {
            Entering::Z(r) => {
                let (factor, column) = (self.scale[r], self.m.col(r).as_slice());
                dw.iter_mut().zip(column).for_each(|(dw, m)| *dw = factor * m);
            }
            Entering::W(_) => dw.fill(0.0),
        }
        self.combine(&self.dx, &mut dw);
        if let Entering::W(r) = entering {
            dw[r] -= 1.0;
        }
        let size = self.dx.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        let worst = self.rows.iter().fold(0.0, |worst: f64, &i| nan_max(worst, dw[i].abs()));
        self.dw = dw;
        worst / size
    }

    fn refine_direction(&mut self, entering: Entering) -> f64 {
        let mut error: Vec<f64> = self.rows.iter().map(|&i| self.dw[i]).collect();
        self.basis.solve(&mut error);
        self.dx.iter_mut().zip(error).for_each(|(x, e)| *x -= e);
        self.measure_direction(entering)
    }

    /// The basic variable that reaches zero first; z0 before others, then by the second right-hand side.
    fn ratio_test(&self) -> Option<Leaving> {
        let size = self.dx.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        let smallest = self.pivot_tol * size;
        let mut step = f64::INFINITY;
        for (&x, &rate) in self.x.iter().zip(&self.dx).chain(self.w.iter().zip(&self.dw)) {
            if rate < -smallest && x.max(0.0) < -rate * step {
                step = x.max(0.0) / -rate;
            }
        }
        if !step.is_finite() {
            return None;
        }
        let slack = self.tie_tolerance();
        let mut best: Option<(f64, f64, Leaving)> = None;
        let mut consider = |x: f64, rate: f64, x_tie: f64, leaving: Leaving| {
            if rate < -smallest && x.max(0.0) + rate * step <= slack {
                let ratio = x_tie / -rate;
                if best.is_none_or(|(lowest, _, _)| ratio < lowest) {
                    best = Some((ratio, rate, leaving));
                }
            }
        };
        for (c, &column) in self.columns.iter().enumerate() {
            let x_tie = if column == self.n { f64::NEG_INFINITY } else { self.x_tie[c] };
            consider(self.x[c], self.dx[c], x_tie, Leaving::Column(c));
        }
        for i in 0..self.n {
            consider(self.w[i], self.dw[i], self.w_tie[i], Leaving::Row(i));
        }
        best.map(|(_, _, leaving)| leaving)
    }

    /// Moves to the next basis; `None` once z0 has left.
    fn pivot(&mut self, entering: Entering, leaving: Leaving) -> Option<Entering> {
        let (step, step_tie) = match leaving {
            Leaving::Column(c) => (self.x[c].max(0.0) / -self.dx[c], self.x_tie[c] / -self.dx[c]),
            Leaving::Row(i) => (self.w[i].max(0.0) / -self.dw[i], self.w_tie[i] / -self.dw[i]),
        };
        advance(&mut self.x, &self.dx, step);
        advance(&mut self.x_tie, &self.dx, step_tie);
        advance(&mut self.w, &self.dw, step);
        advance(&mut self.w_tie, &self.dw, step_tie);
        if let Entering::Z(r) = entering {
            self.basis.append_column(&self.y);
            self.columns.push(r);
            self.x.push(step);
            self.x_tie.push(step_tie);
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
            if self.basis.delete_row(place) > GROWTH {
                self.stale = true;
            }
            self.rows.swap_remove(place);
            self.row_place[r] = NOWHERE;
            if let Some(&moved) = self.rows.get(place) {
                self.row_place[moved] = place;
            }
            self.w[r] = step;
            self.w_tie[r] = step_tie;
        }
        next
    }

    fn push_row(&mut self, row: usize) {
        self.row_place[row] = self.rows.len();
        self.rows.push(row);
        self.w[row] = 0.0;
        self.w_tie[row] = 0.0;
    }

    fn append_row(&mut self, row: usize) {
        let mut entries: Vec<f64> = self.columns.iter().map(|&c| self.entry(row, c)).collect();
        self.basis.append_row(&mut entries);
        self.push_row(row);
    }

    fn remove_column(&mut self, c: usize) {
        self.basis.delete_column(c);
        let index = self.columns.remove(c);
        self.x.remove(c);
        self.x_tie.remove(c);
        if index != self.n {
            self.active_hash ^= hash(index as u64);
        }
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        if column == self.n { self.d[row] } else { self.scale[column] * self.m[(row, column)] }
    }

    fn scale_column(&mut self, j: usize) {
        if self.scale[j] == 0.0 {
            let largest = self.m.col(j).as_slice().iter().fold(0.0, |a: f64, m| a.max(m.abs()));
            self.scale[j] = if largest > 0.0 { 1.0 / power_of_two(largest) } else { 1.0 };
        }
    }

    /// `y += Σ x_c (column c)` over the basic columns.
    fn combine(&self, x: &[f64], y: &mut [f64]) {
        let terms: Vec<(&[f64], f64)> = self
            .columns
            .iter()
            .zip(x)
            .map(|(&c, &x)| match c == self.n {
                true => (&self.d[..], x),
                false => (self.m.col(c).as_slice(), self.scale[c] * x),
            })
            .collect();
        if self.n * terms.len() < SHARED {
            return kernels::add_columns(y, &terms);
        }
        let rows_each = row_block(self.n);
        y.par_chunks_mut(rows_each).enumerate().for_each(|(k, part)| {
            let rows = k * rows_each..k * rows_each + part.len();
            let terms: Vec<_> = terms.iter().map(|&(column, x)| (&column[rows.clone()], x)).collect();
            kernels::add_columns(part, &terms);
        });
    }

    fn refactor(&mut self) {
        let (m, d, n, scale, rows, columns) =
            (self.m, &self.d, self.n, &self.scale, &self.rows, &self.columns);
        let interrupted = || self.options.is_interrupted();
        let fill = |j: usize, out: &mut [f64]| {
            let c = columns[j];
            let (source, factor) = if c == n { (&d[..], 1.0) } else { (m.col(c).as_slice(), scale[c]) };
            out.iter_mut().zip(rows).for_each(|(entry, &i)| *entry = factor * source[i]);
        };
        self.factored = self.basis.factor(columns.len(), fill, &interrupted);
        self.stale = false;
    }

    /// Values of the basic variables from q (and from p), with one step of refinement.
    fn refresh(&mut self) {
        (self.x, self.w) = self.values(self.q);
        (self.x_tie, self.w_tie) = self.values(&self.tie);
    }

    fn values(&self, q: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut x = vec![0.0; self.columns.len()];
        let mut w = q.to_vec();
        for _ in 0..2 {
            let mut error: Vec<f64> = self.rows.iter().map(|&i| w[i]).collect();
            self.basis.solve(&mut error);
            x.iter_mut().zip(error).for_each(|(x, e)| *x -= e);
            w.copy_from_slice(q);
            self.combine(&x, &mut w);
        }
        self.rows.iter().for_each(|&i| w[i] = 0.0);
        (x, w)
    }

    /// Draws positive values of the second right-hand side here and works out the p that belongs to them.
    fn perturb(&mut self) {
        self.perturbations += 1;
        self.visited.clear();
        let draw = |k: usize| draw(k, self.perturbations);
        self.x_tie = self.columns.iter().map(|&c| draw(c)).collect();
        let mut tie: Vec<f64> = (0..self.n).map(|i| draw(self.n + 1 + i)).collect();
        self.rows.iter().for_each(|&i| tie[i] = 0.0);
        self.w_tie = tie.clone();
        let down: Vec<f64> = self.x_tie.iter().map(|x| -x).collect();
        self.combine(&down, &mut tie);
        self.tie = tie;
    }

    fn tie_tolerance(&self) -> f64 {
        TIE * self.x.iter().fold(1.0, |size: f64, x| size.max(x.abs()))
    }

    fn ray(&self, entering: Entering) -> (Vec<f64>, f64) {
        let size = self.dx.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        let clean = |rate: f64| if rate > self.pivot_tol * size { rate / size } else { 0.0 };
        let mut z = vec![0.0; self.n];
        let mut z0 = 0.0;
        for (&c, &rate) in self.columns.iter().zip(&self.dx) {
            if c == self.n { z0 = clean(rate) } else { z[c] = self.scale[c] * clean(rate) }
        }
        if let Entering::Z(r) = entering {
            z[r] = self.scale[r] / size;
        }
        (z, z0)
    }

    /// z in the reduced problem's units: for an answer solved from the final basis and refined, else as it stands.
    fn finish(&mut self, status: LcpStatus) -> Outcome {
        if status == LcpStatus::Solved {
            let mut best = f64::INFINITY;
            let mut chosen = self.x.clone();
            for attempt in 0..2 {
                if attempt == 1 {
                    self.refactor();
                }
                let (x, mut w) = self.values(self.q);
                w.copy_from_slice(self.q);
                let clipped: Vec<f64> = x.iter().map(|&x| x.max(0.0)).collect();
                self.combine(&clipped, &mut w);
                let mut worst = w.iter().fold(0.0, |worst: f64, &w| nan_max(worst, -w));
                for (&c, &x) in self.columns.iter().zip(&clipped) {
                    worst = nan_max(worst, w[c].min(x).abs());
                }
                if worst < best {
                    (best, chosen) = (worst, clipped);
                }
                if best < 1e-13 {
                    break;
                }
            }
            self.x = chosen;
        }
        let mut z = vec![0.0; self.n];
        for (&c, &x) in self.columns.iter().zip(&self.x) {
            if c != self.n {
                z[c] = self.scale[c] * x.max(0.0);
            }
        }
        Outcome { status, z, pivots: self.pivots, ray: None, work: self.work }
    }
}

impl From<NoFactor> for LcpStatus {
    fn from(reason: NoFactor) -> Self {
        match reason {
            NoFactor::Singular => Self::Breakdown,
            NoFactor::Interrupted => Self::Interrupted,
        }
    }
}

impl Entering {
    fn hash(self) -> u64 {
        match self {
            Self::Z(i) => hash((1 << 62) | i as u64),
            Self::W(i) => hash((1 << 63) | i as u64),
        }
    }
}

fn advance(values: &mut [f64], rates: &[f64], step: f64) {
    values.iter_mut().zip(rates).for_each(|(value, rate)| *value += step * rate);
}

/// A value in [1, 2) for each index and seed.
pub(super) fn draw(index: usize, seed: u64) -> f64 {
    1.0 + (hash(index as u64 ^ (seed << 40)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// SplitMix64 (Steele, Lea, Flood 2014).
fn hash(seed: u64) -> u64 {
    let mut x = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
