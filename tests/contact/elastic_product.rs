//! A product that gives way: shares of the approach, where skin and product meet, matrices of a product's mesh.

use approx::assert_relative_eq;
use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use quasirigid::contact::{Contact, ContactOptions, ContactStatus, Goal, Warning, press, solve_contact};
use quasirigid::obstacle::{MeshObstacleOptions, Obstacle, ProductResponse};
use quasirigid::response::{
    AssemblyOptions, Discretization, GivenMatrix, Kernel, KernelSkin, NodesError, PressureBasis,
    ResponseError, Thickness, assemble,
};
use quasirigid::surface::Surface;

use crate::common::{flipped, icosphere, one_diagonal_grid};
use crate::{
    POISSON_RATIO, SHEAR_MODULUS, UP, ball, galerkin, half_space, plate, press_up, pressed, skin, solve,
    upwards,
};

/// A sphere R = 200 mm 0.5 mm deep in a flat skin, 8 cells per contact radius of 10 mm.
fn sphere_on_flat_skin() -> (Surface, Obstacle) {
    let (mut vertices, faces) = one_diagonal_grid(24);
    vertices.iter_mut().for_each(|vertex| *vertex = 1.25e-3 * (*vertex - Vector3::new(12.0, 12.0, 0.0)));
    let surface = Surface::new(vertices, faces).expect("a valid surface");
    let sphere = Obstacle::sphere(Vector3::new(0.0, 0.0, 0.2 - 0.5e-3), 0.2).expect("a valid obstacle");
    (surface, sphere)
}

fn made_of(obstacle: &Obstacle, shear_modulus: f64, poisson_ratio: f64) -> Obstacle {
    let half_space = ProductResponse::Kernel(Kernel::HalfSpace);
    obstacle.with_material(shear_modulus, poisson_ratio, half_space).expect("valid constants")
}

fn force(contact: &Contact) -> f64 {
    assert_eq!(contact.status, ContactStatus::Solved);
    contact.resultant.force.norm()
}

/// Displacement of the skin at the candidates, by drawing it.
fn skin_displacement(contact: &Contact, skin: &KernelSkin) -> Vec<Vector3<f64>> {
    contact.drawn_skin(skin, &ContactOptions::on_given_mesh()).expect("not interrupted").displacement
}

#[test]
fn the_force_falls_to_the_share_of_the_softness_that_is_the_skins() {
    let (surface, sphere) = sphere_on_flat_skin();
    for skin in [half_space(), galerkin(), half_space().with_basis(PressureBasis::OneRing)] {
        let rigid = solve(&surface, &sphere, &skin);
        assert_eq!(rigid.obstacle_share, Some(0.0));
        for (ratio, expected) in [(4.0, 0.8), (1.0, 0.5), (0.25, 0.2)] {
            let product = made_of(&sphere, ratio * SHEAR_MODULUS, POISSON_RATIO);
            let elastic = solve(&surface, &product, &skin);
            // Both matrices are multiples of one, so the forces are too, up to rounding.
            assert_relative_eq!(force(&elastic) / force(&rigid), expected, max_relative = 1e-9);
            let share = elastic.obstacle_share.expect("in contact");
            assert_relative_eq!(share, 1.0 - expected, max_relative = 1e-9);
            assert_relative_eq!(
                elastic.resultant.contact_area,
                rigid.resultant.contact_area,
                max_relative = 1e-9
            );
        }
    }
}

#[test]
fn poissons_ratios_enter_by_the_sum_of_both_softnesses() {
    let (surface, sphere) = sphere_on_flat_skin();
    let rigid = force(&solve(&surface, &sphere, &half_space()));
    let softness = (1.0 - POISSON_RATIO) / SHEAR_MODULUS;
    for (shear_modulus, poisson_ratio) in [(30e3, 0.3), (120e3, 0.0)] {
        let both = softness + (1.0 - poisson_ratio) / shear_modulus;
        let elastic = solve(&surface, &made_of(&sphere, shear_modulus, poisson_ratio), &half_space());
        assert_relative_eq!(force(&elastic), rigid * softness / both, max_relative = 1e-9);
    }
}

