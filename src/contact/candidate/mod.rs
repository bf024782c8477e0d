//! Which vertices enter the complementarity problem, and which of them share one.

pub(crate) mod fingers;
pub(crate) mod groups;
