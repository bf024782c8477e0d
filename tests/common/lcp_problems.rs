//! Complementarity problems with seeds, for tests and benches.
#![allow(dead_code, reason = "each of the tests and benches uses a part")]

use faer::Mat;

/// A reproducible stream of values in [-1, 1) (SplitMix64).
pub struct Noise(pub u64);

impl Noise {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    pub fn value(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// An integer in -span ..= span.
    pub fn integer(&mut self, span: usize) -> f64 {
        self.below(2 * span + 1) as f64 - span as f64
    }

    pub fn matrix(&mut self, rows: usize, columns: usize) -> Mat<f64> {
        Mat::from_fn(rows, columns, |_, _| self.value())
    }
}

/// A small problem of one of eleven kinds, among them singular, degenerate, copositive and indefinite ones.
pub fn small_problem(noise: &mut Noise, largest: usize) -> (Mat<f64>, Vec<f64>, &'static str) {
    let n = 1 + noise.below(largest);
    let g = noise.matrix(n, n);
    let thin = noise.matrix(n, n.div_ceil(2));
    let (m, kind) = match noise.below(11) {
        0 => (g, "any"),
        1 => (&g * g.transpose() + Mat::<f64>::identity(n, n) * 0.1, "definite"),
        2 => (&thin * thin.transpose(), "semidefinite"),
        3 => (&g - g.transpose(), "skew"),
        4 => (&thin * thin.transpose() + &g - g.transpose(), "semidefinite and skew"),
        5 => (Mat::from_fn(n, n, |i, j| g[(i, j)].abs() + if i == j { 0.1 } else { 0.0 }), "nonnegative"),
        6 => (Mat::from_fn(n, n, |_, _| noise.integer(2)), "small integers"),
        7 => (Mat::from_fn(n, n, |i, j| if i == j { 1.0 } else { -g[(i, j)].abs() / n as f64 }), "M-matrix"),
        8 => (Mat::from_fn(n, n, |i, j| 0.5_f64.powi((i / 2).abs_diff(j / 2) as i32)), "coincident nodes"),
        9 => {
            let triangular = Mat::from_fn(n, n, |i, j| match i.cmp(&j) {
                std::cmp::Ordering::Equal => 1.0,
                std::cmp::Ordering::Less => 2.0 * g[(i, j)],
                std::cmp::Ordering::Greater => 0.0,
            });
            (triangular, "triangular P")
        }
        _ => (Mat::from_fn(n, n, |_, _| noise.integer(1)), "signs"),
    };
    (m, any_q(noise, n), kind)
}

/// A q of real numbers, of small integers or of -1 alone.
pub fn any_q(noise: &mut Noise, n: usize) -> Vec<f64> {
    match noise.below(3) {
        0 => (0..n).map(|_| noise.value()).collect(),
        1 => (0..n).map(|_| noise.integer(2)).collect(),
        _ => vec![-1.0; n],
    }
}

/// Kinds for which theory promises that a ray means that there is no solution.
pub const RAY_MEANS_INFEASIBLE: [&str; 7] = [
    "definite",
    "semidefinite",
    "skew",
    "semidefinite and skew",
    "M-matrix",
    "triangular P",
    "coincident nodes",
];

/// Kinds with positive principal minors.
pub const P_MATRICES: [&str; 3] = ["definite", "M-matrix", "triangular P"];

/// Triangle of ones and twos below the diagonal.
fn twos_below(n: usize) -> Mat<f64> {
    Mat::from_fn(n, n, |i, j| match i.cmp(&j) {
        std::cmp::Ordering::Equal => 1.0,
        std::cmp::Ordering::Less => 0.0,
        std::cmp::Ordering::Greater => 2.0,
    })
}

/// Murty's q, on which complementary pivoting from a covering vector of ones is exponential.
fn murty_q(n: usize) -> Vec<f64> {
    (0..n).map(|i| -(0..=i).map(|j| 2_f64.powi((n - j) as i32)).sum::<f64>()).collect()
}

/// Exponential examples: name, M, q (Murty 1978; Fathi 1979; Chandrasekaran, Pang, Stone 1987).
pub fn exponential_examples(n: usize) -> Vec<(&'static str, Mat<f64>, Vec<f64>)> {
    let below = twos_below(n);
    let above = below.transpose().to_owned();
    let symmetric = &below * &above;
    let mut examples = Vec::new();
    for (kind, q) in [("ones", vec![-1.0; n]), ("powers", murty_q(n))] {
        for (name, m) in [("below", &below), ("above", &above), ("symmetric", &symmetric)] {
            let name = match (name, kind) {
                ("below", "ones") => "twos below, ones",
                ("above", "ones") => "twos above, ones",
                ("symmetric", "ones") => "Fathi, ones",
                ("below", _) => "twos below, powers",
                ("above", _) => "twos above, powers",
                _ => "Fathi, powers",
            };
            examples.push((name, m.clone(), q.clone()));
        }
    }
    examples
}

/// Murty's circulant on which block exchanges run in circles: M e_i + 2 e_{i+1}, q = -1 (n odd: a P-matrix).
pub fn circulant(n: usize) -> (Mat<f64>, Vec<f64>) {
    let m = Mat::from_fn(n, n, |i, j| match (j + n - i) % n {
        0 => 1.0,
        1 => 2.0,
        _ => 0.0,
    });
    (m, vec![-1.0; n])
}

/// A P-matrix of about the given condition, `D1 (A A' + skew) D2` with graded positive diagonals.
pub fn graded_p_matrix(noise: &mut Noise, n: usize, condition: f64) -> Mat<f64> {
    let a = noise.matrix(n, n);
    let b = noise.matrix(n, n);
    let core = &a * a.transpose() * (1.0 / n as f64) + &b - b.transpose() + Mat::<f64>::identity(n, n);
    let grade = |i: usize| condition.powf(-0.5 * i as f64 / (n - 1).max(1) as f64);
    Mat::from_fn(n, n, |i, j| grade(i) * core[(i, j)] * grade(j))
}

/// A rigid sphere on an elastic half-space over a square grid of `side × side` nodes.
pub struct GridContact {
    /// Response (m/N), symmetric.
    pub m: Mat<f64>,
    /// Parabolic gap (m).
    pub q: Vec<f64>,
}

/// Grid of spacing h (m), sphere radius (m), depth (m); hat-function pressure, G = 60 kPa, ν = 0.5.
pub fn grid_contact(side: usize, spacing: f64, radius: f64, depth: f64) -> GridContact {
    let kernel = (1.0 - 0.5) / (2.0 * std::f64::consts::PI * 60e3);
    let table = hat_table(side);
    let n = side * side;
    // u = K h ∫ hat / r dA for the unit grid, force = pressure times vertex area h².
    let m = Mat::from_fn(n, n, |i, j| {
        let (di, dj) = ((i / side).abs_diff(j / side), (i % side).abs_diff(j % side));
        kernel / spacing * table[di * side + dj]
    });
    let q = (0..n)
        .map(|i| {
            let half = (side - 1) as f64 / 2.0;
            let (x, y) = ((i / side) as f64 - half, (i % side) as f64 - half);
            (x * x + y * y) * spacing * spacing / (2.0 * radius) - depth
        })
        .collect();
    GridContact { m, q }
}

/// `∫ hat(y) / |y - (di, dj)| dA` over the unit grid for every offset, hat bilinear.
///
/// Each quadrant of the bilinear hat is integrated by subdividing towards the singular corner (Duffy).
fn hat_table(side: usize) -> Vec<f64> {
    // Gauss-Legendre on [0, 1], eight points.
    let (x, w) = gauss();
    let mut table = vec![0.0; side * side];
    for di in 0..side {
        for dj in 0..=di {
            let (px, py) = (di as f64, dj as f64);
            let hat = |x: f64, y: f64| (1.0 - x.abs()) * (1.0 - y.abs());
            let mut sum = 0.0;
            for (cx, cy) in [(-1.0, -1.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 0.0)] {
                // The point is a corner of this cell or outside it.
                let corner_x: f64 = if px <= cx { 0.0 } else { 1.0 };
                let corner_y: f64 = if py <= cy { 0.0 } else { 1.0 };
                let near = (px - cx - corner_x).abs() < 0.5 && (py - cy - corner_y).abs() < 0.5;
                for (a, wa) in x.iter().zip(&w) {
                    for (b, wb) in x.iter().zip(&w) {
                        let mut add = |u: f64, v: f64, weight: f64| {
                            let u = if corner_x == 0.0 { u } else { 1.0 - u };
                            let v = if corner_y == 0.0 { v } else { 1.0 - v };
                            let (qx, qy) = (cx + u, cy + v);
                            sum += weight * hat(qx, qy) / (qx - px).hypot(qy - py);
                        };
                        if near {
                            add(*a, a * b, wa * wb * a);
                            add(a * b, *a, wa * wb * a);
                        } else {
                            add(*a, *b, wa * wb);
                        }
                    }
                }
            }
            table[di * side + dj] = sum;
            table[dj * side + di] = sum;
        }
    }
    table
}

fn gauss() -> ([f64; 8], [f64; 8]) {
    let half = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    let (mut x, mut w) = ([0.0; 8], [0.0; 8]);
    for (k, (node, weight)) in half.into_iter().enumerate() {
        (x[2 * k], w[2 * k]) = ((1.0 - node) / 2.0, weight / 2.0);
        (x[2 * k + 1], w[2 * k + 1]) = ((1.0 + node) / 2.0, weight / 2.0);
    }
    (x, w)
}
