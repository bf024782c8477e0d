//! What is read off the node forces: pressure, area, resultants, displacement, and how far each can be trusted.

pub(crate) mod accuracy;
pub(crate) mod area;
pub(crate) mod at_rest;
pub(crate) mod beside;
pub(crate) mod between;
pub(crate) mod cells;
pub(crate) mod displacement;
pub(crate) mod drawn;
pub(crate) mod facets;
pub(crate) mod fade;
pub(crate) mod loaded;
pub(crate) mod loaded_edge;
pub(crate) mod mean_pressure;
pub(crate) mod motion;
pub(crate) mod moved_product;
pub(crate) mod penetration;
pub(crate) mod pressure;
pub(crate) mod receding;
pub(crate) mod recovery;
pub(crate) mod resultant;
pub(crate) mod rim;