#[test]
fn skin_and_product_meet_where_both_have_moved() {
    let (surface, sphere) = sphere_on_flat_skin();
    for skin in [half_space(), galerkin()] {
        let rigid = solve(&surface, &sphere, &skin);
        for ratio in [4.0, 0.25] {
            let contact = solve(&surface, &made_of(&sphere, ratio * SHEAR_MODULUS, POISSON_RATIO), &skin);
            let (of_skin, of_product) = (skin_displacement(&contact, &skin), contact.obstacle_displacement());
            let depth = contact.max_penetration_before;
            // The product's own points that the skin touches: back by the product's displacement.
            let touched: Vec<Vector3<f64>> = contact
                .active
                .iter()
                .map(|&vertex| surface.vertices()[vertex] + of_skin[vertex] - of_product[vertex])
                .collect();
            let left = sphere.signed_distance(&touched, None).expect("finite points").distance;
            let allowed = match skin.discretization() {
                Discretization::Collocation => 1e-3,
                // Gaps are averaged over cells of an eighth of the radius.
                Discretization::Galerkin => 1.0 / 64.0,
            };
            assert!(left.iter().all(|gap| gap.abs() < allowed * depth), "{left:?}");
            assert_relative_eq!(
                contact.max_penetration_after,
                rigid.max_penetration_after,
                max_relative = 0.05
            );
            // Up on the product, down on the skin, in the ratio of the moduli.
            for &vertex in &contact.active {
                assert_relative_eq!(of_product[vertex].z, -of_skin[vertex].z / ratio, max_relative = 1e-2);
                assert!(of_skin[vertex].z < 0.0);
            }
            let off = (0..surface.vertices().len()).filter(|v| contact.candidates.binary_search(v).is_err());
            off.for_each(|vertex| assert_eq!(of_product[vertex], Vector3::zeros()));
        }
    }
}

/// Largest distance of the deformed skin under force from the moved mesh of a ball, over the depth.
fn apart_from_moved_ball(subdivisions: usize) -> f64 {
    let (surface, _) = sphere_on_flat_skin();
    let (vertices, faces) = icosphere(0.2, subdivisions);
    let unchecked = MeshObstacleOptions { check_crossings: false };
    let at = Vector3::new(0.0, 0.0, 0.2 - 0.5e-3);
    let mesh = Obstacle::mesh(vertices, faces, &unchecked).expect("a ball").translated(&at);
    let contact = solve(&surface, &made_of(&mesh, SHEAR_MODULUS, POISSON_RATIO), &half_space());
    let options = ContactOptions::on_given_mesh();
    let moved = contact.deformed_obstacle(&options).expect("not interrupted").expect("a mesh");
    let deformed = contact.drawn_skin(&half_space(), &options).expect("not interrupted").deformed;
    let moved =
        Obstacle::mesh(moved.vertices().to_vec(), moved.faces().to_vec(), &unchecked).expect("dented");
    let at_active: Vec<Vector3<f64>> = contact.active.iter().map(|&v| deformed.vertices()[v]).collect();
    let left = moved.signed_distance(&at_active, None).expect("finite points").distance;
    left.iter().map(|gap| gap.abs()).fold(0.0, f64::max) / contact.max_penetration_before
}

#[test]
fn the_moved_mesh_of_a_product_comes_to_lie_on_the_deformed_skin_however_coarse_it_is() {
    for subdivisions in [3, 4, 5] {
        // Straight edges of 1.25 mm cut across the kinks between the ball's faces, an icosahedron's edges halved again and
        // again: by a quarter of their length times the angle, half of which is the product's.
        let angle = 2.0_f64.atan() / f64::from(1 << subdivisions);
        let cut = angle * 1.25e-3 / 8.0 / 0.5e-3;
        let left = apart_from_moved_ball(subdivisions);
        assert!(left < cut, "{subdivisions}: {left}, {cut}");
    }
}

