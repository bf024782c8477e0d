//! How the closed components of a mesh lie in one another, and which way they are turned.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::error::MeshError;
use super::topology::Topology;
use super::winding::{signed_volume, solid_angle};

/// Points of one component that are looked at to place it inside, outside or on another.
const SAMPLES: usize = 64;
/// Points closer to a component than this part of the mean edge length lie on it (dimensionless).
const COINCIDENT_DISTANCE: f64 = 1e-3;
/// A component encloses nothing if its volume is below this part of its cubed diagonal (dimensionless).
const FLAT_VOLUME: f64 = 1e-12;

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

/// A closed component.
pub(super) struct Closed {
    label: usize,
    first_face: usize,
    faces: Vec<[u32; 3]>,
    low: Vector3<f64>,
    high: Vector3<f64>,
    volume: f64,
}

impl Closed {
    fn is_flat(&self) -> bool {
        self.volume.abs() <= FLAT_VOLUME * (self.high - self.low).norm().powi(3)
    }

    /// Turned against its place, or flat; a cavity turned outward is a nested shell instead.
    fn is_inside_out(&self, is_cavity: bool) -> bool {
        self.is_flat() || (!is_cavity && self.volume < 0.0)
    }

    /// Corners and centroids of faces spread over the component.
    fn samples(&self, vertices: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let stride = self.faces.len().div_ceil(SAMPLES / 2);
        let points = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|vertex| vertices[vertex as usize]);
            [a, (a + b + c) / 3.0]
        };
        self.faces.iter().step_by(stride).flat_map(points).collect()
    }
}

fn closed_components(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    topology: &Topology,
) -> Vec<Option<Closed>> {
    let is_closed: Vec<bool> =
        (0..topology.component_count()).map(|label| topology.is_component_closed(label)).collect();
    split_closed(vertices, faces, topology.face_components(), &is_closed)
}

/// Gathers the closed components: `None` for the open ones.
pub(super) fn split_closed(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    labels: &[u32],
    is_closed: &[bool],
) -> Vec<Option<Closed>> {
    let mut components: Vec<Option<Closed>> = is_closed.iter().map(|_| None).collect();
    for (face, (corners, label)) in faces.iter().zip(labels).enumerate() {
        let label = *label as usize;
        if !is_closed[label] {
            continue;
        }
        let component = components[label].get_or_insert_with(|| Closed {
            label,
            first_face: face,
            faces: Vec::new(),
            low: Vector3::repeat(f64::INFINITY),
            high: Vector3::repeat(f64::NEG_INFINITY),
            volume: 0.0,
        });
        component.faces.push(*corners);
        for vertex in corners {
            component.low = component.low.inf(&vertices[*vertex as usize]);
            component.high = component.high.sup(&vertices[*vertex as usize]);
        }
    }
    for component in components.iter_mut().flatten() {
        let centre = (component.low + component.high) / 2.0;
        component.volume = signed_volume(&centre, vertices, component.faces.iter().copied());
    }
    components
}

/// Where a closed component lies among the others; indices into the list of closed ones.
struct Place {
    inner: usize,
    /// Components around it.
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
    let place = |inner: usize| {
        let mut place = Place { inner, around: Vec::new(), on: None };
        let component = closed[inner];
        let mut samples = Vec::new();
        for (outer, other) in closed.iter().enumerate() {
            let margin = Vector3::repeat(tolerance);
            let fits = component.low >= other.low - margin && component.high <= other.high + margin;
            if outer == inner || !fits {
                continue;
            }
            if samples.is_empty() {
                samples = component.samples(vertices);
            }
            match relate(vertices, &samples, other, tolerance) {
                Relation::Inside => place.around.push(outer),
                Relation::On(distance) if outer < inner && place.on.is_none() => {
                    place.on = Some((outer, distance));
                }
                _ => {}
            }
        }
        place
    };
    (0..closed.len()).map(place).collect()
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

/// Squared distance of a point from a triangle (m²) (regions after Ericson 2005, §5.1.5).
fn triangle_distance_squared(point: &Vector3<f64>, [a, b, c]: [&Vector3<f64>; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    // nearest to corner A
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.norm_squared();
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    // nearest to corner B
    if d3 >= 0.0 && d4 <= d3 {
        return bp.norm_squared();
    }
    let vc = d1 * d4 - d3 * d2;
    // nearest to edge AB
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ap - ab * (d1 / (d1 - d3))).norm_squared();
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    // nearest to corner C
    if d6 >= 0.0 && d5 <= d6 {
        return cp.norm_squared();
    }
    let vb = d5 * d2 - d1 * d6;
    // nearest to edge AC
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (ap - ac * (d2 / (d2 - d6))).norm_squared();
    }
    let va = d3 * d6 - d5 * d4;
    // nearest to edge BC
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (bp - (c - b) * s).norm_squared();
    }
    // nearest to the inside
    let sum = va + vb + vc;
    (ap - ab * (vb / sum) - ac * (vc / sum)).norm_squared()
}
