//! The field of a load far away, from its moments about a center.
//!
//! [`multipole`] for 1/r, a harmonic function: (p + 1)² moments of order p and no highest order. [`taylor`] for any
//! other radial kernel: every derivative counts, 420 moments of degree 9. Both start from [`point_loads`].

pub(crate) mod multipole;
pub(crate) mod point_loads;
pub(crate) mod taylor;
