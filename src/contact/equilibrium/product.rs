//! An elastic product's share of the response, on the nodes of the skin.
//!
//! ```text
//! R = R_H + R_P   (m/N, both along the obstacle's normals)
//! ```
//!
//! as the same forces move the skin out of the obstacle and the obstacle back. A kernel's R_P is that of a skin with the
//! product's constants on the same mesh: in contact both surfaces are one. A given matrix M is known at vertices of the
//! product's mesh, so `R_P = W M Wᵀ` times the cosines between the normals, W the weights of these vertices at the point
//! of the product opposite each node.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use faer::Mat;
use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::obstacle::material::{CheckedResponse, Material};
use crate::obstacle::posed::Obstacle;
use crate::response::body::levels::coarseness::{BodyDoubt, lost_displacement};
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::matrix::displaced::displaced_at;
use crate::response::matrix::fill::{fill_items, filled_columns};
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::response::skin::given_matrix::GivenMatrix;
use crate::surface::checked::Surface;
use crate::surface::coarse::CoarsePlace;

/// Weight of an unknown vertex of the product up to which a point beside it is known.
const NO_WEIGHT: f64 = 1e-9;

/// Relative error of the force per share of the depth that interpolation between the vertices of a given matrix loses, which
/// has all its local give from there: fitted to half-spaces of about the skin's stiffness under a finger.
const FORCE_PER_LOSS: f64 = 1.2;

/// The response of a product as if it were a skin with the mesh of `gaps`.
///
/// * `traits`: of the skin
pub(crate) fn product_response<'a>(
    material: &'a Material,
    gaps: &Gaps<'a>,
    traits: &Traits,
) -> Result<Box<dyn ElasticSkin + 'a>, ContactError> {
    let given = match &material.response {
        CheckedResponse::Matrix(given) => given,
        CheckedResponse::Kernel(kernel) => {
            let kernel = kernel.clone().with_basis(traits.basis);
            return Ok(Box::new(kernel.with_discretization(traits.discretization)?));
        }
    };
    if traits.discretization == Discretization::Galerkin {
        let what = "a given matrix takes the gap at the nodes: `discretization=\"collocation\"` of the skin";
        return Err(ResponseError::Product { what }.into());
    }
    let obstacle = &gaps.scene.obstacle;
    let feet: Vec<Vector3<f64>> =
        (0..gaps.surface.vertices().len()).map(|vertex| gaps.foot(vertex)).collect();
    let places = feet.iter().map(|_| OnceLock::new()).collect();
    Ok(Box::new(GivenProduct { given, obstacle, feet, places }))
}

/// A matrix over vertices of the product, at the vertices of the skin opposite them.
struct GivenProduct<'a> {
    given: &'a GivenMatrix,
    obstacle: &'a Obstacle,
    /// Points of the obstacle opposite the vertices of the skin, or beside these (n, m).
    feet: Vec<Vector3<f64>>,
    /// Where they lie on the product's mesh, once somebody asked.
    places: Vec<OnceLock<CoarsePlace>>,
}

impl GivenProduct<'_> {
    fn place(&self, vertex: usize) -> &CoarsePlace {
        let find =
            || self.obstacle.closest_triangle(&self.feet[vertex]).expect("a given matrix belongs to a mesh");
        self.places[vertex].get_or_init(find)
    }

    /// Rows of the matrix that a vertex of the skin depends on, with their weights.
    fn rows(&self, vertex: usize) -> Vec<(usize, f64)> {
        self.given.rows_at(self.place(vertex)).collect()
    }

    /// A vertex of the product that the response at a vertex of the skin depends on and that is not known.
    fn unknown(&self, vertex: usize) -> Option<usize> {
        let corners = self.place(vertex).weights_of_corners().filter(|(_, weight)| *weight > NO_WEIGHT);
        let mut corners = corners.map(|(corner, _)| corner as usize);
        corners.find(|&corner| self.given.nodes().row(corner).is_none())
    }

    /// Mean length of the edges of the product's triangles opposite vertices of the skin (m).
    fn edge_length(&self, vertices: &[usize]) -> f64 {
        let points = self.given.nodes().surface().vertices();
        let around = |&vertex: &usize| {
            let [a, b, c] = self.place(vertex).corners.map(|corner| points[corner as usize]);
            ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0
        };
        vertices.iter().map(around).sum::<f64>() / vertices.len() as f64
    }

    /// Those of several vertices.
    fn rows_of(
        &self,
        vertices: &[usize],
        options: &AssemblyOptions,
    ) -> Result<Vec<Vec<(usize, f64)>>, ResponseError> {
        let mut rows = vec![Vec::new(); vertices.len()];
        fill_items(&mut rows, options, || (), |(), at, rows| *rows = self.rows(vertices[at]))?;
        Ok(rows)
    }
}

