//! What the facets of a product's mesh do to the peak pressure.
//!
//! Where facets meet, a product is a ridge or a tip, however blunt: the pressure there has no end as the cells of the skin get
//! smaller, and is not that of the smooth product that the mesh stands for.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::contact::outcome::Contact;

/// The cells' size over that for which the peak is still covered, as a logarithm: of cells a quarter as large.
const SMALLER_CELLS: f64 = 2.0 * std::f64::consts::LN_2;
/// Share of the peak from which another may outgrow it.
const NEAR_PEAK: f64 = 0.8;
/// Fewest nodes that are worth a task of their own.
const NODES_PER_TASK: usize = 64;

impl Contact {
    /// What facets of the product add to the error of the peak pressure, relative to it, and the least that this is at creases of
    /// the skin: a peak on facets stands out by these.
    ///
    /// * `shear_modulus`: of the skin (Pa)
    pub(crate) fn errors_of_peak(&self, shear_modulus: Option<f64>) -> [f64; 2] {
        let at_facets = self.growth_at_facets(shear_modulus);
        [at_facets, if at_facets > 0.0 { 0.0 } else { self.peak_at_creases() }]
    }

    /// What smaller cells may add to the peak pressure at the facets of the product, over it. Of a contact on a refined part:
    /// the whole surface is not made for this.
    ///
    /// * `shear_modulus`: of the skin (Pa)
    fn growth_at_facets(&self, shear_modulus: Option<f64>) -> f64 {
        let (surface, peak) = (self.surface(), self.resultant.max_pressure);
        let growth = |(&vertex, moved): (&usize, &Vector3<f64>)| {
            let reach = surface.vertex_areas()[vertex].sqrt();
            let is_high = self.pressure[vertex] >= NEAR_PEAK * peak;
            if is_high {
                self.obstacle.facet_growth(&(surface.vertices()[vertex] + moved), reach)
            } else {
                0.0
            }
        };
        let nodes = self.candidates.par_iter().zip(&self.drawing.motion.displacement);
        let steepest = nodes.with_min_len(NODES_PER_TASK).map(growth).reduce(|| 0.0, f64::max);
        // E* of tissue that keeps its volume, with a product that gives way too.
        let modulus = 4.0 * shear_modulus.unwrap_or(0.0) * (1.0 - self.obstacle_share.unwrap_or(0.0));
        if steepest > 0.0 { SMALLER_CELLS * modulus * steepest / peak } else { 0.0 }
    }
}
