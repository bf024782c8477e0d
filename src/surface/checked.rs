//! The checked surface and what it stores.

use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};

use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::Faces;
use crate::mesh::check::{check, sound_topology};
use crate::mesh::distinct::distinct;
use crate::mesh::error::MeshError;
use crate::mesh::nesting::check_nesting;
use crate::mesh::topology::Topology;
use crate::surface::measures::Measures;

/// Why a surface was rejected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// The mesh has a defect.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The skin mask has the wrong length.
    #[error("the skin mask has {found} entries, but the surface has {expected} vertices")]
    MaskLength {
        /// Entries given.
        found: usize,
        /// Vertices of the surface.
        expected: usize,
    },
}

/// The skin: a checked triangle mesh (m) with its neighbourhoods, areas and normals.
///
/// Clones share all of it.
#[derive(Debug, Clone)]
pub struct Surface {
    vertices: Arc<Vec<Vector3<f64>>>,
    faces: Arc<Vec<[u32; 3]>>,
    topology: Arc<Topology>,
    skin_mask: Arc<Vec<bool>>,
    measures: Arc<Measures>,
}

impl Surface {
    /// Checks a mesh and computes its areas and normals; every vertex is skin.
    ///
    /// * `vertices`: positions (m)
    /// * `faces`: three vertex indices each, counter-clockwise seen from outside
    ///
    /// # Errors
    /// [`SurfaceError::Mesh`] as [`check`] and [`check_nesting`] describe.
    pub fn new(vertices: Vec<Vector3<f64>>, faces: Vec<[u32; 3]>) -> Result<Surface, SurfaceError> {
        let topology = check(&vertices, &faces)?;
        check_nesting(&vertices, &faces, &topology)?;
        let measures = Arc::new(Measures::new(&vertices, &faces, &topology));
        let skin_mask = Arc::new(vec![true; vertices.len()]);
        let (vertices, faces, topology) = (Arc::new(vertices), Arc::new(faces), Arc::new(topology));
        Ok(Surface { vertices, faces, topology, skin_mask, measures })
    }

    /// A surface of triangles known to be sound, but that a vertex of its border may join several fans.
    pub(crate) fn from_sound_mesh(
        vertices: Vec<Vector3<f64>>,
        faces: Vec<[u32; 3]>,
        skin_mask: Vec<bool>,
    ) -> Surface {
        let topology = sound_topology(&vertices, &faces);
        let measures = Arc::new(Measures::new(&vertices, &faces, &topology));
        let (vertices, faces, topology) = (Arc::new(vertices), Arc::new(faces), Arc::new(topology));
        Surface { vertices, faces, topology, skin_mask: Arc::new(skin_mask), measures }
    }

    /// The same surface, of which only some vertices may touch.
    ///
    /// * `mask`: per vertex, true where it is skin
    ///
    /// # Errors
    /// [`SurfaceError::MaskLength`].
    pub fn with_skin_mask(mut self, mask: Vec<bool>) -> Result<Surface, SurfaceError> {
        if mask.len() != self.vertices.len() {
            return Err(SurfaceError::MaskLength { found: mask.len(), expected: self.vertices.len() });
        }
        self.skin_mask = Arc::new(mask);
        Ok(self)
    }

    /// The same faces and skin mask at other positions, as after a deformation; the shape is not checked again.
    ///
    /// A face that has collapsed gets a zero normal, a vertex with nothing but such faces likewise.
    ///
    /// * `vertices`: as many positions (m) as the surface has vertices, finite
    ///
    /// # Panics
    /// If the number of positions is another.
    pub fn with_vertices(&self, vertices: Vec<Vector3<f64>>) -> Surface {
        assert_eq!(vertices.len(), self.vertices.len(), "as many positions as the surface has vertices");
        let measures = Arc::new(Measures::new(&vertices, &self.faces, &self.topology));
        Surface {
            vertices: Arc::new(vertices),
            faces: Arc::clone(&self.faces),
            topology: Arc::clone(&self.topology),
            skin_mask: Arc::clone(&self.skin_mask),
            measures,
        }
    }

    /// Whether it shares vertices and faces with another, as copies and those with another mask do.
    pub(crate) fn has_mesh_of(&self, other: &Surface) -> bool {
        Arc::ptr_eq(&self.vertices, &other.vertices) && Arc::ptr_eq(&self.faces, &other.faces)
    }

    /// The surface after a rigid motion.
    pub fn moved(&self, pose: &Isometry3<f64>) -> Surface {
        let vertices = self.vertices.iter().map(|point| pose.rotation * point + pose.translation.vector);
        self.with_vertices(vertices.collect())
    }

    /// Positions (m).
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// Vertex indices of each face, counter-clockwise seen from outside.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The faces, to be searched.
    pub(crate) fn as_faces(&self) -> Faces<'_> {
        Faces { vertices: &self.vertices, corners: &self.faces, normals: self.face_normals() }
    }

    /// Neighbourhoods, borders and components.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Outward unit normals of the vertices: face normals weighted by the angle of the face at the vertex.
    ///
    /// Unlike weights by area they depend on the shape and not on how it is cut into triangles (Thürmer and
    /// Wüthrich 1998).
    pub fn vertex_normals(&self) -> &[Vector3<f64>] {
        &self.measures.vertex_normals
    }

    /// Outward unit normals of the faces.
    pub fn face_normals(&self) -> &[Vector3<f64>] {
        &self.measures.face_normals
    }

    /// Vertex areas (m²): a third of the area of the faces around each vertex.
    pub fn vertex_areas(&self) -> &[f64] {
        &self.measures.vertex_areas
    }

    /// Areas of the faces (m²).
    pub fn face_areas(&self) -> &[f64] {
        &self.measures.face_areas
    }

    /// Area of the whole surface (m²).
    pub fn area(&self) -> f64 {
        self.measures.area
    }

    /// Volume enclosed (m³), by the divergence theorem about the middle of the bounding box; nan when open.
    pub fn volume(&self) -> f64 {
        self.measures.volume
    }

    /// Whether every edge has two faces.
    pub fn is_closed(&self) -> bool {
        self.topology.is_closed()
    }

    /// Mean length of the edges (m).
    pub fn mean_edge_length(&self) -> f64 {
        self.measures.mean_edge_length
    }

    /// Per vertex, whether it is skin and so may touch.
    pub fn skin_mask(&self) -> &[bool] {
        &self.skin_mask
    }

    /// Vertices joined to a vertex by an edge, counter-clockwise.
    pub fn neighbours(&self, vertex: usize) -> &[u32] {
        self.topology.neighbours(vertex)
    }

    /// Faces around a vertex (its one-ring), counter-clockwise.
    pub fn faces_around(&self, vertex: usize) -> &[u32] {
        self.topology.faces_around(vertex)
    }

    /// Faces around any of some vertices, ascending, each once.
    pub(crate) fn faces_at(&self, vertices: &[usize]) -> Vec<u32> {
        distinct(vertices.iter().flat_map(|&vertex| self.faces_around(vertex)).copied())
    }

    /// The box around the vertices.
    pub fn bounding_box(&self) -> Bounds {
        self.measures.bounding_box
    }
}
