//! The reference solutions against one another, against integrals and published series.

mod cone {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;
    use quasirigid::reference::Cone;

    const BLUNT: Cone = Cone { semi_angle: 1.4, contact_modulus: 0.24e6 };

    #[test]
    fn load_is_the_slope_of_the_energy() {
        let (approach, step) = (0.5e-3, 1e-8);
        let slope = (BLUNT.energy(approach + step) - BLUNT.energy(approach - step)) / (2.0 * step);
        // Central difference: relative error (step / approach)² / 3; cancellation about 1e-16 · approach / step.
        assert_relative_eq!(slope, BLUNT.force(approach), max_relative = 1e-9);
    }

    #[test]
    fn pressure_integrates_to_the_load() {
        let (approach, n) = (0.5e-3, 100_000);
        let a = BLUNT.contact_radius(approach);
        let sum: f64 = (0..n)
            .map(|i| {
                let r = a * (i as f64 + 0.5) / n as f64;
                BLUNT.pressure(approach, r) * 2.0 * PI * r * a / n as f64
            })
            .sum();
        // Midpoint rule with a square-root end: error of order n^{-3/2}.
        assert_relative_eq!(sum, BLUNT.force(approach), max_relative = 1e-7);
    }

    #[test]
    fn approach_and_load_are_those_of_sneddon_s_integrals() {
        // Of a punch of profile f: δ = ∫ a f'(r) / √(a² − r²) dr, F = 2 E* ∫ r² f'(r) / √(a² − r²) dr over r from 0 to
        // a (Sneddon 1965, eq. 6.1, 6.2); a cone has f' = cot α, and r = a sin t takes the root away.
        let (approach, n) = (0.5e-3, 1000);
        let (a, slope) = (BLUNT.contact_radius(approach), 1.0 / BLUNT.semi_angle.tan());
        let step = 0.5 * PI / n as f64;
        let angles = (0..n).map(|i| (i as f64 + 0.5) * step);
        let found: f64 = angles.clone().map(|_| a * slope * step).sum();
        assert_relative_eq!(found, approach, max_relative = 1e-12);
        let load: f64 =
            angles.map(|t| 2.0 * BLUNT.contact_modulus * (a * t.sin()).powi(2) * slope * step).sum();
        assert_relative_eq!(load, BLUNT.force(approach), max_relative = 1e-12);
    }
}

mod cored_sphere {
    use quasirigid::reference::{CoredSphere, Hertz, contact_modulus, plate_on_cored_sphere};

    #[test]
    fn the_core_stiffens_and_the_more_so_the_deeper() {
        for CoredSphere { poisson_ratio, indentations, .. } in plate_on_cored_sphere() {
            let contact_modulus = contact_modulus(CoredSphere::SHEAR_MODULUS, poisson_ratio);
            let hertz = Hertz { radius: CoredSphere::RADIUS, contact_modulus };
            let ratios = indentations.map(|(depth, force)| force / hertz.force(depth));
            assert!(1.0 < ratios[0] && ratios.is_sorted(), "{ratios:?}");
            // Shallow, the core is 5 mm below a contact of 0.9 mm and the sphere as good as a half-space.
            assert!(ratios[0] < 1.15, "{ratios:?}");
        }
    }
}

mod flat_punch {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;
    use quasirigid::reference::FlatPunch;

    const PUNCH: FlatPunch = FlatPunch { radius: 5e-3, contact_modulus: 0.24e6 };

    #[test]
    fn pressure_integrates_to_the_load() {
        // r = a sin t removes the singular rim: the integrand becomes smooth, the midpoint rule second order.
        let (approach, n) = (1e-3, 1000);
        let sum: f64 = (0..n)
            .map(|i| {
                let t = PI / 2.0 * (i as f64 + 0.5) / n as f64;
                let r = PUNCH.radius * t.sin();
                let dr = PUNCH.radius * t.cos() * PI / 2.0 / n as f64;
                PUNCH.pressure(approach, r) * 2.0 * PI * r * dr
            })
            .sum();
        assert_relative_eq!(sum, PUNCH.force(approach), max_relative = 1e-6);
    }

    #[test]
    fn far_field_is_that_of_a_point_load() {
        let (approach, r) = (1e-3, 5.0);
        let point_load = PUNCH.force(approach) / (PI * PUNCH.contact_modulus * r);
        // asin(x) = x (1 + x²/6 + …) with x = 1e-3.
        assert_relative_eq!(PUNCH.displacement(approach, r), point_load, max_relative = 2e-7);
    }
}

mod hertz {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;
    use quasirigid::reference::Hertz;

    const SPHERE: Hertz = Hertz { radius: 0.2, contact_modulus: 0.24e6 };

    #[test]
    fn load_is_the_slope_of_the_energy() {
        let (approach, step) = (0.5e-3, 1e-8);
        let slope = (SPHERE.energy(approach + step) - SPHERE.energy(approach - step)) / (2.0 * step);
        // Central difference: relative error (step / approach)²; cancellation about 1e-16 · approach / step.
        assert_relative_eq!(slope, SPHERE.force(approach), max_relative = 1e-9);
    }

    #[test]
    fn pressure_integrates_to_the_load() {
        let approach = 0.5e-3;
        let a = SPHERE.contact_radius(approach);
        let n = 200_000;
        let sum: f64 = (0..n)
            .map(|i| {
                let r = a * (i as f64 + 0.5) / n as f64;
                SPHERE.pressure(approach, r) * 2.0 * PI * r * a / n as f64
            })
            .sum();
        // Midpoint rule with a square-root end: error of order n^{-3/2}.
        assert_relative_eq!(sum, SPHERE.force(approach), max_relative = 1e-7);
    }

    #[test]
    fn approach_inverts_force() {
        assert_relative_eq!(SPHERE.approach(SPHERE.force(3e-4)), 3e-4, max_relative = 1e-14);
    }

    #[test]
    fn load_is_the_same_in_millimetres_and_metres() {
        let mm = Hertz { radius: 8.0, contact_modulus: 0.2 }.force(0.5);
        let m = Hertz { radius: 8.0e-3, contact_modulus: 0.2e6 }.force(0.5e-3);
        assert_relative_eq!(mm, m, max_relative = 1e-14);
    }
}

mod layer {
    use quasirigid::reference::{layer_correction_at_load, point_load_on_layer, sphere_on_layer};

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

    #[test]
    fn near_the_load_the_layer_is_the_half_space_less_its_correction() {
        let (distance, displacement) = point_load_on_layer()[0];
        let (_, correction) = layer_correction_at_load()[0];
        // The correction falls by some (r/h)².
        assert!((displacement - (1.0 / distance - correction)).abs() < distance * distance);
    }
}
