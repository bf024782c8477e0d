//! Which vertices enter the complementarity problem, and which of them share one.
//!
//! [`groups`] poses a problem for those that feel each other. On a hand a kernel is cut between [`fingers`]: the share
//! ([`coupling`]) that they feel of each other hangs on the [`ways`] between them, along the skin and straight. Meshes
//! refined from the given one take them over ([`on_refined`]). [`watched`] are those whose displacement figures ask for.

pub(crate) mod coupling;
pub(crate) mod fingers;
pub(crate) mod groups;
pub(crate) mod on_refined;
pub(crate) mod watched;
pub(crate) mod ways;
