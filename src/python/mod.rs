//! Thin PyO3 layer: convert, detach, call, convert back.
