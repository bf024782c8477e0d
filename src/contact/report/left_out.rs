//! What a scene did not need, and why.

use crate::contact::candidate::fingers::Fingers;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::solve::Equilibrium;
use crate::contact::figures::volume::VolumeOffset;
use crate::contact::gap::entry::WayBack;
use crate::contact::gap::initial::InitialGaps;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::LeftOut;
use crate::surface::checked::Surface;
use crate::surface::geodesic::LONGEST_DETOUR;

pub(crate) fn leave_out(left_out: &mut Vec<LeftOut>, what: &'static str, why: impl Into<String>) {
    left_out.push(LeftOut { what, why: why.into() });
}

/// What the measurement of gaps left out.
pub(crate) fn note_search(left_out: &mut Vec<LeftOut>, gaps: &InitialGaps, surface: &Surface) {
    let beyond = gaps.distance.iter().filter(|distance| distance.is_infinite()).count();
    if beyond > 0 {
        let why = format!(
            "{beyond} of {} vertices are farther from the obstacle than {:.3e} m",
            surface.vertices().len(),
            gaps.search_distance
        );
        leave_out(left_out, "exact distance of far vertices", why);
    }
    let masked = surface.skin_mask().iter().filter(|&&may_touch| !may_touch).count();
    if masked > 0 {
        leave_out(
            left_out,
            "masked vertices",
            format!("the skin mask keeps {masked} vertices out of contact"),
        );
    }
}

/// Where the travel took the place of the closest point.
pub(crate) fn note_way_back(left_out: &mut Vec<LeftOut>, way_back: WayBack) {
    if way_back.vertices > 0 {
        let why = format!(
            "{} vertices came in through another side of the obstacle than their closest one: their gap is the way back along the press",
            way_back.vertices
        );
        leave_out(left_out, "gap along the closest normal", why);
    }
}

/// What the solve left out.
pub(crate) fn note_solve(
    left_out: &mut Vec<LeftOut>,
    compliance: &Compliance,
    solved: &Equilibrium,
    surface: &Surface,
    options: &ContactOptions,
) {
    let rest = surface.vertices().len() - solved.candidates.len();
    if !compliance.skin.has_negative_entries() && options.rings.is_none() {
        let why =
            format!("the response has no negative entry, so the {rest} vertices outside can never touch");
        leave_out(left_out, "growth of the candidates", why);
    }
    if rest > 0 {
        let why = format!("only the {} candidates are assembled", solved.candidates.len());
        leave_out(left_out, "response of the remaining vertices", why);
    }
    let fingers = solved.fingers.candidates.len();
    if fingers > 1 {
        leave_out(left_out, "coupling between fingers", apart(&solved.fingers));
    }
    if solved.solutions.len() > fingers {
        let why = format!(
            "the response does not reach from one to another: {} separate problems",
            solved.solutions.len()
        );
        leave_out(left_out, "coupling between groups of candidates", why);
    }
    if options.tolerance > 0.0 {
        let why = format!("quadrature keeps every entry within {:.0e} relative", options.tolerance);
        leave_out(left_out, "exact integrals of far pairs", why);
    }
}

/// Why the fingers are solved apart.
fn apart(fingers: &Fingers) -> String {
    let way = match fingers.ways.first() {
        None => "no way along the skin leads from one to another".into(),
        Some((_, way)) => format!(
            "the shortest way along the skin from one to another, between vertices {} and {}, is {:.3e} m against {:.3e} m in a straight line, more than {LONGEST_DETOUR} times",
            way.ends[0], way.ends[1], way.along_skin, way.straight
        ),
    };
    format!(
        "the candidates lie on {} parts of the skin that share no tissue, each a problem of its own: {way}; `couple_fingers` joins them",
        fingers.candidates.len()
    )
}

/// Says what the drawn skin was moved by beyond its linear displacement.
pub(crate) fn note_offsets(left_out: &mut Vec<LeftOut>, offsets: &[VolumeOffset]) {
    for offset in offsets {
        let why = format!(
            "linear elasticity leaves it open: the mesh moved linearly would miss {:.1e} m^3, and the free skin is \
             moved by up to {:.1e} m to take that up",
            offset.missed, offset.largest
        );
        leave_out(left_out, "second order of a body's volume", why);
    }
}
