//! The whole pipeline through the public API: known answers, invariance, endings.

mod common;

use approx::assert_relative_eq;
use common::{Random, grid, icosphere, one_diagonal_grid};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Vector3};
use quasirigid::contact::{
    Contact, ContactError, ContactOptions, ContactStatus, Press, Start, press, solve_contact,
};
use quasirigid::lcp::LcpStatus;
use quasirigid::obstacle::Obstacle;
use quasirigid::reference::{Hertz, contact_modulus};
use quasirigid::response::{Discretization, Kernel, KernelSkin, PressureBasis};
use quasirigid::surface::Surface;

const SHEAR_MODULUS: f64 = 60e3;
const POISSON_RATIO: f64 = 0.5;
const UP: Vector3<f64> = Vector3::new(0.0, 0.0, 1.0);

fn half_space(basis: PressureBasis) -> KernelSkin {
    let skin = KernelSkin::new(SHEAR_MODULUS, POISSON_RATIO, Kernel::HalfSpace);
    skin.expect("valid constants").with_basis(basis)
}

fn linear() -> KernelSkin {
    half_space(PressureBasis::Linear)
}

fn go_on() -> bool {
    false
}

fn solve(surface: &Surface, obstacle: &Obstacle, skin: &KernelSkin) -> Contact {
    solve_contact(surface, obstacle, skin, &ContactOptions::default(), &go_on).expect("a valid request")
}

fn press_up(surface: &Surface, obstacle: &Obstacle, skin: &KernelSkin, depth: f64) -> Contact {
    let upwards = Press { direction: UP, depth, start: Start::Infinity };
    press(surface, obstacle, skin, &upwards, &ContactOptions::default(), &go_on).expect("a valid request")
}

