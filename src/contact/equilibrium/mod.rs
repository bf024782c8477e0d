//! Node forces that end all penetration: `g = g0 + R f, g >= 0, f >= 0, g·f = 0` on the candidates.

pub(crate) mod compliance;
pub(crate) mod forces;
pub(crate) mod group;
pub(crate) mod growth;
pub(crate) mod linearization;
pub(crate) mod product;
pub(crate) mod solve;
