//! A closed triangle mesh as obstacle: checks, search tree, nearest point.

use std::sync::OnceLock;

use nalgebra::Vector3;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::BvhNode;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};

use crate::geometry::bounds::Bounds;
use crate::geometry::closest_point::{Closest, Feature};
use crate::geometry::face_tree::{Faces, crossings_within, face_normals, node_bounds};
use crate::geometry::solid_angle::winding_number;
use crate::mesh::check::check;
use crate::mesh::nesting::check_nesting;
use crate::obstacle::convex_edge::{ConvexEdge, mesh_edges};
use crate::obstacle::error::ObstacleError;
use crate::obstacle::nearest::Nearest;
use crate::obstacle::primitive::SURFACE_TOLERANCE;
use crate::surface::coarse::{CoarsePlace, barycentric};

/// Below this cosine between `p - c` and a pseudo-normal the solid angle decides the sign (dimensionless): `p - c` is longer
/// than [`SURFACE_TOLERANCE`] of the mesh's size and rounded by 1e-16 of it, so its direction is known to 1e-6.
const AMBIGUOUS_COSINE: f64 = 1e-6;

/// Where the weighted normals of the faces around a corner or edge cancel to less than this (rad), as at the tip of a
/// needle, their sum is not known to [`AMBIGUOUS_COSINE`], and the solid angle decides as well.
const AMBIGUOUS_NORMAL: f64 = 1e-5;

/// Choices of [`Obstacle::mesh`](crate::obstacle::Obstacle::mesh).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshObstacleOptions {
    /// Look for faces that cross; `true` unless the mesh is known to be free of them.
    pub check_crossings: bool,
}

impl Default for MeshObstacleOptions {
    fn default() -> Self {
        MeshObstacleOptions { check_crossings: true }
    }
}

/// A checked closed mesh in its own frame.
pub(super) struct MeshShape {
    vertices: Vec<Vector3<f64>>,
    faces: Vec<[u32; 3]>,
    /// Unit normal of each face.
    normals: Vec<Vector3<f64>>,
    /// The boxes around the faces, and the pseudo-normals of edges and vertices.
    tree: TriMesh,
    /// Diagonal of the bounding box (m).
    size: f64,
    /// Sharp convex edges, once somebody asked for them.
    sharp_edges: OnceLock<Vec<ConvexEdge>>,
}

impl MeshShape {
    /// Checks the mesh and builds its tree.
    pub fn new(
        vertices: Vec<Vector3<f64>>,
        faces: Vec<[u32; 3]>,
        options: &MeshObstacleOptions,
    ) -> Result<MeshShape, ObstacleError> {
        check_closed(&vertices, &faces)?;
        let shape = MeshShape::unchecked(vertices, faces);
        if options.check_crossings {
            let pairs = crossings_within(&shape.vertices, &shape.faces, shape.tree.bvh());
            if let Some(&[first, second]) = pairs.first() {
                let location = overlap_center(&shape.vertices, shape.faces[first], shape.faces[second]);
                return Err(ObstacleError::CrossingFaces { count: pairs.len(), first, second, location });
            }
        }
        Ok(shape)
    }

    fn unchecked(vertices: Vec<Vector3<f64>>, faces: Vec<[u32; 3]>) -> MeshShape {
        let normals = face_normals(&vertices, &faces);
        let corners = vertices.iter().map(|v| Vector::new(v.x, v.y, v.z)).collect();
        let mut tree = TriMesh::new(corners, faces.clone()).expect("a checked mesh has faces");
        tree.set_flags(TriMeshFlags::ORIENTED).expect("a checked mesh has a sound topology");
        let size = Bounds::around(&vertices).diagonal();
        MeshShape { vertices, faces, normals, tree, size, sharp_edges: OnceLock::new() }
    }

