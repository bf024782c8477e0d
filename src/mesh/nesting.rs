//! How the closed components of a mesh lie in one another, and which way they are turned.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::component::{Closed, closed_components};
use super::distance::triangle_distance_squared;
use super::error::MeshError;
use super::topology::Topology;
use super::winding::solid_angle;

/// Most and fewest points of one component that are looked at to place it inside, outside or on another.
const SAMPLES: (usize, usize) = (64, 4);
/// Pairs of points and faces that are looked at before the number of points is cut down to the fewest.
const PAIRS: usize = 20_000_000;
/// Points closer to a component than this part of the mean edge length lie on it (dimensionless).
const COINCIDENT_DISTANCE: f64 = 1e-3;

/// Volume of every component by the divergence theorem (m³); nan where a component is open.
///
/// * `vertices`, `faces`: the mesh (m), of which `topology` was made
pub fn component_volumes(vertices: &[Vector3<f64>], faces: &[[u32; 3]], topology: &Topology) -> Vec<f64> {
    closed_components(vertices, faces, topology)
        .into_iter()
        .map(|component| component.map_or(f64::NAN, |closed| closed.volume))
        .collect()
}

/// Checks that the closed components of a mesh bound a body: turned outward, or inward where they are cavities.
///
/// A component lies in another if its points have the winding number 1 in it (solid angle of all its faces).
/// One at even depth must have a positive volume, one at odd depth (a cavity) a negative one. Components that
/// cross each other count as side by side. Open components are left out.
///
/// * `vertices`, `faces`: the mesh (m), of which `topology` was made
///
/// # Errors
/// [`MeshError::CoincidentShell`], [`MeshError::InsideOut`] or [`MeshError::NestedShell`], in this order.
pub fn check_nesting(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    topology: &Topology,
) -> Result<(), MeshError> {
    let components = closed_components(vertices, faces, topology);
    let closed: Vec<&Closed> = components.iter().flatten().collect();
    let tolerance = COINCIDENT_DISTANCE * topology.mean_edge_length();
    let places = place_all(vertices, &closed, tolerance);

    let coincident: Vec<&Place> = places.iter().filter(|place| place.on.is_some()).collect();
    if let Some(first) = coincident.first() {
        let (other, distance) = first.on.expect("filtered");
        return Err(MeshError::CoincidentShell {
            component: closed[first.inner].label,
            face: closed[first.inner].first_face,
            other: closed[other].label,
            other_face: closed[other].first_face,
            distance,
            count: coincident.len(),
        });
    }
    let inside_out: Vec<&Place> =
        places.iter().filter(|place| closed[place.inner].is_inside_out(place.is_cavity())).collect();
    if let Some(first) = inside_out.first() {
        let component = closed[first.inner];
        return Err(MeshError::InsideOut {
            component: component.label,
            face: component.first_face,
            volume: component.volume,
            expected: if first.is_cavity() { '-' } else { '+' },
            count: inside_out.len(),
            component_count: topology.component_count(),
        });
    }
    let nested: Vec<&Place> =
        places.iter().filter(|place| place.is_cavity() && closed[place.inner].volume > 0.0).collect();
    if let Some(first) = nested.first() {
        let component = closed[first.inner];
        return Err(MeshError::NestedShell {
            component: component.label,
            face: component.first_face,
            volume: component.volume,
            outer: closed[first.around[0]].label,
            count: nested.len(),
        });
    }
    Ok(())
}

/// Closed components whose faces must be turned over so that the mesh bounds a body.
pub(super) fn components_to_turn(
    vertices: &[Vector3<f64>],
    components: &[Option<Closed>],
    mean_edge_length: f64,
) -> Vec<usize> {
    let closed: Vec<&Closed> = components.iter().flatten().collect();
    place_all(vertices, &closed, COINCIDENT_DISTANCE * mean_edge_length)
        .iter()
        .filter(|place| (closed[place.inner].volume < 0.0) != place.is_cavity())
        .map(|place| closed[place.inner].label)
        .collect()
}

/// Where a closed component lies among the others; indices into the list of closed ones.
struct Place {
    inner: usize,
    /// Components around it, from the smallest on.
    around: Vec<usize>,
    /// An earlier component that it lies on, and their largest distance (m).
    on: Option<(usize, f64)>,
}

impl Place {
    fn is_cavity(&self) -> bool {
        self.around.len() % 2 == 1
    }
}

fn place_all(vertices: &[Vector3<f64>], closed: &[&Closed], tolerance: f64) -> Vec<Place> {
    let margin = Vector3::repeat(tolerance);
    let may_hold = |inner: usize, outer: usize| {
        let (component, other) = (closed[inner], closed[outer]);
        inner != outer && component.low >= other.low - margin && component.high <= other.high + margin
    };
    let candidates: Vec<Vec<usize>> = (0..closed.len())
        .map(|inner| (0..closed.len()).filter(|outer| may_hold(inner, *outer)).collect())
        .collect();
    let face_count: usize = candidates.iter().flatten().map(|outer| closed[*outer].faces.len()).sum();
    let sample_count = (PAIRS / face_count.max(1)).clamp(SAMPLES.1, SAMPLES.0);
    let place = |(inner, candidates): (usize, &Vec<usize>)| {
        let mut place = Place { inner, around: Vec::new(), on: None };
        if candidates.is_empty() {
            return place;
        }
        let samples = closed[inner].samples(vertices, sample_count);
        for &outer in candidates {
            match relate(vertices, &samples, closed[outer], tolerance) {
                Relation::Inside => place.around.push(outer),
                Relation::On(distance) if outer < inner && place.on.is_none() => {
                    place.on = Some((outer, distance));
                }
                _ => {}
            }
        }
        place.around.sort_by(|a, b| closed[*a].volume.abs().total_cmp(&closed[*b].volume.abs()));
        place
    };
    candidates.par_iter().enumerate().map(place).collect()
}

enum Relation {
    Inside,
    On(f64),
    Apart,
}

/// Places sample points inside, on or outside (or across) a closed component, whichever way it is turned.
fn relate(vertices: &[Vector3<f64>], samples: &[Vector3<f64>], other: &Closed, tolerance: f64) -> Relation {
    let measured: Vec<(f64, bool)> = samples
        .par_iter()
        .map(|point| {
            let mut angle = 0.0;
            let mut distance_squared = f64::INFINITY;
            for face in &other.faces {
                let corners = face.map(|vertex| &vertices[vertex as usize]);
                angle += solid_angle(point, corners);
                distance_squared = distance_squared.min(triangle_distance_squared(point, corners));
            }
            (distance_squared.sqrt(), angle.abs() > 2.0 * std::f64::consts::PI)
        })
        .collect();
    let mut off = measured.iter().filter(|(distance, _)| *distance > tolerance).peekable();
    if off.peek().is_none() {
        return Relation::On(measured.iter().map(|sample| sample.0).fold(0.0, f64::max));
    }
    if off.all(|(_, inside)| *inside) { Relation::Inside } else { Relation::Apart }
}
