//! Mending what can be mended without guessing.

use std::fmt;

use nalgebra::Vector3;

use crate::mesh::adjacency::pair_edges;
use crate::mesh::check::{check_elements, for_each_duplicate, is_degenerate, repeated_vertex};
use crate::mesh::component::split_closed;
use crate::mesh::csr::Csr;
use crate::mesh::error::MeshError;
use crate::mesh::nesting::components_to_turn;
use crate::mesh::orient::orient;
use crate::mesh::topology::label_components;
use crate::mesh::weld::weld;

/// Parameters of [`repair`].
#[derive(Debug, Clone, PartialEq)]
pub struct RepairOptions {
    /// Vertices up to this far apart become one (m, >= 0); 0 welds equal points only.
    pub weld_tolerance: f64,
}

/// What [`repair`] changed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RepairReport {
    /// Vertices that were welded to another one.
    pub welded_vertices: usize,
    /// Farthest way that welding moved a vertex (m).
    pub largest_move: f64,
    /// Faces dropped because welding made two of their corners one, or because they named a vertex twice.
    pub collapsed_faces: usize,
    /// Faces dropped because they have no area.
    pub zero_area_faces: usize,
    /// Faces dropped because another face has the same three vertices.
    pub duplicate_faces: usize,
    /// Vertices dropped because no face is left that uses them.
    pub unused_vertices: usize,
    /// Faces turned over, to agree with their neighbours or to face outward.
    pub flipped_faces: usize,
    /// Closed components of those that were turned over as a whole.
    pub turned_components: usize,
}

/// A mended mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Repair {
    /// Positions (m).
    pub vertices: Vec<Vector3<f64>>,
    /// Faces, in the order of the faces given.
    pub faces: Vec<[u32; 3]>,
    /// For every vertex given, the vertex that it became; `None` if it was dropped.
    pub vertex_map: Vec<Option<usize>>,
    /// What was changed.
    pub report: RepairReport,
}

impl RepairReport {
    /// Whether the mesh came back as it was given.
    pub fn is_unchanged(&self) -> bool {
        let counts = [
            self.welded_vertices,
            self.collapsed_faces,
            self.zero_area_faces,
            self.duplicate_faces,
            self.unused_vertices,
            self.flipped_faces,
        ];
        counts == [0; 6]
    }
}

impl fmt::Display for RepairReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} vertices welded (moved by at most {:.3e} m); dropped {} collapsed, {} zero-area and {} duplicate \
             faces and {} unused vertices; flipped {} faces ({} closed components turned over)",
            self.welded_vertices,
            self.largest_move,
            self.collapsed_faces,
            self.zero_area_faces,
            self.duplicate_faces,
            self.unused_vertices,
            self.flipped_faces,
            self.turned_components
        )
    }
}

/// Mends what can be mended without guessing, and reports the changes.
///
/// In this order:
/// 1. vertices within `weld_tolerance` become one, chains of them too; the lowest index stays where it is;
/// 2. faces that lost a corner, faces without area and faces with the vertices of an earlier one are dropped; of the
///    two sides of a fin, which stands on the surface, both;
/// 3. in each component the smaller part of the faces is flipped to agree with the rest;
/// 4. closed components are turned outward, cavities inward;
/// 5. unused vertices are dropped.
///
/// Holes are not filled and crossings stay, so [`check`](crate::mesh::check::check) may still find a defect.
///
/// * `vertices`: positions (m)
/// * `faces`: three vertex indices each
///
/// # Errors
/// [`MeshError::WeldTolerance`], [`MeshError::Empty`], [`MeshError::NonFinite`],
/// [`MeshError::VertexOutOfRange`]; [`MeshError::NothingLeft`] if all faces vanish;
/// [`MeshError::NotOrientable`] for a one-sided surface (its vertices and faces are those of the mesh given).
pub fn repair(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    options: &RepairOptions,
) -> Result<Repair, MeshError> {
    let weld_tolerance = options.weld_tolerance;
    if !(weld_tolerance.is_finite() && weld_tolerance >= 0.0) {
        return Err(MeshError::WeldTolerance { value: weld_tolerance });
    }
    check_elements(vertices, faces)?;

    let root = weld(vertices, weld_tolerance);
    let distance = |(i, root): (usize, &u32)| (vertices[i] - vertices[*root as usize]).norm();
    let mut report = RepairReport {
        welded_vertices: root.iter().enumerate().filter(|(i, root)| *i != **root as usize).count(),
        largest_move: root.iter().enumerate().map(distance).fold(0.0, f64::max),
        ..RepairReport::default()
    };
    let (mut kept, origin) = drop_faces(vertices, faces, &root, &mut report);
    if kept.is_empty() {
        return Err(MeshError::NothingLeft {
            face_count: faces.len(),
            collapsed: report.collapsed_faces,
            degenerate: report.zero_area_faces,
            duplicates: report.duplicate_faces,
            weld_tolerance,
        });
    }
    turn_faces(vertices, &mut kept, &origin, &mut report)?;
    Ok(compact(vertices, kept, &root, report))
}