#[test]
fn a_product_of_the_same_layer_halves_the_force_too() {
    let (surface, sphere) = sphere_on_flat_skin();
    let layer = Kernel::Layer { thickness: Thickness::Uniform(6e-3) };
    for skin in
        [skin(layer.clone()), skin(layer.clone()).with_discretization(Discretization::Galerkin).unwrap()]
    {
        let rigid = solve(&surface, &sphere, &skin);
        let response = ProductResponse::Kernel(layer.clone());
        let product = sphere.with_material(SHEAR_MODULUS, POISSON_RATIO, response).expect("valid constants");
        let elastic = solve(&surface, &product, &skin);
        assert_relative_eq!(force(&elastic) / force(&rigid), 0.5, max_relative = 1e-9);
        assert_relative_eq!(elastic.obstacle_share.expect("in contact"), 0.5, max_relative = 1e-9);
    }
    // A layer on a half-space: the matrix may have negative entries, and no group of nodes is out of its reach.
    let response = ProductResponse::Kernel(layer.clone());
    let product = sphere.with_material(SHEAR_MODULUS, POISSON_RATIO, response).expect("valid constants");
    let rigid = force(&solve(&surface, &sphere, &half_space()));
    let found = force(&solve(&surface, &product, &half_space()));
    // The layer is stiffer than the half-space.
    assert!(found > 0.5 * rigid && found < rigid, "{found} of {rigid}");
}

#[test]
fn a_refined_contact_and_a_press_to_a_force_give_way_alike() {
    let surface = ball(8e-3, 3);
    let options = ContactOptions::default();
    let pressed = |obstacle: &Obstacle, goal| pressed(&surface, obstacle, &half_space(), goal, &options);
    let soft = made_of(&plate(), SHEAR_MODULUS, POISSON_RATIO);
    let (rigid, elastic) = (pressed(&plate(), Goal::Depth(5e-4)), pressed(&soft, Goal::Depth(5e-4)));
    assert!(elastic.refinements.len() > 1 && elastic.accuracy.mesh_error.expect("estimated") <= 0.02);
    assert_relative_eq!(force(&elastic) / force(&rigid), 0.5, max_relative = 1e-9);
    assert_relative_eq!(elastic.obstacle_share.expect("in contact"), 0.5, max_relative = 1e-9);
    assert!(elastic.left_out.iter().all(|one| one.what != "product response"));
    assert!(rigid.left_out.iter().any(|one| one.what == "product response"));
    // Twice the force of a rigid product at the same depth.
    let back = pressed(&soft, Goal::Force(force(&elastic)));
    assert_relative_eq!(back.depth.expect("a press"), 5e-4, max_relative = 5e-3);
    let drawn = elastic.drawn_skin(&half_space(), &options).expect("not interrupted");
    let product = elastic.obstacle_displacement();
    assert_eq!(product.len(), elastic.surface().vertices().len());
    for &vertex in &elastic.active {
        // Each gives way by half: the plate is level where it was, half the depth above the skin's rest.
        let level = drawn.deformed.vertices()[vertex].z - product[vertex].z;
        assert_relative_eq!(level, elastic.travel, epsilon = 1e-3 * 5e-4);
    }
}

