//! What a contact in Galerkin form keeps: pressure above the mean, figures that do not turn, a word where it is too shallow.

use approx::assert_relative_eq;
use nalgebra::{Matrix3, Rotation3, Vector3};
use quasirigid::contact::{ContactOptions, ContactStatus, Goal, WarningKind};
use quasirigid::obstacle::Obstacle;
use quasirigid::response::{Discretization, Kernel};
use quasirigid::surface::Surface;

use crate::common::{Random, icosphere};
use crate::{ball, galerkin, half_space, lattice, plate, press_up, pressed, skin, solve, surface};

#[test]
fn no_patch_carries_its_force_above_its_largest_pressure() {
    let mut random = Random(3);
    let h = 1e-3;
    let mut fewest = usize::MAX;
    // From contacts of one vertex on, under round and sharp obstacles.
    for k in 0..60 {
        let shift = h * Vector3::new(random.next() - 0.5, random.next() - 0.5, 0.0);
        let surface = lattice(12, [h * Vector3::x(), h * Vector3::y()], shift, 0.3, &mut random);
        let depth = h * 10_f64.powf(-2.5 + 2.0 * random.next());
        let obstacle = match k % 3 {
            0 => {
                Obstacle::sphere(Vector3::new(0.0, 0.0, 5.0 * h - depth), 5.0 * h).expect("a valid obstacle")
            }
            1 => Obstacle::cuboid(h * Vector3::new(0.7, 2.2, 1.0))
                .expect("a valid obstacle")
                .moved(&Matrix3::identity(), &Vector3::new(0.0, 0.0, h - depth))
                .expect("a rigid motion"),
            _ => Obstacle::capsule(h * Vector3::new(-9.0, 0.0, 1.0), h * Vector3::new(9.0, 0.0, 1.0), h)
                .expect("a valid obstacle")
                .moved(&Matrix3::identity(), &Vector3::new(0.0, 0.0, -depth))
                .expect("a rigid motion"),
        };
        let contact = solve(&surface, &obstacle, &galerkin());
        let highest = (contact.active.iter())
            .map(|&vertex| contact.node_force[vertex] / surface.vertex_areas()[vertex])
            .fold(0.0, f64::max);
        for patch in &contact.patches {
            fewest = fewest.min(patch.vertices.len());
            let force: f64 = patch.vertices.iter().map(|&vertex| contact.node_force[vertex]).sum();
            let mean = force / patch.resultant.contact_area;
            assert!(mean <= patch.resultant.max_pressure * (1.0 + 1e-12), "scene {k}");
            assert!(mean <= highest * (1.0 + 1e-12), "scene {k}");
        }
        let of_patches = contact.patches.iter().map(|patch| patch.resultant.max_pressure);
        assert_eq!(of_patches.fold(0.0, f64::max), contact.resultant.max_pressure);
    }
    assert_eq!(fewest, 1);
}

#[test]
fn the_figures_do_not_turn_with_the_scene() {
    let layer = skin(Kernel::Layer { thickness: 4e-3.into() });
    let layer = layer.with_discretization(Discretization::Galerkin).expect("a layer has it");
    let surface = surface(icosphere(8e-3, 3));
    let sphere = Obstacle::sphere(Vector3::new(0.3e-3, 0.2e-3, 37.2e-3), 30e-3).expect("a valid obstacle");
    let rotation = Rotation3::new(Vector3::new(0.4, 1.1, -0.7));
    let shift = Vector3::new(0.03, -0.02, 0.05);
    let turned_sphere = sphere.moved(rotation.matrix(), &shift).expect("a rigid motion");
    let moved = surface.with_vertices(surface.vertices().iter().map(|x| rotation * x + shift).collect());
    for skin in [galerkin(), layer] {
        let straight = solve(&surface, &sphere, &skin).resultant;
        let turned = solve(&moved, &turned_sphere, &skin).resultant;
        assert_relative_eq!(turned.contact_area, straight.contact_area, max_relative = 1e-9);
        assert_relative_eq!(turned.max_pressure, straight.max_pressure, max_relative = 1e-9);
    }
}

#[test]
fn a_press_too_shallow_for_the_mesh_keeps_its_penetration_and_says_so() {
    let contact = press_up(&ball(8e-3, 3), &plate(), &galerkin(), 1e-5);
    assert_eq!(contact.status, ContactStatus::Solved);
    assert_eq!(contact.resultant.force, Vector3::zeros());
    assert_relative_eq!(contact.max_penetration_after, 1e-5, max_relative = 1e-9);
    assert!(contact.warnings[0].message.contains("refine the mesh"), "{:?}", contact.warnings);
}

