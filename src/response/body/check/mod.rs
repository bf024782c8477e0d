//! What a body refuses or warns of before anything is solved: crossings, thin tissue, bones that touch.

pub(crate) mod distance;
pub(crate) mod tissue;
