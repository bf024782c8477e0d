//! The product: a closed mesh or a primitive at a rigid pose, answering signed distances.
