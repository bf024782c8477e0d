//! The kernels: displacement `u(r)` (m/N) at distance r from a unit force, and the material in them.

pub(crate) mod basis;
mod bessel;
pub(crate) mod layer;
pub(crate) mod layer_table;
pub(crate) mod skin;
pub(crate) mod thickness;
