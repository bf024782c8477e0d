//! How the closed components of a mesh lie in one another, and which way they are turned.

use nalgebra::Vector3;
use parry3d_f64::partitioning::Bvh;
use rayon::prelude::*;

use crate::geometry::bounds::Bounds;
use crate::geometry::crossing::triangles_pierce;
use crate::geometry::face_tree::{Faces, face_normals, face_tree, node_bounds};
use crate::geometry::solid_angle::winding_number;
use crate::mesh::check::{first_and_count, mean_edge_length};
use crate::mesh::component::{ClosedComponent, closed_components};
use crate::mesh::error::MeshError;
use crate::mesh::topology::Topology;

/// Points of one component that place it inside, outside or on another.
const SAMPLE_POINTS: usize = 64;
/// Points closer to a component than this part of the mean edge length lie on it (dimensionless).
const COINCIDENT_DISTANCE: f64 = 1e-3;
/// The same of components turned opposite ways, between which there is a wall, however thin: no more than rounding of the
/// coordinates (dimensionless).
const COINCIDENT_OPPOSITE_DISTANCE: f64 = 1e-9;

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
    let surroundings = find_surroundings(vertices, &closed, mean_edge);

    let first_where = |is_fault: &dyn Fn(&Surroundings, &ClosedComponent) -> bool| {
        let faults = surroundings.iter().filter(|found| is_fault(found, closed[found.component]));
        first_and_count(faults).map(|(first, count)| (first, closed[first.component], count))
    };
    let component_count = topology.component_count();
    if let Some((first, component, count)) = first_where(&|found, _| found.on.is_some()) {
        let (other, distance) = first.on.expect("filtered");
        let (face, other_face) = (component.first_face, closed[other].first_face);
        let (component, other) = (component.label, closed[other].label);
        return Err(MeshError::CoincidentShell { component, face, other, other_face, distance, count });
    }
    if let Some((_, component, count)) = first_where(&|_, component| component.is_flat()) {
        let (face, volume, length) = (component.first_face, component.volume, component.bounds.diagonal());
        let component = component.label;
        return Err(MeshError::Flat { component, face, volume, length, count, component_count });
    }
    let is_inside_out =
        |found: &Surroundings, component: &ClosedComponent| component.is_inside_out(found.is_cavity());
    if let Some((first, component, count)) = first_where(&is_inside_out) {
        let (face, volume) = (component.first_face, component.volume);
        let expected = if first.is_cavity() { '-' } else { '+' };
        let component = component.label;
        return Err(MeshError::InsideOut { component, face, volume, expected, count, component_count });
    }
    let is_nested =
        |found: &Surroundings, component: &ClosedComponent| found.is_cavity() && component.volume > 0.0;
    if let Some((first, component, count)) = first_where(&is_nested) {
        let (face, volume, outer) = (component.first_face, component.volume, closed[first.around[0]].label);
        let component = component.label;
        return Err(MeshError::NestedShell { component, face, volume, outer, count });
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
    find_surroundings(vertices, &closed, mean_edge_length)
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
    mean_edge_length: f64,
) -> Vec<Surroundings> {
    let tolerance = |outer: usize, inner: usize| {
        let is_wall = (closed[outer].volume < 0.0) != (closed[inner].volume < 0.0);
        mean_edge_length * if is_wall { COINCIDENT_OPPOSITE_DISTANCE } else { COINCIDENT_DISTANCE }
    };
    let may_hold = |outer: usize, inner: usize| {
        let (bounds, around) = (closed[inner].bounds, closed[outer].bounds.grown(tolerance(outer, inner)));
        inner != outer && around.contains(&bounds.low) && around.contains(&bounds.high)
    };
    let relations_to = |outer: usize| -> Vec<(usize, Relation)> {
        let held: Vec<usize> = (0..closed.len()).filter(|inner| may_hold(outer, *inner)).collect();
        if held.is_empty() {
            return Vec::new();
        }
        let shell = Shell::new(vertices, &closed[outer].faces);
        let relation = |inner: usize| shell.relate(closed[inner], tolerance(outer, inner));
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
        let normals = face_normals(vertices, corners);
        Shell { vertices, corners, normals, tree: face_tree(vertices, corners) }
    }

    /// Places another component inside, on or outside (or across) this one, whichever way it is turned.
    fn relate(&self, other: &ClosedComponent, tolerance: f64) -> Relation {
        let (mut farthest, mut is_inside) = (0.0f64, false);
        for point in other.samples(self.vertices, SAMPLE_POINTS) {
            let closest = self.faces().closest_to_point(&self.tree, &point, tolerance);
            match closest.map(|(_, closest)| closest.distance_squared.sqrt()) {
                Some(distance) if distance <= tolerance => farthest = farthest.max(distance),
                _ if self.goes_around(&point) => is_inside = true,
                _ => return Relation::Apart,
            }
        }
        if !is_inside {
            Relation::On(farthest)
        } else if self.crosses(other) {
            Relation::Apart
        } else {
            Relation::Inside
        }
    }

    /// Whether another component passes through this one's faces; one that touches them does not.
    fn crosses(&self, other: &ClosedComponent) -> bool {
        other.faces.par_iter().any(|face| {
            let triangle = face.map(|vertex| &self.vertices[vertex as usize]);
            let bounds = Bounds::around(triangle);
            let mut close = self.tree.leaves(|node| node_bounds(node).meets(&bounds));
            close.any(|own| triangles_pierce(self.faces().triangle(own as usize), triangle))
        })
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
