//! Pressure at the vertices, its means over discs, and what facets and creases do to its peak.

pub(crate) mod creases;
pub(crate) mod facets;
pub(crate) mod means;
pub(crate) mod recovery;
pub(crate) mod vertices;
