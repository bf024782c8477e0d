//! The shared library that Python loads: the module `_core` of the crate `quasirigid`, and nothing of its own.
//!
//! It is a crate of its own so that tests and extension share one compiled `quasirigid`.

use quasirigid as _;
