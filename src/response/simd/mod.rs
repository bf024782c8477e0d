//! Vectors of numbers for hot loops: arithmetic, elementary functions, points laid out for them.

pub(crate) mod functions;
pub(crate) mod lanes;
pub(crate) mod points;
