//! The response as the pipeline uses it: a square matrix over candidates, displacement anywhere under forces.

use std::f64::consts::FRAC_1_SQRT_2;
use std::rc::Rc;
use std::sync::Arc;

use faer::Mat;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::equilibrium::product::product_response;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::ContactOptions;
use crate::geometry::direction::are_one;
use crate::linalg::block_factor::KeptFactors;
use crate::linalg::columns::par_columns;
use crate::response::body::levels::coarseness::BodyDoubt;
use crate::response::error::ResponseError;
use crate::response::matrix::options::{AssemblyOptions, check_memory};
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::response::skin::kept::{KeptMatrices, KeptSkin};
use crate::surface::checked::Surface;

/// Relative quadrature tolerance of displacements that are drawn and summed to a volume but enter no complementarity.
const DRAWN_TOLERANCE: f64 = 1e-3;
/// Cosine below which two normals are opposed: the faces of a square edge are not, whichever way they are turned.
const OPPOSED_COSINE: f64 = -1e-9;

/// Forces, and which vertices feel them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AppliedForces<'a> {
    /// Each moves the vertices nearest to it along the skin.
    pub fingers: &'a Fingers,
    /// The parts that feel each other through the product.
    pub on_product: &'a Fingers,
    /// Vertices with a force, ascending.
    pub active: &'a [usize],
    /// Force on the skin at every vertex (n, N).
    pub vectors: &'a [Vector3<f64>],
}

/// The response of a skin on its surface, and of the product that it meets.
pub(crate) struct Compliance<'a> {
    surface: &'a Surface,
    pub skin: &'a dyn ElasticSkin,
    /// `None` of a rigid product.
    product: Option<Rc<Product<'a>>>,
    /// Of both together.
    pub traits: Traits,
    options: AssemblyOptions<'a>,
}

/// The response of a product, as if it were a skin.
struct Product<'a> {
    response: Rc<dyn ElasticSkin + 'a>,
    /// Whether it knows what passes from one side to another, as a matrix does.
    has_all_sides: bool,
    /// What is kept of a kernel where that of the skin is.
    kept: Option<Arc<KeptMatrices>>,
}

impl<'a> Product<'a> {
    /// A product that meets a skin.
    fn of(response: Rc<dyn ElasticSkin + 'a>, has_all_sides: bool, skin: &dyn ElasticSkin) -> Rc<Self> {
        let is_kept = !has_all_sides && skin.kept_factors().is_some();
        Rc::new(Self { response, has_all_sides, kept: is_kept.then(Arc::default) })
    }

    /// Asks the response, or what is kept of it.
    fn ask<T>(&self, ask: impl FnOnce(&dyn ElasticSkin) -> T) -> T {
        match &self.kept {
            Some(kept) => ask(&KeptSkin::with(&*self.response, Arc::clone(kept))),
            None => ask(&*self.response),
        }
    }
}

impl<'a> Compliance<'a> {
    /// A skin against a rigid product.
    pub fn new(
        surface: &'a Surface,
        skin: &'a dyn ElasticSkin,
        traits: Traits,
        options: &ContactOptions<'a>,
    ) -> Self {
        Self { surface, skin, product: None, traits, options: options.assembly() }
    }

    /// The same against the product of `gaps`.
    pub fn with_product(mut self, gaps: &Gaps<'a>) -> Result<Self, ContactError> {
        self.traits.negative_entries |= are_opposed(&gaps.at(&gaps.penetrating)?.normal);
        if let Some(material) = gaps.scene.obstacle.material() {
            let response = product_response(material, gaps, &self.traits)?;
            self.product = Some(Product::of(response.into(), material.kernel().is_none(), self.skin));
            self.traits = self.traits.with_product(Some(material));
        }
        Ok(self)
    }

    /// What answers for a product that gives way, at the skin's vertices.
    pub fn product(&self) -> Option<&dyn ElasticSkin> {
        self.product.as_ref().map(|product| &*product.response as &dyn ElasticSkin)
    }

