//! The field of a load far away, from its moments about a centre.

pub(crate) mod multipole;
pub(crate) mod taylor;