    /// The vertices (m).
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// The faces.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The faces, to be searched with the [tree](Self::tree).
    pub fn search(&self) -> Faces<'_> {
        Faces { vertices: &self.vertices, corners: &self.faces, normals: &self.normals }
    }

    /// Its sharp convex edges.
    pub fn sharp_edges(&self) -> &[ConvexEdge] {
        let find = || mesh_edges(&self.vertices, &self.faces, &self.normals, ConvexEdge::is_sharp);
        self.sharp_edges.get_or_init(find)
    }

    /// The tree of boxes around the faces.
    pub fn tree(&self) -> &TriMesh {
        &self.tree
    }

    /// Diagonal of the bounding box (m).
    pub fn size(&self) -> f64 {
        self.size
    }

    /// How far along a direction some of it lies (m).
    pub fn farthest_along(&self, direction: &Vector3<f64>) -> f64 {
        let bound = |node: &BvhNode, _: f64| -node_bounds(node).farthest_along(direction);
        let of_face = |face: u32, _: f64| {
            let corners = self.faces[face as usize].iter();
            let depths = corners.map(|&corner| self.vertices[corner as usize].dot(direction));
            Some(-depths.fold(f64::NEG_INFINITY, f64::max))
        };
        let found = self.tree.bvh().find_best(f64::INFINITY, bound, of_face);
        -found.expect("a checked mesh has faces").1
    }

    /// Nearest point of the surface; `None` if it is surely farther than `reach` (m).
    pub fn nearest(&self, p: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        let (face, closest) = self.search().closest_to_point(self.tree.bvh(), p, reach)?;
        Some(self.signed(p, face, &closest))
    }

    /// The triangle closest to a point, and where on it.
    pub fn closest_triangle(&self, p: &Vector3<f64>) -> CoarsePlace {
        let (face, weights, _) = barycentric(&self.search(), self.tree.bvh(), p);
        CoarsePlace { corners: self.faces[face], weights }
    }

    /// Signed distance and normal from the closest point on `face`.
    fn signed(&self, p: &Vector3<f64>, face: usize, closest: &Closest) -> Nearest {
        let offset = p - closest.point;
        let length = offset.norm();
        if length > self.size {
            // Nothing inside is so far from the surface; from farther away rounding would choose the face and the side.
            return Nearest { distance: length, closest: closest.point, normal: offset / length };
        }
        let pseudo_normals = self.tree.pseudo_normals_if_oriented().expect("the tree is built oriented");
        let pseudo_normal = match closest.feature {
            Feature::Face => {
                // p - c is parallel to the face normal, which has no rounding noise however near p is.
                let normal = self.normals[face];
                let corner = self.vertices[self.faces[face][0] as usize];
                return Nearest { distance: (p - corner).dot(&normal), closest: closest.point, normal };
            }
            Feature::Edge(i) => pseudo_normals.edges_pseudo_normal[face][i],
            Feature::Corner(i) => pseudo_normals.vertices_pseudo_normal[self.faces[face][i] as usize],
        };
        let pseudo_normal = Vector3::new(pseudo_normal.x, pseudo_normal.y, pseudo_normal.z);
        let is_known = pseudo_normal.norm() > AMBIGUOUS_NORMAL;
        // A knife edge folded flat has none; its face's normal is as good as any.
        let pseudo_normal = pseudo_normal.try_normalize(0.0).unwrap_or(self.normals[face]);

        let height = offset.dot(&pseudo_normal);
        if length <= SURFACE_TOLERANCE * self.size {
            return Nearest {
                distance: length.copysign(height),
                closest: closest.point,
                normal: pseudo_normal,
            };
        }
        let outside = if is_known && height.abs() > AMBIGUOUS_COSINE * length {
            height > 0.0
        } else {
            winding_number(p, &self.vertices, self.faces.iter().copied()) < 0.5
        };
        let sign = if outside { 1.0 } else { -1.0 };
        Nearest { distance: sign * length, closest: closest.point, normal: offset * (sign / length) }
    }
}

impl std::fmt::Debug for MeshShape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MeshShape")
            .field("vertices", &self.vertices.len())
            .field("faces", &self.faces.len())
            .finish_non_exhaustive()
    }
}

fn check_closed(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Result<(), ObstacleError> {
    let topology = check(vertices, faces)?;
    let loops = topology.boundary_loops();
    match loops.first() {
        None => Ok(check_nesting(vertices, faces, &topology)?),
        Some(first) => Err(ObstacleError::NotClosed {
            loops: loops.len(),
            edges: loops.iter().map(Vec::len).sum(),
            vertex: first[0] as usize,
        }),
    }
}

fn overlap_center(vertices: &[Vector3<f64>], first: [u32; 3], second: [u32; 3]) -> [f64; 3] {
    let [first, second] = [first, second].map(|face| Bounds::around(face.map(|v| &vertices[v as usize])));
    first.intersection(&second).center().into()
}
