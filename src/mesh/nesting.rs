//! How the closed components of a mesh lie in one another, and which way they are turned.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::mesh::columns::{Columns, Location};
use crate::mesh::component::{ClosedComponent, closed_components};
use crate::mesh::error::MeshError;
use crate::mesh::topology::Topology;

/// Points of one component that are looked at to place it inside, outside or on another.
const SAMPLES: usize = 64;
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
/// A component lies in another if its points have a winding number other than 0 in it.
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
    let closed: Vec<&ClosedComponent> = components.iter().flatten().collect();
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
    components: &[Option<ClosedComponent>],
    mean_edge_length: f64,
) -> Vec<usize> {
    let closed: Vec<&ClosedComponent> = components.iter().flatten().collect();
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

fn place_all(vertices: &[Vector3<f64>], closed: &[&ClosedComponent], tolerance: f64) -> Vec<Place> {
    let may_hold = |inner: usize, outer: usize| {
        let (bounds, around) = (closed[inner].bounds, closed[outer].bounds.grown(tolerance));
        inner != outer && around.contains(&bounds.low) && around.contains(&bounds.high)
    };
    let candidates: Vec<Vec<usize>> = (0..closed.len())
        .map(|inner| (0..closed.len()).filter(|outer| may_hold(inner, *outer)).collect())
        .collect();
    let mut holds = vec![false; closed.len()];
    candidates.iter().flatten().for_each(|outer| holds[*outer] = true);
    let columns: Vec<Option<Columns>> = closed
        .par_iter()
        .zip(&holds)
        .map(|(component, holds)| holds.then(|| Columns::new(vertices, &component.faces)))
        .collect();
    let place = |(inner, candidates): (usize, &Vec<usize>)| {
        let mut place = Place { inner, around: Vec::new(), on: None };
        if candidates.is_empty() {
            return place;
        }
        let samples = closed[inner].samples(vertices, SAMPLES);
        for &outer in candidates {
            let columns = columns[outer].as_ref().expect("made for every component that may hold another");
            match relate(&samples, columns, tolerance) {
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

/// Places the points of a component inside, on or outside (or across) another, whichever way that is turned.
fn relate(samples: &[Vector3<f64>], other: &Columns, tolerance: f64) -> Relation {
    let (mut inside, mut outside, mut farthest) = (0, 0, 0.0f64);
    for point in samples {
        match other.locate(point, tolerance) {
            Location::Inside => inside += 1,
            Location::Outside => outside += 1,
            Location::On(distance) => farthest = farthest.max(distance),
            Location::Unclear => {}
        }
    }
    match (inside, outside) {
        (0, 0) => Relation::On(farthest),
        (_, 0) => Relation::Inside,
        _ => Relation::Apart,
    }
}
