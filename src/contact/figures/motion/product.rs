//! The product as it looks under the solved forces: computed when somebody asks.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::contact::error::ContactError;
use crate::contact::figures::area::cells::mean_edge;
use crate::contact::figures::motion::fade::{fade, fade_distance};
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::outcome::{Contact, ContactStatus};
use crate::geometry::bounds::Bounds;
use crate::mesh::remesh::split_edges::split_long_edges;
use crate::obstacle::material::{CheckedResponse, Material};
use crate::response::kernel::skin::KernelSkin;
use crate::response::skin::elastic::{ElasticSkin, Request};
use crate::response::skin::given_matrix::GivenMatrix;
use crate::surface::checked::Surface;

impl Contact {
    /// Displacement of the product (n, m) at the point opposite each vertex of the skin, where the vertex comes to lie on
    /// it; 0 off the candidates, and of a rigid product.
    pub fn obstacle_displacement(&self) -> Vec<Vector3<f64>> {
        let mut displacement = vec![Vector3::zeros(); self.surface().vertices().len()];
        for (&vertex, moved) in self.candidates.iter().zip(&self.drawing.motion.product) {
            displacement[vertex] = *moved;
        }
        displacement
    }

    /// The product's mesh moved under the forces of this contact; `None` of a primitive.
    ///
    /// Under a kernel its edges are halved until those under the contact are no longer than the skin's; its vertices keep their
    /// numbers, those added follow. Each moves as the kernel says of the contact's pressure, laid on the
    /// product where it acts, faded to zero at the distance at which the skin's displacement has
    /// ([`DrawnSkin::fade_distance`](crate::contact::DrawnSkin)) with one finger, in a straight line from the contact; forces
    /// on sides that face away from each other move their own side alone. A given matrix moves the vertices that it knows,
    /// against their normals. No figure is taken from it.
    ///
    /// * `options`: those that the contact was solved with
    ///
    /// # Errors
    /// [`ContactError::Response`]: the work was interrupted.
    pub fn deformed_obstacle(&self, options: &ContactOptions) -> Result<Option<Surface>, ContactError> {
        let Some(mesh) = self.obstacle.surface() else { return Ok(None) };
        let Some(material) = self.obstacle.material() else { return Ok(Some(mesh)) };
        if self.status != ContactStatus::Solved {
            return Ok(Some(mesh));
        }
        with_threads(options, || {
            let (mut vertices, mut faces) = (mesh.vertices().to_vec(), mesh.faces().to_vec());
            if let CheckedResponse::Kernel(_) = &material.response {
                self.cut_fine_under_patches(&mut vertices, &mut faces);
            }
            let moved = self.product_vertices(&vertices, material, options)?;
            let mask = vec![true; moved.len()];
            Ok(Some(Surface::from_sound_mesh(moved, faces, mask)))
        })
    }

    /// Halves edges of the product at rest: to no longer than the skin's under a patch, and to that and the distance beside one.
    fn cut_fine_under_patches(&self, vertices: &mut Vec<Vector3<f64>>, faces: &mut Vec<[u32; 3]>) {
        let touched = |vertices: &[usize]| {
            let place = |&vertex: &usize| {
                let row = self.candidates.binary_search(&vertex).expect("forces are on candidates");
                self.surface().vertices()[vertex] + self.drawing.motion.displacement[row]
            };
            Bounds::around_each(vertices.iter().map(place))
        };
        let patches: Vec<(Bounds, f64)> = (self.patches.iter())
            .map(|patch| (touched(&patch.vertices), mean_edge(self.surface(), &patch.vertices)))
            .collect();
        let is_too_long = |a: &Vector3<f64>, b: &Vector3<f64>| {
            let edge = Bounds::around([a, b]);
            patches.iter().any(|(patch, shortest)| (a - b).norm() > shortest + patch.distance(&edge))
        };
        split_long_edges(vertices, faces, is_too_long);
    }

    /// Where vertices of the product come to lie (m).
    ///
    /// * `at_rest`: those of its mesh, then any others (m)
    fn product_vertices(
        &self,
        at_rest: &[Vector3<f64>],
        material: &Material,
        options: &ContactOptions,
    ) -> Result<Vec<Vector3<f64>>, ContactError> {
        let mut vertices = at_rest.to_vec();
        match &material.response {
            CheckedResponse::Matrix(given) => self.move_known(given, &mut vertices),
            CheckedResponse::Kernel(kernel) => {
                for side in self.drawing.on_product.groups() {
                    self.move_by_kernel(kernel, &side, at_rest, &mut vertices, options)?;
                }
            }
        }
        Ok(vertices)
    }

