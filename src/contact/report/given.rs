//! Compliances that somebody else computed or measured: their unit, and whether they fit their nodes.

use std::f64::consts::PI;

use crate::contact::gap::deepest::DeepestVertex;
use crate::contact::outcome::Contact;
use crate::contact::report::guards::{Guarded, MODULI, is_within};
use crate::contact::report::warning::{Warning, WarningKind};
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::Request;

impl Guarded<'_> {
    /// Of a given matrix, which has no modulus.
    pub(super) fn given_compliance(&self, contact: &Contact) -> Option<Warning> {
        let DeepestVertex { vertex, normal, .. } = contact.clues.deepest?;
        if self.skin.shear_modulus_at(vertex).is_some() {
            return None;
        }
        let options = AssemblyOptions::default();
        let asked = Request { surface: self.surface, nodes: &[vertex], options: &options };
        let own = self.skin.matrix(&asked, &[normal]).ok()?[(0, 0)];
        // A hat as a cone of pressure on a disc moves the middle of an incompressible half-space by √(3π/S) / (4πG) per newton.
        let modulus = (3.0 * PI / self.surface.vertex_areas()[vertex]).sqrt() / (4.0 * PI * own);
        (!is_within(modulus, MODULI)).then(|| Warning {
            kind: WarningKind::Modulus,
            message: format!(
                "the given compliance is {own:.4e} m/N at vertex {vertex}, as of a half-space of {modulus:.4e} Pa, outside the {:.0e} to {:.0e} Pa of tissue: is it in another unit? 1 mm/N is 1e-3 m/N",
                MODULI[0], MODULI[1]
            ),
        })
    }
}

/// Of what speaks against a given compliance.
///
/// * `of`: skin or product
pub(super) fn misfit(found: Option<&str>, of: &str) -> Option<Warning> {
    let found = found?;
    let kind = WarningKind::ResponseRange;
    Some(Warning { kind, message: format!("the compliance given for the {of} {found}") })
}