    /// The same with another skin of the same answers.
    pub fn with_skin<'b>(&self, skin: &'b dyn ElasticSkin) -> Compliance<'b>
    where
        'a: 'b,
    {
        let Self { surface, product, traits, options, .. } = self;
        let of_skin = |product: &Rc<Product<'b>>| {
            Product::of(Rc::clone(&product.response), product.has_all_sides, skin)
        };
        Compliance {
            surface,
            skin,
            product: product.as_ref().map(of_skin),
            traits: *traits,
            options: *options,
        }
    }

    /// Whether the product gives way.
    pub fn has_product(&self) -> bool {
        self.product.is_some()
    }

    /// The parts of the candidates that feel each other through the product; all in one of a rigid product.
    ///
    /// * `normals`: of the product at the candidates
    pub fn on_product(&self, candidates: &[usize], normals: &[Vector3<f64>]) -> Fingers {
        match &self.product {
            Some(product) if !product.has_all_sides => Fingers::on_solid(self.surface, candidates, normals),
            _ => Fingers::one(candidates),
        }
    }

    /// Whether the response to a force at `vertex` is known.
    pub fn is_prepared(&self, vertex: usize) -> bool {
        let of_product = self.product.as_ref().is_none_or(|product| product.response.is_prepared(vertex));
        of_product && self.skin.is_prepared(vertex)
    }

    /// R over `nodes` along the obstacle's normals there (k × k, m/N).
    ///
    /// * `forces`: with the parts between which skin and product pass less on, or nothing
    pub fn matrix(
        &self,
        nodes: &[usize],
        normals: &[Vector3<f64>],
        forces: AppliedForces,
    ) -> Result<Mat<f64>, ContactError> {
        // R of the skin and of the product stand beside each other.
        let side_by_side = if self.has_product() { 2 } else { 1 };
        check_memory(nodes.len(), side_by_side * nodes.len(), &self.options)?;
        let asked = Request { surface: self.surface, nodes, options: &self.options };
        let mut matrix = along(self.skin, &asked, normals)?;
        forces.fingers.weaken(nodes, &mut matrix);
        if let Some(product) = &self.product {
            let mut of_product = product.ask(|response| along(response, &asked, normals))?;
            forces.on_product.weaken(nodes, &mut of_product);
            matrix += of_product;
        }
        Ok(matrix)
    }

    /// Factors of blocks of one matrix that those of all nodes with such normals are blocks of; `None` where there is no
    /// such, or it is not kept.
    pub fn kept_factors(&self, normals: &[Vector3<f64>]) -> Option<&KeptFactors> {
        let is_plane = are_one(normals);
        let is_one = is_plane
            && self.traits.is_kernel
            && self.product.is_none()
            && self.options.memory_limit.is_none();
        self.skin.kept_factors().filter(|_| is_one)
    }

    /// What the meshes that a body was solved on and that a product's matrix is given on cost a contact of so many m in
    /// depth with `forces` (N) at `nodes`; `None` of others, and without forces.
    pub fn doubts(
        &self,
        nodes: &[usize],
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<[Option<BodyDoubt>; 2], ContactError> {
        if nodes.is_empty() {
            return Ok([None; 2]);
        }
        let asked = Request { surface: self.surface, nodes, options: &self.options };
        let of_product = self.product.as_ref().map(|product| product.response.doubt(&asked, forces, depth));
        Ok([self.skin.doubt(&asked, forces, depth)?, of_product.transpose()?.flatten()])
    }

    /// Displacement of `vertices` against the product, each under the forces of its own finger, to the tolerance of R
    /// itself: `u_H - u_P`, that of the skin alone against a rigid product.
    pub fn displace(
        &self,
        forces: AppliedForces,
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ContactError> {
        self.displace_to(&self.options, forces, vertices)
    }

    /// The same to no more than [`DRAWN_TOLERANCE`].
    pub fn displace_coarsely(
        &self,
        forces: AppliedForces,
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ContactError> {
        let tolerance = self.options.tolerance.max(DRAWN_TOLERANCE);
        self.displace_to(&AssemblyOptions { tolerance, ..self.options }, forces, vertices)
    }

    /// Displacement `-u_P` opposite `vertices`, to the tolerance of R itself; `None` of a rigid product.
    pub fn displace_product(
        &self,
        forces: AppliedForces,
        vertices: &[usize],
    ) -> Result<Option<Vec<Vector3<f64>>>, ContactError> {
        let of_product = |product| self.product_under(product, &self.options, forces, vertices);
        self.product.as_deref().map(of_product).transpose()
    }

    fn displace_to(
        &self,
        options: &AssemblyOptions,
        forces: AppliedForces,
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ContactError> {
        let mut moved = self.under(self.skin, forces.fingers, options, forces, vertices)?;
        if let Some(product) = &self.product {
            let of_product = self.product_under(product, options, forces, vertices)?;
            moved.iter_mut().zip(of_product).for_each(|(moved, product)| *moved += product);
        }
        Ok(moved)
    }

    fn product_under(
        &self,
        product: &Product,
        options: &AssemblyOptions,
        forces: AppliedForces,
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ContactError> {
        product.ask(|response| self.under(response, forces.on_product, options, forces, vertices))
    }

    fn under(
        &self,
        moving: &dyn ElasticSkin,
        fingers: &Fingers,
        options: &AssemblyOptions,
        forces: AppliedForces,
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ContactError> {
        let under = |active: &[usize], pushed: &[Vector3<f64>], vertices: &[usize]| {
            let asked = Request { surface: self.surface, nodes: active, options };
            moving.displace(&asked, pushed, vertices)
        };
        if fingers.candidates.len() == 1 {
            let pushed: Vec<Vector3<f64>> =
                forces.active.iter().map(|&vertex| forces.vectors[vertex]).collect();
            return Ok(under(forces.active, &pushed, vertices)?);
        }
        let mut all = vec![Vector3::zeros(); vertices.len()];
        for finger in 0..fingers.candidates.len() {
            let is_own = |vertex: usize| fingers.finger_of(vertex) == Some(finger);
            let rows: Vec<usize> = (0..vertices.len()).filter(|&row| is_own(vertices[row])).collect();
            let own: Vec<usize> = rows.iter().map(|&row| vertices[row]).collect();
            let felt = |vertex: usize| {
                fingers.finger_of(vertex).map_or(0.0, |other| fingers.coupling.between(finger, other))
            };
            let (active, pushed): (Vec<usize>, Vec<Vector3<f64>>) = (forces.active.iter())
                .map(|&vertex| (vertex, felt(vertex) * forces.vectors[vertex]))
                .filter(|(_, force)| *force != Vector3::zeros())
                .unzip();
            let moved = under(&active, &pushed, &own)?;
            rows.into_iter().zip(moved).for_each(|(row, vector)| all[row] = vector);
        }
        Ok(all)
    }
}

/// Whether some of these normals meet at more than a right angle: a force along one pulls the skin towards the other.
fn are_opposed(normals: &[Vector3<f64>]) -> bool {
    let mean = normals.iter().sum::<Vector3<f64>>().normalize();
    // Within 45 degrees of one direction no two do.
    !normals.iter().all(|normal| normal.dot(&mean) >= FRAC_1_SQRT_2)
        && normals.iter().enumerate().any(|(at, a)| normals[..at].iter().any(|b| a.dot(b) < OPPOSED_COSINE))
}

/// R of a skin over the nodes along normals: a scalar response moves the skin along the force, by `R_ij n_i . n_j` along n_i.
fn along(
    skin: &dyn ElasticSkin,
    asked: &Request,
    normals: &[Vector3<f64>],
) -> Result<Mat<f64>, ResponseError> {
    let mut matrix = skin.matrix(asked, normals)?;
    let is_scalar: Vec<bool> = asked.nodes.iter().map(|&vertex| skin.is_scalar(vertex)).collect();
    let scale = |((column, normal), is_own_scalar): ((&mut [f64], &Vector3<f64>), &bool)| {
        if !is_own_scalar {
            return;
        }
        let rows = column.iter_mut().zip(normals).zip(&is_scalar);
        rows.for_each(|((entry, other), is_scalar)| {
            *entry *= if *is_scalar { other.dot(normal) } else { 1.0 }
        });
    };
    par_columns(&mut matrix).zip(normals).zip(&is_scalar).for_each(scale);
    Ok(matrix)
}