    /// Moves the vertices that a given matrix knows.
    fn move_known(&self, given: &GivenMatrix, vertices: &mut [Vector3<f64>]) {
        let (nodes, matrix) = (given.nodes(), given.response_matrix());
        let mut forces = vec![Vector3::zeros(); nodes.list().len()];
        for (&vertex, apart) in self.candidates.iter().zip(&self.drawing.motion.displacement) {
            let touched = self.surface().vertices()[vertex] + apart;
            let place = self.obstacle.closest_triangle(&touched).expect("a given matrix belongs to a mesh");
            for (row, weight) in given.rows_at(&place) {
                forces[row] += weight * self.force_vectors[vertex];
            }
        }
        for (row, &vertex) in nodes.list().iter().enumerate() {
            let moved = forces.iter().enumerate().map(|(column, force)| matrix[(row, column)] * force);
            vertices[vertex] -= moved.sum::<Vector3<f64>>();
        }
    }

    /// Moves the vertices around some candidates by a kernel, under the forces on these.
    ///
    /// * `candidates`: ascending
    /// * `at_rest`: vertices of the product (m)
    fn move_by_kernel(
        &self,
        kernel: &KernelSkin,
        candidates: &[usize],
        at_rest: &[Vector3<f64>],
        vertices: &mut [Vector3<f64>],
        options: &ContactOptions,
    ) -> Result<(), ContactError> {
        let active: Vec<usize> =
            candidates.iter().copied().filter(|vertex| self.active.binary_search(vertex).is_ok()).collect();
        if active.is_empty() {
            return Ok(());
        }
        let distance = fade_distance(self.surface(), candidates);
        let (mut points, faces, nodes) = self.load_on_product(&active);
        let around = Bounds::around(&points).grown(distance);
        let near: Vec<usize> = (0..at_rest.len()).filter(|&row| around.contains(&at_rest[row])).collect();
        let first = points.len();
        points.extend(near.iter().map(|&row| at_rest[row]));
        // Nothing fades on the triangles themselves.
        let edges = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        let length = |[from, to]: [u32; 2]| (points[from as usize] - points[to as usize]).norm();
        let cell = faces.iter().flat_map(edges).map(length).fold(0.0, f64::max);
        let share = |point: &Vector3<f64>| {
            let squares = points[..first].iter().map(|load| (load - point).norm_squared());
            fade((squares.fold(f64::INFINITY, f64::min).sqrt() - cell) / distance)
        };
        let shares: Vec<f64> = points[first..].par_iter().map(share).collect();
        // The product's vertices belong to no triangle of it: the pressure alone is the kernel's to see.
        let mask = vec![true; points.len()];
        let targets: Vec<usize> = (first..points.len()).collect();
        let surface = Surface::from_sound_mesh(points, faces, mask);
        let forces: Vec<Vector3<f64>> = active.iter().map(|&vertex| self.force_vectors[vertex]).collect();
        let asked = Request { surface: &surface, nodes: &nodes, options: &options.assembly() };
        let moved = kernel.displace(&asked, &forces, &targets)?;
        for ((&vertex, share), moved) in near.iter().zip(shares).zip(moved) {
            vertices[vertex] -= share * moved;
        }
        Ok(())
    }

    /// The triangles under force where they touch the product as it was: corners (m), triangles, and the corner of each
    /// active vertex.
    fn load_on_product(&self, active: &[usize]) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>, Vec<usize>) {
        let surface = self.surface();
        let corners = surface.k_ring(active, 1);
        let row = |vertex: usize| corners.binary_search(&vertex).expect("a corner of a triangle under force");
        let apart = |vertex: usize| {
            let row = self.candidates.binary_search(&vertex).ok()?;
            Some(self.drawing.motion.displacement[row])
        };
        let point = |&vertex: &usize| {
            // A free corner goes along with those beside it.
            let beside = surface.neighbours(vertex).iter().filter_map(|&other| {
                let is_active = active.binary_search(&(other as usize)).is_ok();
                apart(other as usize).filter(|_| is_active)
            });
            let mean = || {
                let beside: Vec<Vector3<f64>> = beside.collect();
                beside.iter().sum::<Vector3<f64>>() / beside.len() as f64
            };
            surface.vertices()[vertex] + apart(vertex).unwrap_or_else(mean)
        };
        let faces = surface.faces_at(active).into_iter();
        let faces = faces.map(|face| surface.faces()[face as usize].map(|v| row(v as usize) as u32));
        let nodes = active.iter().map(|&vertex| row(vertex)).collect();
        (corners.iter().map(point).collect(), faces.collect(), nodes)
    }
}