#[test]
fn an_obstacle_between_the_vertices_is_met_as_in_collocation_and_called_too_small_for_the_mesh() {
    let h = 1e-3;
    let mut random = Random(5);
    let surface = lattice(12, [h * Vector3::x(), h * Vector3::y()], Vector3::zeros(), 0.0, &mut random);
    // In the middle of a triangle, a tenth of an edge deep and a fifth wide.
    let depth = 0.1 * h;
    let center = Vector3::new(h / 3.0, 2.0 * h / 3.0, 0.2 * h - depth);
    let ball = Obstacle::sphere(center, 0.2 * h).expect("a valid obstacle");
    let [own, collocation] = [galerkin(), half_space()].map(|skin| solve(&surface, &ball, &skin));
    assert_eq!(own.active, collocation.active);
    assert_eq!(own.active.len(), 3);
    assert_relative_eq!(own.resultant.force.z, collocation.resultant.force.z, max_relative = 0.2);
    for contact in [own, collocation] {
        assert_relative_eq!(contact.max_penetration_before, depth, max_relative = 0.05);
        let kinds: Vec<WarningKind> = contact.warnings.iter().map(|warning| warning.kind).collect();
        assert_eq!(kinds, [WarningKind::CoarseMesh]);
    }
}

/// Where no average is closed nothing moves, whichever vertices the response looks at.
#[test]
fn a_tip_between_the_vertices_of_a_layer_stays_in_it_until_the_mesh_is_refined() {
    let surface = ball(8e-3, 2);
    let middle =
        |face: &[u32; 3]| face.iter().map(|&v| surface.vertices()[v as usize]).sum::<Vector3<f64>>() / 3.0;
    let middles = surface.faces().iter().map(middle);
    let lowest = middles.min_by(|a, b| a.z.total_cmp(&b.z)).expect("some faces");
    let tip = Obstacle::sphere(Vector3::new(lowest.x, lowest.y, -0.01), 1e-3).expect("a sphere");
    let collocation = skin(Kernel::Layer { thickness: 4e-3.into() });
    let layer = collocation.clone().with_discretization(Discretization::Galerkin).expect("a layer has it");
    for depth in [1e-6, 1e-5] {
        let given = press_up(&surface, &tip, &layer, depth);
        assert_eq!(given.resultant.force, Vector3::zeros());
        assert_eq!(given.max_penetration_after, given.max_penetration_before);
        assert!(given.warnings[0].message.contains("refine the mesh"), "{:?}", given.warnings);

        let [averaged, pointwise] = [&layer, &collocation].map(|skin| {
            let options = ContactOptions::default();
            pressed(&surface, &tip, skin, Goal::Depth(depth), &options).resultant.force.z
        });
        // Each to the target of 2 %.
        assert_relative_eq!(averaged, pointwise, max_relative = 0.04);
    }
}

#[test]
fn skin_that_folds_around_a_rod_presses_as_in_collocation() {
    let (mut vertices, faces) = icosphere(8e-3, 3);
    vertices.iter_mut().for_each(|x| x.z += 8e-3);
    let ball = Surface::new(vertices, faces).unwrap();
    for (size, depth) in [(1e-3, 1e-3), (2e-3, 2e-3), (0.7e-3, 1.4e-3)] {
        let end = |x: f64| Vector3::new(x, 0.0, -2.0 * size);
        let rod = Obstacle::capsule(end(-20e-3), end(20e-3), size).unwrap();
        let [averaged, pointwise] = [galerkin(), half_space()]
            .map(|skin| pressed(&ball, &rod, &skin, Goal::Depth(depth), &ContactOptions::default()));
        assert_relative_eq!(averaged.resultant.force.z, pointwise.resultant.force.z, max_relative = 0.02);
        assert!(pointwise.max_penetration_after < 0.05 * depth);
    }
}

#[test]
fn on_an_obstacle_that_curves_away_from_the_press_no_vertex_keeps_more_of_a_gap_than_its_triangles_sag() {
    let h = 0.1e-3;
    let (radius, depth) = (10.0 * h, 5.0 * h);
    for seed in 0..4 {
        let surface =
            lattice(24, [h * Vector3::x(), h * Vector3::y()], Vector3::zeros(), 0.25, &mut Random(seed));
        let ball =
            Obstacle::sphere(Vector3::new(0.0, 0.0, radius - depth), radius).expect("a valid obstacle");
        let contact = solve(&surface, &ball, &galerkin());
        // Where all triangles around carry force.
        let is_inside = |vertex: usize| {
            surface.neighbours(vertex).iter().all(|&other| contact.node_force[other as usize] > 0.0)
        };
        let inside: Vec<usize> = contact.active.iter().copied().filter(|&vertex| is_inside(vertex)).collect();
        assert!(inside.len() > 50, "{}", inside.len());
        let most = inside.iter().map(|&vertex| contact.gap[vertex].abs()).fold(0.0, f64::max);
        let length = |a: usize, b: u32| (surface.vertices()[a] - surface.vertices()[b as usize]).norm();
        let edges = inside
            .iter()
            .flat_map(|&vertex| surface.neighbours(vertex).iter().map(move |&other| (vertex, other)));
        let longest = edges.map(|(a, b)| length(a, b)).fold(0.0, f64::max);
        // A chord of the ball stands off it by as much.
        assert!(most < longest * longest / (8.0 * radius), "{most}");
    }
}
