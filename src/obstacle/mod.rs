//! The product: a closed mesh or a primitive at a rigid pose, answering signed distances.

mod crossings;
mod triangle_pair;

pub use crossings::find_crossings;
