//! A press whose obstacle turns until the moment about a point vanishes.
//!
//! With E the elastic energy at a depth δ and angles θ of the obstacle about the axes a through the point P, the force F
//! along the press and the moment M about P are its derivatives,
//!
//! ```text
//! F = dE/dδ,    a_k . M = dE/dθ_k
//! ```
//!
//! so that the balance `a_k . M = 0`, at a depth or under a force, is where E (less the work of the force) is least.
//! [`axes`] says what may turn, [`tilted`] which moments are left, [`turns`] solves the contact at some angles, [`rest`] looks for
//! those at rest, [`goal`] does so on the given mesh and on the refined one.

pub(crate) mod axes;
pub(crate) mod goal;
pub(crate) mod rest;
pub(crate) mod tilted;
pub(crate) mod turns;
