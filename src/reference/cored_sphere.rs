//! Flat frictionless plate pressed against an elastic sphere on a rigid core.

/// Forces of a flat frictionless plate on an elastic sphere bonded to a rigid concentric core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoredSphere {
    /// Poisson's ratio ν (dimensionless).
    pub poisson_ratio: f64,
    /// Approach (m) and force (N) of the plate.
    pub indentations: [(f64, f64); 4],
}

impl CoredSphere {
    /// Radius of the sphere (m).
    pub const RADIUS: f64 = 8e-3;
    /// Radius of the core (m).
    pub const CORE_RADIUS: f64 = 3e-3;
    /// Shear modulus G (Pa).
    pub const SHEAR_MODULUS: f64 = 60e3;
    /// Relative accuracy of the forces.
    pub const ACCURACY: f64 = 2e-3;
}

/// Forces of a plate on a cored sphere at ν = 0.5, 0.495 and 0.3.
///
/// Axisymmetric finite elements and the series of the shell (`tests/data/make_cored_sphere.py`) agree to
/// [`CoredSphere::ACCURACY`].
pub fn plate_on_cored_sphere() -> [CoredSphere; 3] {
    let depths = [0.1e-3, 0.3e-3, 0.6e-3, 1.12e-3];
    [
        (0.5, [0.0308, 0.1685, 0.495, 1.297]),
        (0.495, [0.0306, 0.1670, 0.491, 1.288]),
        (0.3, [0.0224, 0.125, 0.376, 1.020]),
    ]
    .map(|(poisson_ratio, forces)| CoredSphere {
        poisson_ratio,
        indentations: [0, 1, 2, 3].map(|k| (depths[k], forces[k])),
    })
}
