//! Point load and rigid sphere on an elastic layer bonded to a rigid base; numbers by `tests/data/make_layer.py`.

/// A tabulated indentation of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerIndentation {
    /// Thinness χ = √(R δ) / h (dimensionless).
    pub thinness: f64,
    /// Force over Hertz's force for a half-space of the same material (dimensionless).
    pub force_ratio: f64,
    /// Relative accuracy of `force_ratio`.
    pub accuracy: f64,
}

/// Force of a rigid sphere of radius R on an incompressible bonded layer of thickness h, over Hertz's force.
///
/// Fredholm's equation of the layer's Hankel symbol (Hayes, Keer, Herrmann, Mockros 1972); an axisymmetric boundary
/// discretisation agrees to 1e-5, the series of Garcia & Garcia 2018 (Biophysical Journal 114) gives 1.520 for the
/// first entry.
pub fn sphere_on_layer() -> [LayerIndentation; 3] {
    [(0.3, 1.51822), (0.5, 2.15622), (0.7, 3.09818)].map(|(thinness, force_ratio)| LayerIndentation {
        thinness,
        force_ratio,
        accuracy: 1e-5,
    })
}

/// Surface displacement u by a point load on an incompressible bonded layer: pairs of `r / h` and `h u / K`.
///
/// `h u / K = h/r − ∫ (1 − W(t)) J0(t r/h) dt`, W the layer's Hankel symbol over the half-space's, K = (1 − ν) / (2 π G)
/// (m²/N); five decimals.
pub fn point_load_on_layer() -> [(f64, f64); 5] {
    [(0.1, 8.23932), (0.5, 0.44430), (1.0, -0.12570), (2.0, -0.05275), (3.0, -0.01672)]
}

/// What a bonded layer takes off the half-space's displacement at the load: pairs of ν and `h (K/r − u) / K` at r → 0.
///
/// `φ(0) = ∫ (1 − W(t)) dt`, W the layer's Hankel symbol over the half-space's; four decimals.
pub fn layer_correction_at_load() -> [(f64, f64); 4] {
    [(0.5, 1.7702), (0.45, 1.6255), (0.4, 1.5187), (0.3, 1.3769)]
}
