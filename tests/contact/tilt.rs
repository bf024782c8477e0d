//! Presses whose obstacle turns to its balance.

use nalgebra::Vector3;
use quasirigid::contact::{
    Balance, Contact, ContactError, ContactOptions, Goal, Press, Start, Tilt, TiltAxes, press,
};
use quasirigid::obstacle::Obstacle;
use quasirigid::surface::Surface;

use crate::common::{galerkin, icosphere};
use crate::{UP, ball, half_space, plate};

/// Distance of the balls from the origin (m).
const ARM: f64 = 0.03;

/// Two balls of 8 mm on the x axis, the second one higher (m).
fn two_balls(higher: f64) -> Surface {
    balls(&[Vector3::new(-ARM, 0.0, 0.0), Vector3::new(ARM, 0.0, higher)])
}

/// Balls of 8 mm that stand on some places.
fn balls(places: &[Vector3<f64>]) -> Surface {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for place in places {
        let (own, own_faces) = icosphere(8e-3, 3);
        let first = vertices.len() as u32;
        faces.extend(own_faces.iter().map(|face| face.map(|corner| corner + first)));
        vertices.extend(own.iter().map(|vertex| vertex + place + Vector3::new(0.0, 0.0, 8e-3)));
    }
    Surface::new(vertices, faces).expect("a valid surface")
}

fn tilted(surface: &Surface, goal: Goal, tilt: Tilt) -> Result<Contact, ContactError> {
    turned(surface, &plate(), goal, tilt)
}

fn turned(surface: &Surface, obstacle: &Obstacle, goal: Goal, tilt: Tilt) -> Result<Contact, ContactError> {
    let upwards = Press { direction: UP, goal, start: Start::Infinity, balance: Balance::Tilt(tilt) };
    press(surface, obstacle, &half_space(), &upwards, &ContactOptions::on_given_mesh())
}

/// The depth counts from where the lower ball is touched, which the plate turns away from.
#[test]
fn a_depth_counts_from_the_first_touch_though_that_skin_is_left() {
    let surface = two_balls(4e-4);
    let balance = Balance::Tilt(about(ARM + 1e-3));
    for goal in [Goal::Depth(1e-3), Goal::Force(0.5)] {
        let upwards = Press { direction: UP, goal, start: Start::Infinity, balance };
        let options = ContactOptions::default();
        let contact = press(&surface, &plate(), &half_space(), &upwards, &options).expect("a balance");
        assert_eq!(contact.patches.len(), 1);
        assert!(contact.patches[0].resultant.center_of_pressure.x > 0.0);
        let touch = contact.travel - contact.depth.expect("a press");
        assert!(touch.abs() < 1e-6, "{touch}");
    }
}

/// About y through a point on the x axis.
fn about(x: f64) -> Tilt {
    Tilt { point: Vector3::new(x, 0.0, 0.0), axes: TiltAxes::One(Vector3::y()) }
}

/// Moment about y through the point where it stands (N m), and force times lever.
fn moment(contact: &Contact, x: f64) -> (f64, f64) {
    let point = Vector3::new(x, 0.0, contact.travel);
    let left = contact.resultant.moment - point.cross(&contact.resultant.force);
    let distance = |&vertex: &usize| (contact.surface().vertices()[vertex] - point).norm();
    let lever = contact.active.iter().map(distance).fold(0.0, f64::max);
    (left.y, contact.resultant.force.norm() * lever)
}

#[test]
fn a_seesaw_shares_a_force_by_its_arms() {
    // From the point the balls are 2/3 and 4/3 of ARM away.
    let x = -ARM / 3.0;
    let contact = tilted(&two_balls(2e-3), Goal::Force(3.0), about(x)).expect("a balance");
    let (left, scale) = moment(&contact, x);
    assert!(left.abs() < 1e-6 * scale, "{left} of {scale}");
    assert!((contact.resultant.force.z / 3.0 - 1.0).abs() < 1e-6);
    let loads: Vec<f64> = contact.patches.iter().map(|patch| patch.resultant.force.z).collect();
    // The contacts slide on the balls and the plate sinks by some 2 mm of 60 in turning.
    assert!((loads[0] / loads[1] - 2.0).abs() < 0.2, "{loads:?}");
}

/// A sheet that skin comes through turns off one ball until two others carry their parts, and presses as it does as it lies.
#[test]
fn a_sheet_thinner_than_the_depth_turns_until_three_balls_carry_it() {
    let surface = balls(&[
        Vector3::new(-0.07, -0.05, 0.0),
        Vector3::new(0.06, -0.01, 0.02),
        Vector3::new(-0.01, 0.06, 0.02),
    ]);
    let sheet = Obstacle::cuboid(Vector3::new(0.08, 0.08, 2e-3)).expect("a sheet");
    let options = ContactOptions::on_given_mesh();
    for start in [Start::Infinity, Start::Current] {
        let below = if start == Start::Current { -4e-3 } else { 0.0 };
        let tilt = Tilt { point: Vector3::new(0.0, 0.0, below), axes: TiltAxes::Across };
        let tilting = Press { direction: UP, goal: Goal::Force(10.0), start, balance: Balance::Tilt(tilt) };
        let placed = sheet.translated(&(below * UP));
        let on_three = press(&surface, &placed, &half_space(), &tilting, &options).expect("a balance");
        assert_eq!(on_three.patches.len(), 3);
        let upright = Press { start: Start::Infinity, balance: Balance::None, ..tilting };
        let as_it_lies = on_three.obstacle.translated(&(-0.1 * UP));
        let again = press(&surface, &as_it_lies, &half_space(), &upright, &options).expect("the force");
        let moments = [again, on_three].map(|contact| contact.resultant.moment);
        assert!((moments[0] - moments[1]).norm() < 1e-6 * 10.0 * 0.1, "{moments:?}");
    }
}

