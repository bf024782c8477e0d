//! The shared library that Python loads: the module `_core` of the crate, and nothing of its own.
//!
//! It is a crate of its own so that tests and extension share one compiled `quasirigid`.

#![allow(unused_imports, reason = "linked for the module's entry point")]

use quasirigid as _;