/// A slab under the origin, `cells`² squares of 1 mm on its top, 10 mm thick; the vertices of the top come first.
fn slab(cells: usize) -> Obstacle {
    let (top, up) = one_diagonal_grid(cells);
    let count = top.len() as u32;
    let middle = Vector3::new(0.5 * cells as f64, 0.5 * cells as f64, 0.0);
    let mut vertices: Vec<Vector3<f64>> = top.iter().map(|vertex| 1e-3 * (vertex - middle)).collect();
    vertices.extend(top.iter().map(|vertex| 1e-3 * (vertex - middle) - 10e-3 * UP));
    let mut faces = up.clone();
    faces.extend(up.iter().map(|[a, b, c]| [a + count, c + count, b + count]));
    // Sides, from the edges of the top that one triangle has.
    let edges: Vec<[u32; 2]> = up.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    for &[a, b] in edges.iter().filter(|[a, b]| !edges.contains(&[*b, *a])) {
        faces.extend([[b, a, a + count], [b, a + count, b + count]]);
    }
    Obstacle::mesh(vertices, faces, &Default::default()).expect("a closed mesh")
}

fn with_matrix(obstacle: &Obstacle, nodes: Vec<usize>, matrix: Mat<f64>) -> Result<Obstacle, ResponseError> {
    obstacle.with_material(1e5, 0.3, ProductResponse::Matrix { nodes, matrix })
}

#[test]
fn a_product_on_a_spring_takes_its_travel_off_the_depth() {
    // All of it moves by the same c F, whatever triangles are pressed.
    let (softness, slab) = (2e-4, slab(12));
    let nodes: Vec<usize> = (0..169).collect();
    let on_spring = with_matrix(&slab, nodes, Mat::from_fn(169, 169, |_, _| softness)).expect("a matrix");
    let surface = ball(8e-3, 4);
    let depth = 1e-3;
    let elastic = press_up(&surface, &on_spring, &half_space(), depth);
    let sunk = softness * force(&elastic);
    assert!(sunk > 0.1 * depth && sunk < 0.9 * depth, "{sunk}");
    let rigid = press_up(&surface, &slab, &half_space(), depth - sunk);
    // Gaps of either may be left of 1e-3 of the depth.
    assert_relative_eq!(force(&elastic), force(&rigid), max_relative = 5e-3);
    for &vertex in &elastic.active {
        assert_relative_eq!(elastic.obstacle_displacement()[vertex].z, -sunk, max_relative = 1e-9);
    }
    let moved = elastic.deformed_obstacle(&ContactOptions::on_given_mesh()).expect("done").expect("a mesh");
    let (before, _) = elastic.obstacle.triangles().expect("a mesh");
    // A vertex amid the top, where the normal is that of the top.
    let inner = 6 * 13 + 6;
    assert_relative_eq!(moved.vertices()[inner].z - before[inner].z, -sunk, max_relative = 1e-9);
    assert_eq!(moved.vertices()[200], before[200]);
    // Its matrix is linear, so that nothing is lost between the vertices.
    assert!(elastic.accuracy.body_error.expect("an estimate") < 1e-12);
}

#[test]
fn a_given_matrix_of_a_half_space_answers_as_its_kernel() {
    // Every vertex of a bowed skin lies over one of the slab.
    let slab = slab(16);
    let (grid, faces) = one_diagonal_grid(16);
    let top: Vec<Vector3<f64>> = grid.iter().map(|at| 1e-3 * (at - Vector3::new(8.0, 8.0, 0.0))).collect();
    let bowed = top.iter().map(|at| at + at.norm_squared() / (2.0 * 60e-3) * UP).collect();
    let surface = Surface::new(bowed, flipped(&faces)).expect("a valid surface");
    let top = Surface::new(top, faces).expect("a valid surface");
    let nodes: Vec<usize> = (0..17 * 17).collect();
    let matrix = assemble(&top, &half_space(), &nodes, &AssemblyOptions::default()).expect("a matrix");
    let given = with_matrix(&slab, nodes, matrix).expect("a matrix");
    let kernel = made_of(&slab, SHEAR_MODULUS, POISSON_RATIO);
    let [found, expected] =
        [given, kernel].map(|obstacle| press_up(&surface, &obstacle, &half_space(), 3e-4));
    // The skin is bowed by 0.3 mm over 6 mm, so its distances are some (0.3 / 6)² longer than the slab's.
    assert_relative_eq!(force(&found), force(&expected), max_relative = 2.5e-3);
    assert_relative_eq!(found.obstacle_share.expect("in contact"), 0.5, max_relative = 2.5e-3);
}

