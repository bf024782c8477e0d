//! Flat plate or ball, rigid and frictionless, pressed against an elastic sphere on a rigid core.

/// Forces of a rigid frictionless indenter on an elastic sphere bonded to a rigid concentric core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoredSphere {
    /// Poisson's ratio ν (dimensionless).
    pub poisson_ratio: f64,
    /// Radius of the indenter (m), infinite for a flat plate.
    pub indenter_radius: f64,
    /// Approach (m) and force (N) of the indenter.
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

    fn new(poisson_ratio: f64, indenter_radius: f64, depths: [f64; 4], forces: [f64; 4]) -> Self {
        let indentations = std::array::from_fn(|k| (depths[k], forces[k]));
        Self { poisson_ratio, indenter_radius, indentations }
    }
}

/// Forces of a plate on a cored sphere at ν = 0.5, 0.495 and 0.3.
///
/// Axisymmetric finite elements and the series of the shell (`tests/data/make_cored_sphere.py`) agree to
/// [`CoredSphere::ACCURACY`].
pub fn plate_on_cored_sphere() -> [CoredSphere; 3] {
    [
        (0.5, [0.0308, 0.1685, 0.495, 1.297]),
        (0.495, [0.0306, 0.1670, 0.491, 1.288]),
        (0.3, [0.0224, 0.125, 0.376, 1.020]),
    ]
    .map(|(nu, forces)| CoredSphere::new(nu, f64::INFINITY, [0.1e-3, 0.3e-3, 0.6e-3, 1.12e-3], forces))
}

/// Forces of a ball of 15 mm radius on a cored sphere at ν = 0.495 and 0.3, by axisymmetric finite elements with the contact
/// solved to the end.
pub fn ball_on_cored_sphere() -> [CoredSphere; 2] {
    [(0.495, [0.1309, 0.3800, 0.9817, 2.3050]), (0.3, [0.0989, 0.2953, 0.7936, 1.9562])]
        .map(|(nu, forces)| CoredSphere::new(nu, 15e-3, [0.3e-3, 0.6e-3, 1.12e-3, 2e-3], forces))
}
