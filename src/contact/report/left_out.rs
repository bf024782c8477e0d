//! What a scene did not need, and why.

use crate::contact::candidate::fingers::Fingers;
use crate::contact::candidate::ways::Way;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::ContactOptions;
use crate::contact::report::record::Report;
use crate::surface::shortest_paths::{LONGEST_DETOUR, SHORT_DETOUR};

pub(crate) const FAR_VERTICES: &str = "exact distance of far vertices";
pub(crate) const MASKED_VERTICES: &str = "masked vertices";
const FINGER_COUPLING: &str = "coupling between fingers";

impl Report {
    /// What the measurement of gaps left out.
    pub fn note_gaps(&mut self, gaps: &Gaps) {
        if gaps.scene.obstacle.material().is_none() {
            self.leave_out("product response", "the product is rigid: its displacement under load is zero");
        }
        let vertex_count = gaps.surface.vertices().len();
        let beyond = gaps.undeformed().iter().filter(|distance| distance.is_infinite()).count();
        if beyond > 0 {
            let limit = gaps.search_distance;
            let why = format!(
                "{beyond} of {vertex_count} vertices are farther from the obstacle than {limit:.3e} m"
            );
            self.leave_out(FAR_VERTICES, why);
        }
        let masked = gaps.surface.skin_mask().iter().filter(|&&may_touch| !may_touch).count();
        if masked > 0 {
            let why = format!("the skin mask keeps {masked} vertices out of contact");
            self.leave_out(MASKED_VERTICES, why);
        }
        let entered = gaps.entry.vertices;
        if entered > 0 {
            let why = format!(
                "{entered} vertices came in through another side of the obstacle than their closest one: their gap is the way back"
            );
            self.leave_out("gap along the closest normal", why);
        }
        if gaps.penetrating.is_empty() {
            let why = "no skin vertex lies inside the obstacle";
            self.leave_out("response matrix", why);
            self.leave_out("complementarity problem", why);
        }
    }

    /// What the solve left out.
    pub fn note_forces(
        &mut self,
        gaps: &Gaps,
        response: &Compliance,
        forces: &NodeForces,
        options: &ContactOptions,
    ) {
        let rest = gaps.surface.vertices().len() - forces.candidates.len();
        if !response.traits.negative_entries && options.rings.is_none() {
            let why = "the response has no negative entry, so vertices outside can never touch";
            self.leave_out("growth of the candidates", why);
        }
        if rest > 0 {
            let why = format!("only the {} candidates are assembled", forces.candidates.len());
            self.leave_out("response of the remaining vertices", why);
        }
        let has_no_end = |&vertex: &usize| {
            let kernel = response.skin.kernel_at(vertex);
            kernel.is_some_and(|kernel| kernel.layer_at(vertex).is_none())
        };
        if forces.active.iter().any(has_no_end) {
            let why =
                "the response is that of tissue without end, too soft over a bone: a layer or a body has one";
            self.leave_out("bone", why);
        }
        let of_product = gaps.scene.obstacle.material().and_then(|material| material.kernel());
        if of_product.is_some_and(|kernel| kernel.layer_at(0).is_none()) {
            let why = "the response is that of a product without end: how thick it is, how it bends and where it is held, a layer or a given matrix knows";
            self.leave_out("thickness of the product", why);
        }
        let fingers = forces.fingers.candidates.len();
        if fingers > 1 {
            self.leave_out(FINGER_COUPLING, apart(&forces.fingers, response));
        }
        if forces.on_product.candidates.len() > 1 {
            let why = "patches on sides of the product that face away from each other feel nothing of each other through it, as a half-space has one side";
            self.leave_out("coupling through the product", why);
        }
        if forces.solutions.len() > forces.fingers.coupling.groups().len() {
            let why = format!(
                "the response does not reach from one to another: {} separate problems",
                forces.solutions.len()
            );
            self.leave_out("coupling between groups of candidates", why);
        }
        if options.tolerance > 0.0 {
            let why = format!(
                "quadrature keeps every entry within {:.0e} of the half-space's, K/r",
                options.tolerance
            );
            self.leave_out("exact integrals of far pairs", why);
        }
    }
}

/// Why the fingers do not feel all of each other.
fn apart(fingers: &Fingers, response: &Compliance) -> String {
    let [least, largest] = fingers.coupling.extremes();
    let way = match fingers.parting {
        None => String::new(),
        Some(way) if way.along_skin.is_infinite() => {
            ": no way along the skin leads from one to another".into()
        }
        Some(Way { along_skin, straight, ends: [a, b] }) => {
            let detour = if least > 0.0 { SHORT_DETOUR } else { LONGEST_DETOUR };
            format!(
                ": between vertices {a} and {b} the way along the skin is {along_skin:.3e} m against {straight:.3e} m in a straight line, more than {detour} times"
            )
        }
    };
    let how = match response.has_product() {
        _ if largest > 0.0 => {
            let [least, largest] = [least, largest].map(|share| 100.0 * share);
            format!("part of their tissue and pass on {least:.0} to {largest:.0} % of the response")
        }
        true => "no tissue, joined by the product alone".into(),
        _ => "no tissue, each a problem of its own".into(),
    };
    format!(
        "the candidates lie on {} parts of the skin that share {how}{way}; `couple_fingers` joins them",
        fingers.candidates.len()
    )
}