/// The faces that stay, with welded vertices, and their numbers in the mesh given.
fn drop_faces(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    root: &[u32],
    report: &mut RepairReport,
) -> (Vec<[u32; 3]>, Vec<usize>) {
    let mut kept = Vec::with_capacity(faces.len());
    let mut origin = Vec::with_capacity(faces.len());
    for (face, corners) in faces.iter().enumerate() {
        let corners = corners.map(|vertex| root[vertex as usize]);
        if repeated_vertex(&corners).is_some() {
            report.collapsed_faces += 1;
        } else if is_degenerate(vertices, &corners) {
            report.zero_area_faces += 1;
        } else {
            kept.push(corners);
            origin.push(face);
        }
    }
    let incident = Csr::faces_of_vertices(vertices.len(), &kept);
    let mut surplus = vec![false; kept.len()];
    for_each_duplicate(&kept, &incident, |same| {
        let stays = usize::from(!is_fin(&kept, &incident, same));
        same[stays..].iter().for_each(|face| surplus[*face as usize] = true);
    });
    report.duplicate_faces = surplus.iter().filter(|surplus| **surplus).count();
    (0..kept.len()).filter(|&face| !surplus[face]).map(|face| (kept[face], origin[face])).unzip()
}

/// Whether faces with the same vertices are the two sides of a fin: as many turned one way as the other, an edge
/// that is theirs alone, and an even number of other faces on the rest, so that no hole is left without them.
fn is_fin(faces: &[[u32; 3]], incident: &Csr, same: &[u32]) -> bool {
    let [a, b, c] = faces[same[0] as usize];
    let like_first = |face: &&u32| {
        let other = faces[**face as usize];
        [[a, b, c], [b, c, a], [c, a, b]].contains(&other)
    };
    let others_on = |a: u32, b: u32| {
        let around = incident.row(a as usize).iter();
        around.filter(|face| faces[**face as usize].contains(&b)).count() - same.len()
    };
    let others = [others_on(a, b), others_on(b, c), others_on(c, a)];
    2 * same.iter().filter(like_first).count() == same.len()
        && others.contains(&0)
        && others.iter().all(|count| count % 2 == 0)
}

/// Flips faces to agree with their neighbours, then turns closed components outward (cavities inward).
fn turn_faces(
    vertices: &[Vector3<f64>],
    faces: &mut [[u32; 3]],
    origin: &[usize],
    report: &mut RepairReport,
) -> Result<(), MeshError> {
    let incident = Csr::faces_of_vertices(vertices.len(), faces);
    let pairs = pair_edges(faces, &incident);
    let orientation = orient(faces, &pairs.across);
    if let Some((edge, count)) = orientation.conflict {
        return Err(MeshError::NotOrientable {
            vertices: edge.vertices,
            faces: edge.faces.map(|face| origin[face]),
            count,
        });
    }
    let mut flip = orientation.flip;
    for (corners, _) in faces.iter_mut().zip(&flip).filter(|(_, flip)| **flip) {
        corners.swap(1, 2);
    }
    let (component, is_closed) = label_components(&pairs.across);
    let mut total = 0.0;
    for corners in faces.iter() {
        total += (vertices[corners[1] as usize] - vertices[corners[0] as usize]).norm();
    }
    let components = split_closed(vertices, faces, &component, &is_closed);
    let turned = components_to_turn(vertices, &components, total / faces.len() as f64);
    let mut turn = vec![false; is_closed.len()];
    turned.iter().for_each(|label| turn[*label] = true);
    for (face, corners) in faces.iter_mut().enumerate() {
        if turn[component[face] as usize] {
            corners.swap(1, 2);
            flip[face] ^= true;
        }
    }
    report.flipped_faces = flip.iter().filter(|flip| **flip).count();
    report.turned_components = turned.len();
    Ok(())
}

/// Drops the vertices that no face uses and renumbers the rest in their order.
fn compact(
    vertices: &[Vector3<f64>],
    mut faces: Vec<[u32; 3]>,
    root: &[u32],
    mut report: RepairReport,
) -> Repair {
    let mut number: Vec<Option<usize>> = vec![None; vertices.len()];
    for vertex in faces.iter().flatten() {
        number[*vertex as usize] = Some(0);
    }
    let mut kept = Vec::new();
    for (vertex, slot) in number.iter_mut().enumerate() {
        if slot.is_some() {
            *slot = Some(kept.len());
            kept.push(vertices[vertex]);
        }
    }
    report.unused_vertices =
        root.iter().enumerate().filter(|(i, root)| *i == **root as usize && number[*i].is_none()).count();
    for vertex in faces.iter_mut().flatten() {
        *vertex = number[*vertex as usize].expect("used by a face") as u32;
    }
    let vertex_map = root.iter().map(|root| number[*root as usize]).collect();
    Repair { vertices: kept, faces, vertex_map, report }
}
