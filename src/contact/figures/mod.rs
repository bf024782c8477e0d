//! What is read off the node forces: pressure, area, resultants, displacement, and how far each can be trusted.

pub(crate) mod accuracy;
pub(crate) mod area;
pub(crate) mod loaded;
pub(crate) mod motion;
pub(crate) mod penetration;
pub(crate) mod pressure;
pub(crate) mod resultant;