#[test]
fn what_is_lost_between_the_vertices_of_a_products_matrix_is_said() {
    let surface = ball(8e-3, 4);
    let pressed = |obstacle: Obstacle, options: &ContactOptions| {
        pressed(&surface, &obstacle, &half_space(), Goal::Depth(0.6e-3), options)
    };
    for softer in [0.5, 3.0, 100.0] {
        let material = KernelSkin::new(SHEAR_MODULUS / softer, POISSON_RATIO, Kernel::HalfSpace)
            .expect("valid constants");
        let slab = slab(16);
        let (grid, faces) = one_diagonal_grid(16);
        let top = Surface::new(grid.iter().map(|at| 1e-3 * at).collect(), faces).expect("a valid surface");
        let nodes: Vec<usize> = (0..17 * 17).collect();
        let matrix = assemble(&top, &material, &nodes, &AssemblyOptions::default()).expect("a matrix");
        let kernel =
            pressed(made_of(&slab, SHEAR_MODULUS / softer, POISSON_RATIO), &ContactOptions::default());
        assert_eq!(kernel.accuracy.body_error, Some(0.0));
        // The skin's triangles are finer than the slab's already, and none are made finer still.
        for options in [ContactOptions::on_given_mesh(), ContactOptions::default()] {
            let given =
                pressed(with_matrix(&slab, nodes.clone(), matrix.clone()).expect("a matrix"), &options);
            assert_eq!(given.surface().vertices().len(), surface.vertices().len());
            let off = |figure: fn(&Contact) -> f64| (figure(&kernel) / figure(&given) - 1.0).abs();
            let [of_force, of_area, of_peak] = [
                (off(force), given.accuracy.force_error),
                (off(|contact| contact.resultant.contact_area), given.accuracy.area_error),
                (off(|contact| contact.resultant.max_pressure), given.accuracy.max_pressure_error),
            ]
            .map(|(found, said)| (found, said.expect("an estimate")));
            for (figure, (found, said)) in [("force", of_force), ("area", of_area), ("peak", of_peak)] {
                assert!(found < said, "{figure}, {softer} times as soft: {found} of {said}");
            }
            let is_said = |warning: &Warning| warning.message.contains("product's matrix is given on");
            assert_eq!(given.warnings.iter().any(is_said), options.target_error.is_some());
        }
    }
}

#[test]
fn a_given_matrix_of_the_skin_meets_an_elastic_product() {
    let (surface, sphere) = sphere_on_flat_skin();
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    let matrix = assemble(&surface, &half_space(), &nodes, &AssemblyOptions::default()).expect("a matrix");
    let given = GivenMatrix::new(&surface, &nodes, matrix).expect("a matrix");
    let product = made_of(&sphere, SHEAR_MODULUS, POISSON_RATIO);
    let options = ContactOptions::on_given_mesh();
    let contact = solve_contact(&surface, &product, &given, &options).expect("a valid request");
    assert_relative_eq!(
        force(&contact),
        force(&solve(&surface, &product, &half_space())),
        max_relative = 1e-9
    );
}

#[test]
fn a_copy_that_is_moved_keeps_its_material() {
    let sphere = made_of(&Obstacle::sphere(Vector3::zeros(), 0.1).expect("a sphere"), 1e5, 0.3);
    let turned = sphere.moved(&Matrix3::identity(), &UP).expect("a rotation").translated(&UP);
    let material = turned.material().expect("kept");
    assert_eq!((material.shear_modulus(), material.poisson_ratio()), (1e5, 0.3));
    assert_eq!(material.kernel().expect("a kernel").kernel(), &Kernel::HalfSpace);
    assert!(Obstacle::sphere(UP, 0.1).expect("a sphere").material().is_none());
}

