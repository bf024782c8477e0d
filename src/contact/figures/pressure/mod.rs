//! Pressure at the vertices, its means over discs, and what facets do to its peak.

pub(crate) mod facets;
pub(crate) mod means;
pub(crate) mod recovery;
pub(crate) mod vertices;
