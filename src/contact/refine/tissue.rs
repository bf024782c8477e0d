//! The tissue under the forces of a contact, and what a mesh loses where it is thin.

use crate::contact::figures::area::cells::mean_edge;
use crate::contact::outcome::Contact;
use crate::response::kernel::basis::Discretization;
use crate::response::kernel::skin::KernelSkin;
use crate::response::skin::elastic::ElasticSkin;

/// Error of force and peak of hats on an incompressible layer, over them, where edges are as long as the layer is thick: it goes
/// with the square of edge over thickness. Fitted to the Galerkin form.
const LOST_SHARE: f64 = 0.025;
/// How that ends where tissue is compressible, as the layer gives way like springs there: with twice the shear modulus over
/// that of a layer which cannot widen, (1 - 2 ν) / (1 - ν) (Johnson 1985, §5.8); fitted to ν of 0.45 and 0.495.
const SPRING_RATIO: f64 = 5.0;

/// Tissue under the forces of a contact on a given mesh.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Tissue {
    /// Mean thickness (m) where there is bone or a layer, in the skin or on the product.
    pub thickness: Option<f64>,
    /// Share of force and peak pressure that hats wider than a layer lose in collocation.
    pub lost: f64,
}

impl Tissue {
    pub fn under(contact: &Contact, skin: &dyn ElasticSkin) -> Self {
        let product = contact.obstacle.material().and_then(|material| material.kernel());
        let of_product = product.and_then(|kernel| kernel.layer_at(0));
        let known = contact.active.iter().filter_map(|&vertex| skin.tissue_at(vertex));
        let of_skin = mean(known.map(|thickness| (thickness, 1.0)));
        let thickness = [of_skin, of_product].into_iter().flatten().reduce(f64::min);
        if contact.accuracy.discretization == Discretization::Galerkin {
            return Self { thickness, lost: 0.0 };
        }
        let edge = mean_edge(contact.surface(), &contact.active);
        let at = |kernel: &KernelSkin, vertex: usize| {
            let (cells, nu) = (edge / kernel.layer_at(vertex)?, kernel.poisson_ratio());
            let cells = cells * cells;
            Some(LOST_SHARE * cells / (1.0 + SPRING_RATIO * (1.0 - 2.0 * nu) / (1.0 - nu) * cells))
        };
        let loaded = contact.active.iter().map(|&vertex| {
            let of_skin = skin.kernel_at(vertex).and_then(|kernel| at(kernel, vertex));
            (of_skin.unwrap_or(0.0), contact.node_force[vertex])
        });
        let of_skin = mean(loaded).unwrap_or(0.0);
        let of_product = product.and_then(|kernel| at(kernel, 0)).unwrap_or(0.0);
        let share = contact.obstacle_share.unwrap_or(0.0);
        Self { thickness, lost: (1.0 - share) * of_skin + share * of_product }
    }
}

/// Mean of values with weights; `None` of nothing.
fn mean(values: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (sum, weight) =
        values.fold((0.0, 0.0), |(sum, total), (value, weight)| (sum + value * weight, total + weight));
    (weight > 0.0).then(|| sum / weight)
}