#[test]
fn without_contact_the_product_has_no_share_and_stays() {
    let slab = made_of(&slab(4), 1e5, 0.3);
    let contact = solve(&ball(8e-3, 2), &slab.translated(&(-0.1 * UP)), &half_space());
    assert_eq!((contact.status, contact.obstacle_share), (ContactStatus::NoContact, None));
    assert!(contact.obstacle_displacement().iter().all(|moved| *moved == Vector3::zeros()));
    let moved = contact.deformed_obstacle(&ContactOptions::on_given_mesh()).expect("done").expect("a mesh");
    assert_eq!(moved.vertices(), contact.obstacle.triangles().expect("a mesh").0);
}

#[test]
fn a_contact_too_shallow_to_carry_force_has_no_share() {
    for obstacle in [plate(), made_of(&plate(), 1e5, 0.3)] {
        let contact = press_up(&ball(8e-3, 3), &obstacle, &galerkin(), 1e-5);
        assert_eq!((contact.status, contact.resultant.force), (ContactStatus::Solved, Vector3::zeros()));
        assert_eq!(contact.obstacle_share, None);
    }
}

#[test]
fn what_no_product_can_be_made_of_is_refused_by_name() {
    let plate = plate();
    let half_space_of = |shear_modulus, poisson_ratio| {
        plate
            .with_material(shear_modulus, poisson_ratio, ProductResponse::Kernel(Kernel::HalfSpace))
            .map(|_| ())
    };
    for (shear_modulus, poisson_ratio, name) in [
        (0.0, 0.3, "shear_modulus"),
        (-1.0, 0.3, "shear_modulus"),
        (f64::NAN, 0.3, "shear_modulus"),
        (1e5, 0.6, "poisson_ratio"),
        (1e5, f64::NAN, "poisson_ratio"),
    ] {
        let error = half_space_of(shear_modulus, poisson_ratio).expect_err(name);
        let of_skin = KernelSkin::new(shear_modulus, poisson_ratio, Kernel::HalfSpace).expect_err(name);
        assert_eq!(error.to_string(), of_skin.to_string());
    }
    let list = Thickness::PerVertex(vec![1e-3; 8].into());
    let layer = ProductResponse::Kernel(Kernel::Layer { thickness: list });
    let error = plate.with_material(1e5, 0.3, layer).map(|_| ()).expect_err("one thickness");
    assert!(error.to_string().contains("one thickness everywhere"), "{error}");
    let error = with_matrix(&plate, vec![0], Mat::identity(1, 1)).map(|_| ()).expect_err("no vertices");
    assert!(error.to_string().contains("a primitive has none"), "{error}");
    let error =
        with_matrix(&slab(2), vec![0, 99], Mat::identity(2, 2)).map(|_| ()).expect_err("no vertex 99");
    assert_eq!(error, NodesError::OutOfRange { index: 1, vertex: 99, vertex_count: 18 }.into());
    let error = with_matrix(&slab(2), vec![0, 1], Mat::identity(3, 3)).map(|_| ()).expect_err("3 x 3");
    assert_eq!(error, ResponseError::MatrixShape { rows: 3, columns: 3, nodes: 2 });
}

#[test]
fn a_contact_beside_what_a_products_matrix_knows_names_the_vertices() {
    // The matrix ends before the middle of the slab.
    let slab = with_matrix(&slab(12), vec![0, 1, 2], Mat::identity(3, 3)).expect("a matrix");
    let options = ContactOptions::on_given_mesh();
    let surface = ball(8e-3, 3);
    let solved = |skin: &KernelSkin| {
        press(&surface, &slab, skin, &upwards(Goal::Depth(1e-3)), &options).expect_err("unknown there")
    };
    let error = solved(&half_space()).to_string();
    assert!(error.contains("none of the 3 nodes of the product's matrix"), "{error}");
    let error = solved(&galerkin()).to_string();
    assert!(error.contains("discretization=\"collocation\""), "{error}");
}
