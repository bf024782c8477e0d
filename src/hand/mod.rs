//! Posed hands: a skin that follows its joints.

mod skinning;

pub use skinning::{Blending, SkinWeights, SkinningError};