impl ElasticSkin for GivenProduct<'_> {
    fn traits(&self, _: &Surface) -> Result<Traits, ResponseError> {
        Ok(Traits::of_matrix(true, false))
    }

    fn is_scalar(&self, _: usize) -> bool {
        true
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.unknown(vertex).is_none()
    }

    fn doubt(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<Option<BodyDoubt>, ResponseError> {
        let weights: Vec<Vec<(usize, f64)>> = asked.nodes.iter().map(|&vertex| self.rows(vertex)).collect();
        let matrix = self.given.response_matrix();
        let moved = |row: usize, column: usize, force: &Vector3<f64>| matrix[(row, column)] * force.norm();
        let sizes: Vec<Vector3<f64>> = forces.iter().map(|force| Vector3::x() * force.norm()).collect();
        let lost = lost_displacement(matrix.nrows(), &weights, &sizes, moved);
        let force_error = FORCE_PER_LOSS * lost / depth;
        Ok(Some(BodyDoubt { force_error, edge_length: self.edge_length(asked.nodes) }))
    }

    fn matrix(&self, asked: &Request, _: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        let mut unknown = asked.nodes.iter().filter_map(|&vertex| Some((vertex, self.unknown(vertex)?)));
        if let Some((vertex, product_vertex)) = unknown.next() {
            let (missing, known) = (1 + unknown.count(), self.given.nodes().list().len());
            return Err(ResponseError::ProductNotKnown { vertex, product_vertex, missing, known });
        }
        // W M Wᵀ
        let matrix = self.given.response_matrix();
        let weights = self.rows_of(asked.nodes, asked.options)?;
        let fill = |(): &mut (), j: usize, entries: &mut [f64]| {
            for (entry, rows) in entries.iter_mut().zip(&weights) {
                let along = |&(row, weight): &(usize, f64)| {
                    let others = weights[j].iter().map(|&(column, other)| other * matrix[(row, column)]);
                    weight * others.sum::<f64>()
                };
                *entry = rows.iter().map(along).sum();
            }
        };
        filled_columns([asked.nodes.len(); 2], asked.options, || (), fill)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        // W (M (Wᵀ f))
        let mut on_product = BTreeMap::new();
        for (rows, force) in self.rows_of(asked.nodes, asked.options)?.into_iter().zip(forces) {
            for (row, weight) in rows {
                *on_product.entry(row).or_insert_with(Vector3::zeros) += weight * force;
            }
        }
        let (columns, pushed): (Vec<usize>, Vec<Vector3<f64>>) = on_product.into_iter().unzip();
        let matrix = self.given.response_matrix();
        let weights = self.rows_of(vertices, asked.options)?;
        let places: Vec<usize> = weights.iter().flatten().map(|&(row, _)| row).collect();
        let moved = displaced_at(&places, |column| matrix.col_as_slice(columns[column]), &pushed);
        let mut moved = moved.into_iter();
        let sum = |rows: &Vec<(usize, f64)>| rows.iter().zip(&mut moved).map(|((_, w), u)| *w * u).sum();
        Ok(weights.iter().map(sum).collect())
    }
}
