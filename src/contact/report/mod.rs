//! What the user is told beside the figures: what the scene did not need, and warnings.

pub(crate) mod left_out;
pub(crate) mod warnings;
