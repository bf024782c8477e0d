//! An obstacle on its way along a line.

pub(crate) mod first_touch;
pub(crate) mod march;
pub(crate) mod shadow;
pub(crate) mod sweep;
