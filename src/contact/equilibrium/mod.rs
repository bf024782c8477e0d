//! Node forces that end all penetration: `g = g0 + R f, g >= 0, f >= 0, g·f = 0` on the candidates.
//!
//! [`linearization`] takes g0 anew at the [`deformed`] skin, [`solve`] finds the forces of one g0 and lets the candidates grow
//! ([`growth`]), [`group`] poses the problem of those that feel each other with R from [`compliance`]; [`product`] is what an
//! elastic obstacle adds to it, [`forces`] what comes out, [`steep`] how much of that is a guess.

pub(crate) mod compliance;
pub(crate) mod deformed;
pub(crate) mod forces;
pub(crate) mod group;
pub(crate) mod growth;
pub(crate) mod linearization;
pub(crate) mod product;
pub(crate) mod solve;
pub(crate) mod steep;