#[test]
fn where_along_its_axis_the_point_lies_is_of_no_account() {
    let surface = two_balls(4e-4);
    let angle = |y: f64| {
        let tilt = Tilt { point: Vector3::new(0.0, y, 0.0), axes: TiltAxes::One(Vector3::y()) };
        let contact = tilted(&surface, Goal::Force(0.5), tilt).expect("a balance");
        contact.obstacle.pose().rotation.angle()
    };
    let at_balls = angle(0.0);
    assert!(at_balls > 5e-3);
    for y in [1.0, 1e3] {
        assert!((angle(y) / at_balls - 1.0).abs() < 1e-4, "{y}");
    }
}

#[test]
fn a_point_beside_both_balls_leaves_its_moment() {
    let x = 3.0 * ARM;
    match tilted(&two_balls(0.0), Goal::Depth(1e-3), about(x)) {
        Err(ContactError::NotBalanced { moment: told, force, asked: None, contact, .. }) => {
            let (left, scale) = moment(&contact.0, x);
            assert!((told / left.abs() - 1.0).abs() < 1e-12);
            assert_eq!(force, contact.0.resultant.force.z.abs());
            assert!(told > 1e-2 * scale);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_force_that_finds_no_balance_is_told_and_no_depth_advised() {
    let error = tilted(&two_balls(0.0), Goal::Force(0.25), about(3.0 * ARM)).expect_err("no balance");
    assert!(matches!(error, ContactError::NotBalanced { asked: Some(0.25), .. }), "{error:?}");
    let told = error.to_string();
    assert!(told.contains("where 0.25 N is asked for") && !told.contains("deeper"), "{told}");
}

/// Averaged gaps of triangles as large as the contact are open where one vertex is inside.
#[test]
fn a_mesh_too_coarse_to_carry_force_is_refined_before_the_obstacle_turns() {
    let surface = ball(8e-3, 2);
    let (vertices, faces) = icosphere(20e-3, 3);
    let below = vertices.iter().map(|vertex| vertex - Vector3::new(0.0, 0.0, 20e-3)).collect();
    let product = Obstacle::mesh(below, faces, &Default::default()).expect("a closed mesh");
    let tilt = Tilt { point: Vector3::new(1e-4, 0.0, 0.0), axes: TiltAxes::One(Vector3::y()) };
    let push = |goal, balance, options: &ContactOptions| {
        let upwards = Press { direction: UP, goal, start: Start::Infinity, balance };
        press(&surface, &product, &galerkin(), &upwards, options)
    };
    let given = ContactOptions::on_given_mesh();
    let upright = push(Goal::Depth(1e-4), Balance::None, &given).expect("a contact");
    assert!(upright.resultant.force.norm() == 0.0 && upright.max_penetration_before > 0.0);
    let error = push(Goal::Depth(1e-4), Balance::Tilt(tilt), &given).expect_err("nothing to balance");
    assert!(error.to_string().contains("as the mesh is coarser than the contact"), "{error}");

    // On the given mesh the force jumps from nothing to more than that.
    for goal in [Goal::Depth(1e-4), Goal::Force(1e-3)] {
        let settled = push(goal, Balance::Tilt(tilt), &ContactOptions::default());
        let settled = settled.unwrap_or_else(|error| panic!("{error}"));
        let (left, scale) = moment(&settled, tilt.point.x);
        assert!(scale > 0.0 && left.abs() < 1e-6 * scale, "{left} of {scale}");
        if let Goal::Force(force) = goal {
            assert!((settled.resultant.force.z / force - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn axes_and_points_that_are_none_are_named() {
    let surface = two_balls(0.0);
    let refused = |tilt| tilted(&surface, Goal::Depth(1e-3), tilt).expect_err("not a tilt");
    let nowhere = Tilt { point: Vector3::new(0.0, f64::NAN, 0.0), axes: TiltAxes::Across };
    assert!(matches!(refused(nowhere), ContactError::TiltPoint { point } if point[1].is_nan()));
    let axes = TiltAxes::Two([Vector3::x(), Vector3::zeros()]);
    let error = refused(Tilt { point: Vector3::zeros(), axes });
    assert_eq!(error, ContactError::TiltAxis { number: 1, axis: [0.0; 3] });
    let axes = TiltAxes::Two([Vector3::x(), -2.0 * Vector3::x()]);
    assert_eq!(refused(Tilt { point: Vector3::zeros(), axes }), ContactError::ParallelAxes);
}
