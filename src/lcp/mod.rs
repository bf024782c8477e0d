//! The linear complementarity problem: for a square matrix `M` and a vector `q`, find `z` and `w` with
//!
//! ```text
//! w = M z + q,    w >= 0,    z >= 0,    w·z = 0
//! ```
//!
//! In contact `M` is the response matrix (m/N), `q` the initial gap (m), `z` the node forces (N) and `w` the
//! gaps (m), but nothing here knows of it: any real `M` is welcome, nonsymmetric, indefinite or singular.
//!
//! ```
//! use quasirigid::lcp::{LcpMethod, LcpOptions, LcpProblem, LcpStatus, LemkeOptions, solve};
//!
//! let m = faer::mat![[2.0, 1.0], [1.0, 2.0_f64]];
//! let q = [-5.0, -6.0];
//! let problem = LcpProblem::new(m.as_ref(), &q)?;
//! let lemke = LcpMethod::Lemke(LemkeOptions::default());
//! let solution = solve(&problem, &lemke, &LcpOptions::default())?;
//! assert_eq!(solution.status, LcpStatus::Solved);
//! assert!((solution.z[0] - 4.0 / 3.0).abs() < 1e-15 && (solution.z[1] - 7.0 / 3.0).abs() < 1e-15);
//! # Ok::<(), quasirigid::lcp::LcpError>(())
//! ```
//!
//! | method | for | needs |
//! |---|---|---|
//! | [`Lemke`](LcpMethod::Lemke) | any M; about one pivot for each unknown above zero, by blocks where [`crash`](LemkeOptions::crash) serves | columns of M as they enter |
//! | [`BlockPivoting`](LcpMethod::BlockPivoting) | M with positive principal minors; a few factors of the active block | that block |
//! | [`ProjectedCg`](LcpMethod::ProjectedCg) | M symmetric positive definite | products with M |
//! | [`Auto`](LcpMethod::Auto) | block pivoting, then Lemke; notes what it did | |
//!
//! Unknowns that no `z >= 0` can press (`q_i >= 0`, no negative entry in row i) are left out by all of them. Block
//! exchanges begin on the rows with `q_i < 0` and take in those that an answer presses below zero, so that they
//! read the columns that touch and little else of M.
//! Every entry of M that a solve reads must be finite: all of an M of at most 64 rows, of a larger one those that the
//! method needs, and all of it where the ending is not [`LcpStatus::Solved`]. An answer depends on the columns of its
//! `z > 0` alone; entries elsewhere may go unread. Of q every entry must be finite.
//!
//! Every answer, whichever method found it, is checked against the `M` and `q` as given; only one whose
//! [natural residual](Certificate::natural_residual) passes is called [`LcpStatus::Solved`].
//!
//! Sources: Lemke 1965 (Management Science 11, 681-689); Cottle, Pang, Stone 1992 ("The Linear
//! Complementarity Problem"); Júdice, Pires 1994 (Computers & Operations Research 21, 587-596); Polonsky,
//! Keer 1999 (Wear 231, 206-219); Dirkse, Ferris 1997 ("Crash techniques for large-scale
//! complementarity problems", in "Complementarity and Variational Problems: State of the Art", SIAM).

pub(crate) mod basis;
pub(crate) mod block_pivoting;
pub(crate) mod certificate;
pub(crate) mod lemke;
pub(crate) mod methods;
pub(crate) mod options;
pub(crate) mod outcome;
pub(crate) mod problem;
pub(crate) mod product;
pub(crate) mod projected_cg;
pub(crate) mod ray;
pub(crate) mod reduced;
pub(crate) mod row_extremes;
pub(crate) mod session;
pub(crate) mod solution;
pub(crate) mod solve;
pub(crate) mod symmetry;
pub(crate) mod touched_columns;

pub use crate::linalg::definiteness::Definiteness;
pub use certificate::Certificate;
pub use lemke::run::LemkeOptions;
pub use options::{DefinitenessCheck, LcpOptions};
pub use problem::{LcpError, LcpProblem};
pub use ray::{LcpRay, RayConclusion};
pub use solution::{LcpAttempt, LcpMethodName, LcpSolution, LcpStatus, StartingBasis};
pub use solve::{LcpMethod, solve};
