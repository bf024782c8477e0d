//! Checks of everything that the later stages rely on.

use nalgebra::Vector3;

use crate::geometry::bounds::{LARGEST_COORDINATE, is_within_range};
use crate::mesh::adjacency::{EdgePairs, NO_FACE, pair_edges};
use crate::mesh::borders::check_borders;
use crate::mesh::csr::Csr;
use crate::mesh::error::MeshError;
use crate::mesh::fan::order_fans;
use crate::mesh::orient::orient;
use crate::mesh::topology::{Topology, boundary_loops, label_components};

/// A face is degenerate if its height over the longest edge is below this part of that edge (dimensionless).
pub const DEGENERATE_HEIGHT: f64 = 1e-12;

/// Checks a mesh and finds its neighbourhoods.
///
/// The first defect in this order is reported, so that what is said is the cause and not its consequence: no
/// vertex or face; coordinates that are not finite or too large; indices out of range; repeated indices; degenerate faces;
/// duplicate faces; edges with more than two faces; neighbours wound in opposite ways (or a surface that cannot
/// be oriented); borders that run along each other unwelded; loose triangles; pinched vertices; unused
/// vertices. Open meshes pass; [`check_nesting`](crate::mesh::check_nesting) asks whether closed components are
/// turned outward.
///
/// * `vertices`: positions (m)
/// * `faces`: three vertex indices each, counter-clockwise seen from outside
///
/// # Errors
/// A [`MeshError`] for the first defect in the order above.
pub fn check(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Result<Topology, MeshError> {
    check_elements(vertices, faces)?;
    check_areas(vertices, faces)?;
    let mut incident = Csr::faces_of_vertices(vertices.len(), faces);
    check_duplicates(faces, &incident)?;

    let pairs = pair_edges(faces, &incident);
    if let Some((edge, count)) = pairs.non_manifold {
        return Err(MeshError::NonManifoldEdge { vertices: edge.vertices, faces: edge.face_count, count });
    }
    if let Some((edge, count)) = pairs.same_direction {
        let orientation = orient(faces, &pairs.across);
        return Err(match orientation.conflict {
            Some((edge, count)) => {
                MeshError::NotOrientable { vertices: edge.vertices, faces: edge.faces, count }
            }
            None => MeshError::InconsistentOrientation {
                vertices: edge.vertices,
                faces: edge.faces,
                count,
                flips: orientation.flip.iter().filter(|flip| **flip).count(),
            },
        });
    }

    if pairs.border_edge_count > 0 {
        let mean_edge_length = mean_edge_length(vertices, faces, &pairs.across, pairs.edge_count);
        check_borders(vertices, faces, &pairs.across, &incident, mean_edge_length)?;
    }
    check_loose(&pairs.across)?;
    let (neighbours, pinched) = order_fans(faces, &pairs.across, &mut incident);
    if let Some((vertex, fans, count)) = pinched {
        return Err(MeshError::PinchedVertex { vertex, fans, count });
    }
    let unused = |vertex: &usize| incident.row(*vertex).is_empty();
    first_and_count((0..vertices.len()).filter(unused))
        .map_or(Ok(()), |(vertex, count)| Err(MeshError::UnusedVertex { vertex, count }))?;

    Ok(complete(vertices.len(), faces, incident, neighbours, pairs))
}

/// Neighbourhoods of a mesh that needs no check, but that a vertex of its border may join several fans.
pub(crate) fn sound_topology(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Topology {
    let mut incident = Csr::faces_of_vertices(vertices.len(), faces);
    let pairs = pair_edges(faces, &incident);
    let (neighbours, _) = order_fans(faces, &pairs.across, &mut incident);
    complete(vertices.len(), faces, incident, neighbours, pairs)
}

fn complete(
    vertex_count: usize,
    faces: &[[u32; 3]],
    faces_around: Csr,
    neighbours: Csr,
    pairs: EdgePairs,
) -> Topology {
    let (face_components, components_closed) = label_components(&pairs.across);
    Topology {
        boundary_loops: boundary_loops(faces, &pairs.across, vertex_count),
        faces_around,
        neighbours,
        across: pairs.across,
        face_components,
        components_closed,
        edge_count: pairs.edge_count,
    }
}

/// Counts, coordinates finite and in range, indices in range.
pub(crate) fn check_elements(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Result<(), MeshError> {
    if vertices.is_empty() || faces.is_empty() {
        return Err(MeshError::Empty { vertex_count: vertices.len(), face_count: faces.len() });
    }
    let not_finite = |(_, point): &(usize, &Vector3<f64>)| !point.iter().all(|value| value.is_finite());
    if let Some(((vertex, point), count)) = first_and_count(vertices.iter().enumerate().filter(not_finite)) {
        let k = point.iter().position(|value| !value.is_finite()).unwrap_or(0);
        return Err(MeshError::NonFinite { vertex, axis: ['x', 'y', 'z'][k], value: point[k], count });
    }
    let too_far = |(_, point): &(usize, &Vector3<f64>)| !is_within_range(point);
    if let Some(((vertex, point), count)) = first_and_count(vertices.iter().enumerate().filter(too_far)) {
        let k = point.iter().position(|value| value.abs() > LARGEST_COORDINATE).unwrap_or(0);
        return Err(MeshError::OutOfRange { vertex, axis: ['x', 'y', 'z'][k], value: point[k], count });
    }
    let vertex_count = vertices.len();
    let stray = |(face, corners): (usize, &[u32; 3])| {
        corners.iter().find(|vertex| **vertex as usize >= vertex_count).map(|vertex| (face, *vertex as usize))
    };
    match first_and_count(faces.iter().enumerate().filter_map(stray)) {
        Some(((face, vertex), count)) => {
            Err(MeshError::VertexOutOfRange { face, vertex, vertex_count, count })
        }
        None => Ok(()),
    }
}

/// The first item and the number of items.
pub(super) fn first_and_count<T>(mut items: impl Iterator<Item = T>) -> Option<(T, usize)> {
    let first = items.next()?;
    Some((first, 1 + items.count()))
}

/// The vertex that a face repeats.
pub(super) fn repeated_vertex(corners: &[u32; 3]) -> Option<u32> {
    let [a, b, c] = *corners;
    if a == b || a == c {
        Some(a)
    } else if b == c {
        Some(b)
    } else {
        None
    }
}

/// Height over the longest edge, and that edge (m).
pub(super) fn height_and_longest_edge(vertices: &[Vector3<f64>], corners: &[u32; 3]) -> (f64, f64) {
    let [a, b, c] = corners.map(|vertex| vertices[vertex as usize]);
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let longest = ab.norm().max(bc.norm()).max(ca.norm());
    if longest > 0.0 { (ab.cross(&ca).norm() / longest, longest) } else { (0.0, 0.0) }
}

/// Whether a face has no area to speak of.
pub(super) fn is_degenerate(vertices: &[Vector3<f64>], corners: &[u32; 3]) -> bool {
    let (height, longest) = height_and_longest_edge(vertices, corners);
    height <= DEGENERATE_HEIGHT * longest
}

fn check_areas(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Result<(), MeshError> {
    let repeats = |(face, corners)| repeated_vertex(corners).map(|vertex| (face, vertex as usize));
    if let Some(((face, vertex), count)) = first_and_count(faces.iter().enumerate().filter_map(repeats)) {
        return Err(MeshError::RepeatedVertex { face, vertex, count });
    }
    let degenerate = |face: &usize| is_degenerate(vertices, &faces[*face]);
    if let Some((face, count)) = first_and_count((0..faces.len()).filter(degenerate)) {
        let (height, longest_edge) = height_and_longest_edge(vertices, &faces[face]);
        return Err(MeshError::DegenerateFace { face, height, longest_edge, count });
    }
    Ok(())
}

/// Calls `visit` with the numbers of the faces that have the same three vertices, in ascending order.
pub(super) fn for_each_duplicate(faces: &[[u32; 3]], incident: &Csr, mut visit: impl FnMut(&[u32])) {
    let mut at_lowest: Vec<([u32; 3], u32)> = Vec::new();
    let mut same: Vec<u32> = Vec::new();
    for vertex in 0..incident.rows() {
        at_lowest.clear();
        for &face in incident.row(vertex) {
            let mut sorted = faces[face as usize];
            sorted.sort_unstable();
            if sorted[0] as usize == vertex {
                at_lowest.push((sorted, face));
            }
        }
        at_lowest.sort_unstable();
        for group in at_lowest.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            same.clear();
            same.extend(group.iter().map(|entry| entry.1));
            visit(&same);
        }
    }
}

fn check_duplicates(faces: &[[u32; 3]], incident: &Csr) -> Result<(), MeshError> {
    let mut first: Option<(u32, u32)> = None;
    let mut count = 0;
    for_each_duplicate(faces, incident, |same| {
        count += same.len() - 1;
        if first.is_none_or(|(face, _)| same[1] < face) {
            first = Some((same[1], same[0]));
        }
    });
    first.map_or(Ok(()), |(face, earlier)| {
        Err(MeshError::DuplicateFace { face: face as usize, earlier: earlier as usize, count })
    })
}

/// Faces without a neighbour, unless the mesh is a single face.
fn check_loose(across: &[[u32; 3]]) -> Result<(), MeshError> {
    let loose = |face: &usize| across[*face] == [NO_FACE; 3];
    match first_and_count((0..across.len()).filter(loose)) {
        Some((face, count)) if across.len() > 1 => {
            Err(MeshError::LooseFace { face, count, face_count: across.len() })
        }
        _ => Ok(()),
    }
}

/// Mean length of all edges (m), each counted once.
pub(super) fn mean_edge_length(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    across: &[[u32; 3]],
    edge_count: usize,
) -> f64 {
    let mut total = 0.0;
    for (face, (corners, others)) in faces.iter().zip(across).enumerate() {
        for k in 0..3 {
            // An edge counts at its lower face; NO_FACE is above all.
            if (face as u32) < others[k] {
                let (a, b) = (corners[k] as usize, corners[(k + 1) % 3] as usize);
                total += (vertices[b] - vertices[a]).norm();
            }
        }
    }
    total / edge_count as f64
}
