//! The closed components of a mesh.

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;
use crate::geometry::solid_angle::signed_volume;
use crate::mesh::topology::Topology;

/// A component encloses nothing if its volume is below this part of its cubed diagonal (dimensionless).
const FLAT_VOLUME: f64 = 1e-12;

/// A closed component.
pub(super) struct ClosedComponent {
    /// Its number in the mesh.
    pub label: usize,
    /// Number of its first face.
    pub first_face: usize,
    /// Its faces, in their order.
    pub faces: Vec<[u32; 3]>,
    /// The box around it.
    pub bounds: Bounds,
    /// Volume (m³), negative where it is turned inward.
    pub volume: f64,
}

impl ClosedComponent {
    pub(super) fn is_flat(&self) -> bool {
        self.volume.abs() <= FLAT_VOLUME * self.bounds.diagonal().powi(3)
    }

    /// Turned against its place; a cavity turned outward is a nested shell instead.
    pub(super) fn is_inside_out(&self, is_cavity: bool) -> bool {
        !is_cavity && self.volume < 0.0
    }

    /// Corners and centroids of faces spread over the component, `count` points at most.
    pub(super) fn samples(&self, vertices: &[Vector3<f64>], count: usize) -> Vec<Vector3<f64>> {
        let stride = self.faces.len().div_ceil(count / 2);
        let points = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|vertex| vertices[vertex as usize]);
            [a, (a + b + c) / 3.0]
        };
        self.faces.iter().step_by(stride).flat_map(points).collect()
    }
}

/// The closed components of a checked mesh: `None` for the open ones.
pub(super) fn closed_components(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    topology: &Topology,
) -> Vec<Option<ClosedComponent>> {
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
) -> Vec<Option<ClosedComponent>> {
    let mut components: Vec<Option<ClosedComponent>> = is_closed.iter().map(|_| None).collect();
    for (face, (corners, label)) in faces.iter().zip(labels).enumerate() {
        let label = *label as usize;
        if !is_closed[label] {
            continue;
        }
        let component = components[label].get_or_insert_with(|| ClosedComponent {
            label,
            first_face: face,
            faces: Vec::new(),
            bounds: Bounds::around([]),
            volume: 0.0,
        });
        component.faces.push(*corners);
    }
    for component in components.iter_mut().flatten() {
        let corners = component.faces.iter().flatten();
        component.bounds = Bounds::around(corners.map(|vertex| &vertices[*vertex as usize]));
        let center = component.bounds.center();
        component.volume = signed_volume(&center, vertices, component.faces.iter().copied());
    }
    components
}
