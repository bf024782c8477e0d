//! What a body refuses or warns of before anything is solved: crossings, thin tissue, bones that touch, damaged parts.

pub(crate) mod distance;
pub(crate) mod parts;
pub(crate) mod tissue;
