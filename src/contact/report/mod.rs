//! What the user is told beside the figures: seconds per stage, what the scene did not need, warnings.

pub(crate) mod advice;
pub(crate) mod cuts;
pub(crate) mod digits;
mod given;
pub(crate) mod guards;
pub(crate) mod left_out;
mod product;
pub(crate) mod record;
pub(crate) mod warning;
pub(crate) mod warnings;
