//! Response matrices from their columns, in collocation and Galerkin form, and what is known of them.

pub(crate) mod average;
pub(crate) mod collocation;
pub(crate) mod displaced;
pub(crate) mod fill;
pub(crate) mod galerkin;
pub(crate) mod kept_block;
pub(crate) mod missing;
pub(crate) mod net_volume;
pub(crate) mod options;