/// A sphere (m) pressed 0.5 mm into a flat skin with `cells` cells per contact radius, its inner vertices moved by
/// up to `jitter` cells.
fn hertz_contact_on(cells: usize, jitter: f64, radius: f64, skin: &KernelSkin) -> (Contact, Hertz, f64) {
    let hertz = Hertz { radius, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let approach = 0.5e-3;
    let spacing = hertz.contact_radius(approach) / cells as f64;
    let count = 2 * (cells + cells / 2);
    let (mut vertices, faces) = grid(count, count, spacing);
    let (middle, mut random) = (0.5 * count as f64 * spacing, Random(5));
    for vertex in &mut vertices {
        if (*vertex - Vector3::new(middle, middle, 0.0)).amax() < 0.999 * middle {
            vertex.x += jitter * spacing * (2.0 * random.next() - 1.0);
            vertex.y += jitter * spacing * (2.0 * random.next() - 1.0);
        }
    }
    let surface = Surface::new(vertices, faces).expect("a valid surface");
    let sphere = Obstacle::sphere(Vector3::new(middle, middle, hertz.radius - approach), hertz.radius)
        .expect("a valid obstacle");
    (solve(&surface, &sphere, skin), hertz, approach)
}

/// A sphere R = 200 mm pressed 0.5 mm into a regular flat skin.
fn hertz_contact(cells: usize, pressure: PressureBasis) -> (Contact, Hertz, f64) {
    hertz_contact_on(cells, 0.0, 0.2, &half_space(pressure))
}

fn force_error(cells: usize) -> f64 {
    let (contact, hertz, approach) = hertz_contact(cells, PressureBasis::Linear);
    (contact.resultant.force.norm() / hertz.force(approach) - 1.0).abs()
}

#[test]
fn a_sphere_on_flat_skin_gives_hertz_force_and_peak_pressure() {
    let (contact, hertz, approach) = hertz_contact(8, PressureBasis::Linear);
    assert_eq!(contact.status, ContactStatus::Solved);
    // 0.1 % of it is the true sphere against Hertz's parabola, the rest the mesh.
    assert_relative_eq!(contact.resultant.force.norm(), hertz.force(approach), max_relative = 2e-3);
    assert_relative_eq!(contact.resultant.max_pressure, hertz.max_pressure(approach), max_relative = 5e-3);
    // The sphere presses from above: the skin is pushed down.
    assert!(contact.resultant.force.z < 0.0);
    let skin = half_space(PressureBasis::Linear);
    let drawn = contact.drawn_skin(&skin, &ContactOptions::default(), &|| false).expect("not interrupted");
    assert!(drawn.volume_change < 0.0);
}

#[test]
fn the_error_against_hertz_falls_with_refinement() {
    let errors = [2, 4, 8].map(force_error);
    assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
}

#[test]
fn averaged_gaps_give_a_better_hertz_force_than_gaps_at_vertices() {
    let weighted = averaged(PressureBasis::Linear);
    // So flat a sphere is Hertz's parabola up to d / R = 2.5e-6, and all error the mesh's.
    let errors = |cells: usize, jitter: f64, skin: &KernelSkin| {
        let (contact, hertz, approach) = hertz_contact_on(cells, jitter, 200.0, skin);
        let force = contact.resultant.force.norm() / hertz.force(approach) - 1.0;
        let peak = contact.resultant.max_pressure / hertz.max_pressure(approach) - 1.0;
        (force.abs(), peak.abs(), contact.max_penetration_after / approach)
    };
    for jitter in [0.0, 0.25] {
        for cells in [4, 8] {
            let (node, averaged) = (errors(cells, jitter, &linear()), errors(cells, jitter, &weighted));
            assert!(averaged.0 < 0.5 * node.0, "force, {cells} cells: {averaged:?} {node:?}");
            assert!(averaged.1 < node.1, "peak, {cells} cells: {averaged:?} {node:?}");
            // A vertex may keep a penetration, of the order of the mesh error: edges of √2 h sag by h² / R at most.
            assert!(averaged.2 < 1.0 / (cells * cells) as f64, "{averaged:?}");
            assert!(node.2 < 1e-9, "{node:?}");
        }
    }
}

/// Flat lattice of `count`² cells with edges `first` and `second`, each cut by the diagonal between them, about the
/// origin moved by `shift`; inner vertices moved by up to `jitter` of `first`.
fn lattice(
    count: usize,
    [first, second]: [Vector3<f64>; 2],
    shift: Vector3<f64>,
    jitter: f64,
    random: &mut Random,
) -> Surface {
    let (mut vertices, faces) = one_diagonal_grid(count);
    for vertex in &mut vertices {
        let inner = [vertex.x, vertex.y].iter().all(|&at| 0.5 < at && at < count as f64 - 0.5);
        let mut moved = || if inner { jitter * first.norm() * (2.0 * random.next() - 1.0) } else { 0.0 };
        let moved = Vector3::new(moved(), moved(), 0.0);
        let (i, j) = (vertex.x - 0.5 * count as f64, vertex.y - 0.5 * count as f64);
        *vertex = i * first + j * second + shift + moved;
    }
    Surface::new(vertices, faces).expect("a valid surface")
}

/// Root mean squares of the errors of force, peak pressure and contact area against Hertz, over places of the sphere
/// on a mesh of `cells` cells per contact radius.
fn hertz_errors(skin: &KernelSkin, cells: usize, angle: f64, jitter: f64, places: usize) -> [f64; 3] {
    // So flat a sphere is Hertz's parabola up to d / R = 2.5e-6, and all error the mesh's.
    let hertz = Hertz { radius: 200.0, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let approach = 0.5e-3;
    let radius = hertz.contact_radius(approach);
    let sphere = Obstacle::sphere(Vector3::new(0.0, 0.0, hertz.radius - approach), hertz.radius)
        .expect("a valid obstacle");
    let mut random = Random(11);
    let mut sums = [0.0; 3];
    for _ in 0..places {
        // Neither the place in a cell nor the cells per radius are round numbers.
        let h = radius / (cells as f64 * (0.94 + 0.12 * random.next()));
        let edges = [h * Vector3::x(), h * Vector3::new(angle.cos(), angle.sin(), 0.0)];
        let shift = (random.next() - 0.5) * edges[0] + (random.next() - 0.5) * edges[1];
        let surface = lattice(4 * cells, edges, shift, jitter, &mut random);
        let found = solve(&surface, &sphere, skin).resultant;
        let errors = [
            found.force.norm() / hertz.force(approach) - 1.0,
            found.max_pressure / hertz.max_pressure(approach) - 1.0,
            found.contact_area / (std::f64::consts::PI * radius * radius) - 1.0,
        ];
        sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error * error);
    }
    sums.map(|sum| (sum / places as f64).sqrt())
}

#[test]
fn averaged_gaps_beat_gaps_at_vertices_in_force_peak_and_area_over_places_on_every_mesh() {
    let weighted = averaged(PressureBasis::Linear);
    let meshes = [("equilateral", 120.0, 0.0), ("square", 90.0, 0.0), ("jittered", 90.0, 0.25)];
    for (mesh, degrees, jitter) in meshes {
        let mut before = None;
        for (cells, places) in [(4, 24), (8, 8)] {
            let errors = |skin| hertz_errors(skin, cells, f64::to_radians(degrees), jitter, places);
            let (node, averaged) = (errors(&linear()), errors(&weighted));
            println!("{mesh}, {cells} cells: force, peak, area {averaged:.5?}, at vertices {node:.5?}");
            for (k, figure) in ["force", "peak", "area"].into_iter().enumerate() {
                assert!(averaged[k] < node[k], "{figure}, {mesh}, {cells} cells: {averaged:?} {node:?}");
            }
            // A rim of straight chords, and slopes taken as straight, cost its square of the cell over the radius.
            assert!(averaged[2] < 1.0 / (cells * cells) as f64, "{mesh}, {cells} cells: {averaged:?}");
            // Force and peak fall with the square of the cell at least, the rim's place with the cell; half as much
            // again for the scatter of few places.
            if let Some(coarse) = before.replace(averaged) {
                for (k, factor) in [0.375, 0.375, 0.75].into_iter().enumerate() {
                    assert!(averaged[k] < factor * coarse[k], "{mesh}: {coarse:?} to {averaged:?}");
                }
            }
        }
    }
}

#[test]
fn the_arrays_of_a_weighted_contact_agree_with_its_figures() {
    let weighted = averaged(PressureBasis::Linear);
    let (contact, hertz, approach) = hertz_contact_on(8, 0.25, 200.0, &weighted);
    let total: f64 = contact.node_force.iter().sum();
    assert_relative_eq!(contact.resultant.force.norm(), total, max_relative = 1e-4);
    let largest = contact.pressure.iter().copied().fold(0.0, f64::max);
    // The largest is between vertices: by no more than a cell's sag of the pressure, p0 h² / 2 a².
    assert!((0.0..0.5 / 64.0).contains(&(contact.resultant.max_pressure / largest - 1.0)));
    for (vertex, &pressure) in contact.pressure.iter().enumerate() {
        assert_eq!(pressure > 0.0, contact.node_force[vertex] > 0.0, "vertex {vertex}");
    }
    let of_patches: f64 = contact.patches.iter().map(|patch| patch.resultant.contact_area).sum();
    assert_relative_eq!(of_patches, contact.resultant.contact_area, max_relative = 1e-12);
    // Four cells from the rim the vertices' pressures are Hertz's; uncorrected, h² |Δp| / 12 would be 0.26 %, and the
    // jitter adds as much.
    let deformed =
        contact.drawn_skin(&weighted, &ContactOptions::default(), &|| false).expect("drawn").deformed;
    let center = deformed.vertices().iter().sum::<Vector3<f64>>() / contact.pressure.len() as f64;
    let radius = hertz.contact_radius(approach);
    for (vertex, position) in deformed.vertices().iter().enumerate() {
        let distance = (position - center).xy().norm();
        if distance < 0.5 * radius {
            let error = contact.pressure[vertex] - hertz.pressure(approach, distance);
            assert!(error.abs() < 5e-3 * hertz.max_pressure(approach), "vertex {vertex}: {error}");
        }
    }
}

/// The half-space in Galerkin form.
fn averaged(basis: PressureBasis) -> KernelSkin {
    half_space(basis).with_discretization(Discretization::Galerkin).expect("a half-space has it")
}

#[test]
fn no_contact_of_averaged_gaps_carries_its_force_above_its_largest_pressure() {
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
        let contact = solve(&surface, &obstacle, &averaged(PressureBasis::Linear));
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
fn the_figures_of_averaged_gaps_do_not_turn_with_the_scene() {
    let layer = KernelSkin::new(SHEAR_MODULUS, POISSON_RATIO, Kernel::Layer { thickness: 4e-3.into() });
    let layer = layer.and_then(|skin| skin.with_discretization(Discretization::Galerkin)).expect("valid");
    let (vertices, faces) = icosphere(8e-3, 3);
    let surface = Surface::new(vertices, faces).expect("a valid surface");
    let sphere = Obstacle::sphere(Vector3::new(0.3e-3, 0.2e-3, 37.2e-3), 30e-3).expect("a valid obstacle");
    let rotation = Rotation3::new(Vector3::new(0.4, 1.1, -0.7));
    let shift = Vector3::new(0.03, -0.02, 0.05);
    let turned_sphere = sphere.moved(rotation.matrix(), &shift).expect("a rigid motion");
    let moved = surface.with_vertices(surface.vertices().iter().map(|x| rotation * x + shift).collect());
    for skin in [averaged(PressureBasis::Linear), layer] {
        let straight = solve(&surface, &sphere, &skin).resultant;
        let turned = solve(&moved, &turned_sphere, &skin).resultant;
        assert_relative_eq!(turned.contact_area, straight.contact_area, max_relative = 1e-9);
        assert_relative_eq!(turned.max_pressure, straight.max_pressure, max_relative = 1e-9);
    }
}

#[test]
fn a_press_too_shallow_for_averaged_gaps_keeps_its_penetration_and_says_so() {
    let skin = averaged(PressureBasis::Linear);
    let contact = press_up(&ball(8e-3, 3), &plate(), &skin, 1e-5);
    assert_eq!(contact.status, ContactStatus::Solved);
    assert_eq!(contact.resultant.force, Vector3::zeros());
    assert_relative_eq!(contact.max_penetration_after, 1e-5, max_relative = 1e-9);
    assert!(contact.warnings[0].contains("refine the mesh"), "{:?}", contact.warnings);
}

#[test]
fn one_ring_pressures_oscillate_where_linear_ones_do_not() {
    let (linear, hertz, approach) = hertz_contact(8, PressureBasis::Linear);
    let peak_error = |contact: &Contact| {
        // Node force over vertex area is what the LCP itself finds, before any averaging.
        let surface = &contact.surface;
        let peak = contact.active.iter().map(|&v| contact.node_force[v] / surface.vertex_areas()[v]);
        peak.fold(0.0, f64::max) / hertz.max_pressure(approach) - 1.0
    };
    assert!(peak_error(&linear).abs() < 0.005);
    let (one_ring, ..) = hertz_contact(8, PressureBasis::OneRing);
    // The force is right all the same; the node pressures are not.
    assert_relative_eq!(one_ring.resultant.force.norm(), linear.resultant.force.norm(), max_relative = 0.02);
    assert!(peak_error(&one_ring) > 0.04, "{}", peak_error(&one_ring));
}

/// A ball of skin, its lowest point near the origin.
fn ball(radius: f64, subdivisions: usize) -> Surface {
    let (mut vertices, faces) = icosphere(radius, subdivisions);
    vertices.iter_mut().for_each(|vertex| vertex.z += radius);
    Surface::new(vertices, faces).expect("a valid surface")
}

fn plate() -> Obstacle {
    Obstacle::half_space(Vector3::zeros(), UP).expect("a valid obstacle")
}

#[test]
fn apart_means_no_contact_and_zeros() {
    let contact = solve(&ball(8e-3, 3), &plate().translated(&(-1e-3 * UP)), &linear());
    assert_eq!(contact.status, ContactStatus::NoContact);
    assert_eq!(contact.resultant.force, Vector3::zeros());
    assert_eq!(contact.resultant.contact_area, 0.0);
    assert!(contact.resultant.center_of_pressure.x.is_nan());
    assert!(contact.lcp_solutions.is_empty() && contact.candidates.is_empty());
    assert!(contact.node_force.iter().all(|&force| force == 0.0));
    let left_out: Vec<&str> = contact.left_out.iter().map(|entry| entry.what).collect();
    assert!(left_out.contains(&"response matrix") && left_out.contains(&"complementarity problem"));
    assert!(contact.timings.iter().all(|timing| timing.stage != "response" && timing.stage != "lcp"));
}

#[test]
fn a_solved_contact_is_complementary_and_free_of_penetration() {
    let depth = 0.5e-3;
    let contact = press_up(&ball(8e-3, 4), &plate(), &linear(), depth);
    assert_eq!(contact.status, ContactStatus::Solved);
    assert!(contact.accuracy.natural_residual <= 1e-10);
    for &vertex in &contact.candidates {
        assert!(contact.gap[vertex] >= -1e-9 * depth);
        assert!(contact.node_force[vertex] >= 0.0);
    }
    assert_relative_eq!(contact.max_penetration_before, depth, max_relative = 1e-9);
    // The obstacle is flat, so the linearised gaps are the true ones.
    assert!(contact.max_penetration_after <= 1e-9 * depth);
    let sum: f64 = contact.node_force.iter().sum();
    assert_relative_eq!(contact.resultant.force.z, sum, max_relative = 1e-12);
    assert_relative_eq!(contact.patches[0].resultant.force, contact.resultant.force, max_relative = 1e-12);
    let area: f64 = contact.active.iter().map(|&v| ball_area(&contact, v)).sum();
    assert!(area > 0.0);
}

fn ball_area(contact: &Contact, vertex: usize) -> f64 {
    if contact.node_force[vertex] > 0.0 { contact.node_force[vertex] / contact.pressure[vertex] } else { 0.0 }
}

#[test]
fn travel_counts_from_infinity_and_is_negative_for_a_start_in_overlap() {
    let surface = ball(8e-3, 3);
    let low = press_up(&surface, &plate().translated(&(-5e-3 * UP)), &linear(), 1e-4);
    let high = press_up(&surface, &plate().translated(&(5e-3 * UP)), &linear(), 1e-4);
    assert_relative_eq!(low.travel - high.travel, 10e-3, max_relative = 1e-9);
    assert!(high.travel < 0.0);
    assert_relative_eq!(low.resultant.force.z, high.resultant.force.z, max_relative = 1e-6);
}

#[test]
fn a_press_by_nothing_is_no_contact() {
    let contact = press_up(&ball(8e-3, 2), &plate(), &linear(), 0.0);
    assert_eq!(contact.status, ContactStatus::NoContact);
}

#[test]
fn force_does_not_depend_on_where_the_scene_lies_or_how_its_vertices_are_numbered() {
    let (depth, skin) = (0.6e-3, linear());
    let surface = ball(8e-3, 3);
    let rod = Obstacle::capsule(Vector3::new(-0.03, 0.0, -0.01), Vector3::new(0.03, 0.002, -0.01), 6e-3)
        .expect("a valid obstacle");
    let force = press_up(&surface, &rod, &skin, depth).resultant.force.norm();

    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let shift = Vector3::new(0.4, -0.2, 1.3);
    let moved = surface.moved(&Isometry3::from_parts(Translation3::from(shift), turn.into()));
    let obstacle = rod.moved(turn.matrix(), &shift).expect("a rigid motion");
    let press_along = Press { direction: turn * UP, depth, start: Start::Infinity };
    let turned = press(&moved, &obstacle, &skin, &press_along, &ContactOptions::default(), &go_on)
        .expect("a valid request");
    assert_relative_eq!(turned.resultant.force.norm(), force, max_relative = 1e-6);

    let count = surface.vertices().len();
    let renumber = |vertex: usize| (vertex * 7 + 3) % count;
    assert_eq!(count % 7, 5, "7 must be coprime to the number of vertices");
    let mut vertices = vec![Vector3::zeros(); count];
    surface.vertices().iter().enumerate().for_each(|(old, x)| vertices[renumber(old)] = *x);
    let faces = surface.faces().iter().map(|face| face.map(|v| renumber(v as usize) as u32)).collect();
    let renumbered = Surface::new(vertices, faces).expect("a valid surface");
    let again = press_up(&renumbered, &rod, &skin, depth).resultant.force.norm();
    assert_relative_eq!(again, force, max_relative = 1e-9);
}

#[test]
fn force_grows_with_the_square_of_the_scale() {
    let force = |scale: f64| {
        press_up(&ball(8e-3 * scale, 3), &plate(), &linear(), 0.5e-3 * scale).resultant.force.z
            / (scale * scale)
    };
    let reference = force(1.0);
    for scale in [1e-3, 0.37, 1e3] {
        assert_relative_eq!(force(scale), reference, max_relative = 1e-8);
    }
}

#[test]
fn force_is_proportional_to_the_shear_modulus() {
    let at = |modulus: f64| {
        let response = Kernel::HalfSpace;
        let skin = KernelSkin::new(modulus, POISSON_RATIO, response).expect("valid constants");
        press_up(&ball(8e-3, 3), &plate(), &skin, 0.5e-3).resultant.force.z
    };
    assert_relative_eq!(at(6e9), 1e5 * at(6e4), max_relative = 1e-9);
}

#[test]
fn masked_vertices_stay_out_of_contact() {
    let surface = ball(8e-3, 3);
    let mask: Vec<bool> = surface.vertices().iter().map(|x| x.z > 0.2e-3).collect();
    let masked = surface.clone().with_skin_mask(mask.clone()).expect("a mask of the surface");
    let contact = press_up(&masked, &plate(), &linear(), 0.3e-3);
    assert!(contact.candidates.iter().all(|&vertex| mask[vertex]));
    assert!(contact.travel > press_up(&surface, &plate(), &linear(), 0.3e-3).travel);
}

fn paper_skin() -> KernelSkin {
    let response = Kernel::GaussianCorrected { height: 0.8e-3, width: 5e-3, cutoff: 15e-3 };
    KernelSkin::new(SHEAR_MODULUS, POISSON_RATIO, response).expect("valid constants")
}

#[test]
fn the_paper_s_constants_solve_shallow_presses_and_end_on_a_ray_in_deep_ones() {
    // A ball of the fingertip's radius, edges of about 1.1 mm.
    let surface = ball(8e-3, 3);
    let shallow = press_up(&surface, &plate(), &paper_skin(), 0.15e-3);
    assert_eq!(shallow.status, ContactStatus::Solved);
    assert!(shallow.candidates.len() > shallow.active.len(), "rings are added");

    let deep = press_up(&surface, &plate(), &paper_skin(), 1.5e-3);
    assert_eq!(deep.status, ContactStatus::Failed(LcpStatus::Ray));
    assert!(!deep.advice().is_empty());
    assert!(deep.resultant.force.z.is_nan(), "no figure may pass for an answer");
    let drawn =
        deep.drawn_skin(&paper_skin(), &ContactOptions::default(), &|| false).expect("nothing to draw");
    assert!(drawn.displacement.iter().all(|u| *u == Vector3::zeros()));
}

#[test]
fn bad_questions_are_named() {
    let (surface, skin, options) = (ball(8e-3, 2), linear(), ContactOptions::default());
    let ask = |direction, depth, start| {
        press(&surface, &plate(), &skin, &Press { direction, depth, start }, &options, &go_on)
    };
    let zero = ask(Vector3::zeros(), 1e-3, Start::Infinity).unwrap_err();
    assert_eq!(zero, ContactError::Direction { direction: [0.0; 3] });
    let negative = ask(UP, -1e-3, Start::Infinity).unwrap_err();
    assert_eq!(negative, ContactError::Depth { depth: -1e-3 });
    assert!(matches!(ask(UP, f64::NAN, Start::Infinity), Err(ContactError::Depth { .. })));

    let overlapping = plate().translated(&(1e-3 * UP));
    let from_here = Press { direction: UP, depth: 1e-3, start: Start::Current };
    match press(&surface, &overlapping, &skin, &from_here, &options, &go_on).unwrap_err() {
        ContactError::StartsPenetrating { penetration, count, .. } => {
            assert_relative_eq!(penetration, 1e-3, max_relative = 0.2);
            assert!(count > 0);
        }
        other => panic!("{other}"),
    }

    let beside = Obstacle::sphere(Vector3::new(0.1, 0.0, 0.0), 1e-3).expect("a valid obstacle");
    let up = Press { direction: UP, depth: 1e-3, start: Start::Infinity };
    let missed = press(&surface, &beside, &skin, &up, &options, &go_on).unwrap_err();
    assert!(matches!(missed, ContactError::NeverTouches { .. }));

    let masked =
        surface.clone().with_skin_mask(vec![false; surface.vertices().len()]).expect("a mask of the surface");
    let none = press(&masked, &plate(), &skin, &up, &options, &go_on).unwrap_err();
    assert_eq!(none, ContactError::NoSkin { vertex_count: surface.vertices().len() });

    let options = ContactOptions { tolerance: -1.0, ..ContactOptions::default() };
    let refused = press(&surface, &plate(), &skin, &up, &options, &go_on).unwrap_err();
    assert!(matches!(refused, ContactError::Option { option: "tolerance", .. }));
}

#[test]
fn an_obstacle_in_another_unit_is_warned_about() {
    let (vertices, faces) = icosphere(8.0, 2);
    let huge = Obstacle::mesh(vertices, faces, &Default::default()).expect("a valid obstacle");
    let contact = solve(&ball(8e-3, 2), &huge.translated(&Vector3::new(0.0, 0.0, -9.0)), &linear());
    assert!(contact.warnings[0].contains("unit"), "{:?}", contact.warnings);
}

#[test]
fn threads_change_nothing() {
    let with = |num_threads| {
        let options = ContactOptions { num_threads: Some(num_threads), ..ContactOptions::default() };
        let up = Press { direction: UP, depth: 0.5e-3, start: Start::Infinity };
        press(&ball(8e-3, 3), &plate(), &linear(), &up, &options, &go_on).expect("a valid request")
    };
    let (one, two) = (with(1), with(2));
    assert_eq!(one.node_force, two.node_force);
    let drawn = |contact: &Contact| {
        let drawn = contact.drawn_skin(&linear(), &ContactOptions::default(), &|| false);
        drawn.expect("not interrupted").displacement
    };
    assert_eq!(drawn(&one), drawn(&two));
}
