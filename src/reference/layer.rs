//! Rigid sphere on an incompressible elastic layer bonded to a rigid base.

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
/// Two independent numerical solutions (dual integral equations of the layer's Hankel symbol and an
/// axisymmetric boundary discretisation) agree to 1e-5. The first entry may be held against the series of
/// Garcia & Garcia 2018 (Biophysical Journal 114), which gives 1.520.
pub fn sphere_on_layer() -> [LayerIndentation; 3] {
    [(0.3, 1.518), (0.5, 2.156), (0.7, 3.098)].map(|(thinness, force_ratio)| LayerIndentation {
        thinness,
        force_ratio,
        accuracy: 0.5e-3 / force_ratio,
    })
}

#[cfg(test)]
mod tests {
    use super::sphere_on_layer;

    /// Series of Garcia & Garcia 2018 (Biophysical Journal 114) for a bonded incompressible layer.
    fn garcia(chi: f64) -> f64 {
        1.0 + 1.133 * chi + 1.497 * chi.powi(2) + 1.469 * chi.powi(3) + 0.755 * chi.powi(4)
    }

    #[test]
    fn table_agrees_with_the_published_series_where_the_series_holds() {
        let first = sphere_on_layer()[0];
        // The next term of the series is of order χ⁵ = 2.4e-3.
        assert!((first.force_ratio / garcia(first.thinness) - 1.0).abs() < 2.4e-3);
    }

    #[test]
    fn thinner_layers_are_stiffer() {
        let ratios = sphere_on_layer().map(|entry| entry.force_ratio);
        assert!(1.0 < ratios[0] && ratios.is_sorted());
    }
}
