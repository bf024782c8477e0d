//! Which vertices enter the complementarity problem, and which of them share one.

pub(crate) mod coupling;
pub(crate) mod fingers;
pub(crate) mod groups;
pub(crate) mod ways;
