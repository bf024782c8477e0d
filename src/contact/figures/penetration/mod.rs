//! How deep skin and obstacle stand in one another, at vertices and between them.

pub(crate) mod after;
pub(crate) mod at_rest;
pub(crate) mod between;
pub(crate) mod receding;
