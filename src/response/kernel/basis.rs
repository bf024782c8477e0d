//! How a node's force is spread, and how its gap is taken.

/// Pressure that a node's unit force stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PressureBasis {
    /// Hat functions: linear over each triangle, f / S at the node. Accurate and well conditioned.
    #[default]
    Linear,
    /// Spread evenly over the one-ring (Xie, Kanai, Date 2011, eq. 8). Kept to reproduce that paper: on regular meshes the
    /// matrix is close to singular and the pressure oscillates.
    OneRing,
}

/// How the gap of a node is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Discretization {
    /// At the node. No penetration is left at vertices; R is not symmetric and, on badly shaped meshes, not always
    /// positive definite.
    #[default]
    Collocation,
    /// Averaged against the node's pressure, `R_ij = ∫∫ p_i(x) k(|x - y|) p_j(y) dA dA`. R is symmetric; positive definite
    /// on any surface for the half-space, as 1/r is an energy, and on any flat one for the layer. A vertex may keep a
    /// penetration of the order of the mesh error. Initial gaps are averaged likewise
    /// ([`pressure_average`](crate::response::pressure_average)).
    Galerkin,
}

impl Discretization {
    /// Its name in lower case.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Collocation => "collocation",
            Self::Galerkin => "galerkin",
        }
    }
}
