//! How the closed components of a mesh lie in one another, and which way they are turned.

use nalgebra::Vector3;
use parry3d_f64::partitioning::Bvh;
use rayon::prelude::*;

use crate::geometry::face_tree::{Faces, face_tree};
use crate::geometry::solid_angle::winding_number;
use crate::mesh::check::mean_edge_length;
use crate::mesh::component::{ClosedComponent, closed_components};
use crate::mesh::error::MeshError;
use crate::mesh::topology::Topology;

/// Points of one component that place it inside, outside or on another.
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
/// A component lies in another if the other's winding number around its points is not 0. One at even depth must
/// have a positive volume, one at odd depth (a cavity) a negative one. Components that cross each other count as
/// side by side. Open components are left out.
///
/// * `vertices`, `faces`: the mesh (m), of which `topology` was made
///
/// # Errors
/// [`MeshError::CoincidentShell`], [`MeshError::Flat`], [`MeshError::InsideOut`] or [`MeshError::NestedShell`], in
/// this order.
pub fn check_nesting(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    topology: &Topology,
) -> Result<(), MeshError> {
    let components = closed_components(vertices, faces, topology);
    let closed: Vec<&ClosedComponent> = components.iter().flatten().collect();
    let mean_edge = mean_edge_length(vertices, faces, &topology.across, topology.edge_count);
    let tolerance = COINCIDENT_DISTANCE * mean_edge;
    let surroundings = find_surroundings(vertices, &closed, tolerance);

    let coincident: Vec<&Surroundings> = surroundings.iter().filter(|found| found.on.is_some()).collect();
    if let Some(first) = coincident.first() {
        let (other, distance) = first.on.expect("filtered");
        return Err(MeshError::CoincidentShell {
            component: closed[first.component].label,
            face: closed[first.component].first_face,
            other: closed[other].label,
            other_face: closed[other].first_face,
            distance,
            count: coincident.len(),
        });
    }
    let flat: Vec<&Surroundings> =
        surroundings.iter().filter(|found| closed[found.component].is_flat()).collect();
    if let Some(first) = flat.first() {
        let component = closed[first.component];
        return Err(MeshError::Flat {
            component: component.label,
            face: component.first_face,
            volume: component.volume,
            length: component.bounds.diagonal(),
            count: flat.len(),
            component_count: topology.component_count(),
        });
    }
    let inside_out: Vec<&Surroundings> = surroundings
        .iter()
        .filter(|found| closed[found.component].is_inside_out(found.is_cavity()))
        .collect();
    if let Some(first) = inside_out.first() {
        let component = closed[first.component];
        return Err(MeshError::InsideOut {
            component: component.label,
            face: component.first_face,
            volume: component.volume,
            expected: if first.is_cavity() { '-' } else { '+' },
            count: inside_out.len(),
            component_count: topology.component_count(),
        });
    }
    let nested: Vec<&Surroundings> = surroundings
        .iter()
        .filter(|found| found.is_cavity() && closed[found.component].volume > 0.0)
        .collect();
    if let Some(first) = nested.first() {
        let component = closed[first.component];
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
    find_surroundings(vertices, &closed, COINCIDENT_DISTANCE * mean_edge_length)
        .iter()
        .filter(|found| (closed[found.component].volume < 0.0) != found.is_cavity())
        .map(|found| closed[found.component].label)
        .collect()
}

/// What lies around a closed component; indices into the list of closed ones.
struct Surroundings {
    component: usize,
    /// Components around it, from the smallest on.
    around: Vec<usize>,
    /// An earlier component that it lies on, and their largest distance (m).
    on: Option<(usize, f64)>,
}

impl Surroundings {
    fn is_cavity(&self) -> bool {
        self.around.len() % 2 == 1
    }
}

fn find_surroundings(
    vertices: &[Vector3<f64>],
    closed: &[&ClosedComponent],
    tolerance: f64,
) -> Vec<Surroundings> {
    let may_hold = |outer: usize, inner: usize| {
        let (bounds, around) = (closed[inner].bounds, closed[outer].bounds.grown(tolerance));
        inner != outer && around.contains(&bounds.low) && around.contains(&bounds.high)
    };
    let relations_to = |outer: usize| -> Vec<(usize, Relation)> {
        let held: Vec<usize> = (0..closed.len()).filter(|inner| may_hold(outer, *inner)).collect();
        if held.is_empty() {
            return Vec::new();
        }
        let shell = Shell::new(vertices, &closed[outer].faces);
        let relation = |inner: usize| shell.relate(&closed[inner].samples(vertices, SAMPLES), tolerance);
        held.into_par_iter().map(|inner| (inner, relation(inner))).collect()
    };
    let relations: Vec<Vec<(usize, Relation)>> =
        (0..closed.len()).into_par_iter().map(relations_to).collect();
    let mut surroundings: Vec<Surroundings> =
        (0..closed.len()).map(|component| Surroundings { component, around: Vec::new(), on: None }).collect();
    for (outer, relations) in relations.into_iter().enumerate() {
        for (inner, relation) in relations {
            let found = &mut surroundings[inner];
            match relation {
                Relation::Inside => found.around.push(outer),
                Relation::On(distance) if outer < inner && found.on.is_none() => {
                    found.on = Some((outer, distance));
                }
                _ => {}
            }
        }
    }
    for found in &mut surroundings {
        found.around.sort_by(|a, b| closed[*a].volume.abs().total_cmp(&closed[*b].volume.abs()));
    }
    surroundings
}

enum Relation {
    Inside,
    On(f64),
    Apart,
}

/// A closed component that may hold others.
struct Shell<'a> {
    vertices: &'a [Vector3<f64>],
    corners: &'a [[u32; 3]],
    normals: Vec<Vector3<f64>>,
    tree: Bvh,
}

impl<'a> Shell<'a> {
    fn new(vertices: &'a [Vector3<f64>], corners: &'a [[u32; 3]]) -> Shell<'a> {
        let normal = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|vertex| vertices[vertex as usize]);
            (b - a).cross(&(c - a)).normalize()
        };
        let normals = corners.iter().map(normal).collect();
        Shell { vertices, corners, normals, tree: face_tree(vertices, corners) }
    }

    /// Places the points of another component inside, on or outside (or across) this one, whichever way it is turned.
    fn relate(&self, samples: &[Vector3<f64>], tolerance: f64) -> Relation {
        let (mut farthest, mut is_inside) = (0.0f64, false);
        for point in samples {
            let closest = self.faces().closest_to_point(&self.tree, point, tolerance);
            match closest.map(|(_, closest)| closest.distance_squared.sqrt()) {
                Some(distance) if distance <= tolerance => farthest = farthest.max(distance),
                _ if self.goes_around(point) => is_inside = true,
                _ => return Relation::Apart,
            }
        }
        if is_inside { Relation::Inside } else { Relation::On(farthest) }
    }

    fn goes_around(&self, point: &Vector3<f64>) -> bool {
        match (0..3).find_map(|axis| self.faces().winding_along(&self.tree, point, axis)) {
            Some(winding) => winding != 0,
            None => winding_number(point, self.vertices, self.corners.iter().copied()).abs() > 0.5,
        }
    }

    fn faces(&self) -> Faces<'_> {
        Faces { vertices: self.vertices, corners: self.corners, normals: &self.normals }
    }
}
