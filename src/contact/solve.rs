//! The contact of a skin with an obstacle at a given place.

use super::compliance::Compliance;
use super::deform::{Deformation, deform};
use super::equilibrium::{self, Equilibrium};
use super::gaps::InitialGaps;
use super::resultant::{node_pressure, patches, resultant};
use super::{Accuracy, Contact, ContactError, ContactOptions, ContactStatus, Interrupt, LeftOut, Timing};
use crate::obstacle::Obstacle;
use crate::response::{ElasticSkin, Gap};
use crate::surface::Surface;
use nalgebra::Vector3;
use std::time::Instant;

/// Default search distance beyond the depth, in mean edge lengths.
const SEARCH_EDGES: f64 = 2.0;

/// Penetration left at the deformed skin, as a share of that before, from which the user is warned.
const UNRESOLVED_SHARE: f64 = 0.05;

/// Skin and obstacle differing in size by this factor suggest that one is in another unit.
const SUSPICIOUS_SIZE_RATIO: f64 = 100.0;

/// Solves the contact of `surface` with `obstacle` where it stands.
///
/// `g = g0 + R f, g ≥ 0, f ≥ 0, g·f = 0` on the candidates (Xie, Kanai, Date 2011, eq. 9); see the crate's root for
/// units and signs. `interrupt` is asked now and then; `true` ends the solve.
///
/// Returns the outcome whatever its [`ContactStatus`]: an ending is no error.
///
/// # Errors
/// [`ContactError`] by variant, for a question that is malformed, too large or interrupted.
pub fn solve_contact(
    surface: &Surface,
    obstacle: &Obstacle,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
    interrupt: Interrupt,
) -> Result<Contact, ContactError> {
    options.validate()?;
    with_threads(options, || {
        let place = Place { obstacle: obstacle.clone(), travel: 0.0, depth_bound: None, timings: Vec::new() };
        solve_in_place(surface, place, skin, options, interrupt)
    })
}

/// Where the obstacle stands and what is known from bringing it there.
pub(super) struct Place {
    pub obstacle: Obstacle,
    /// Way of the obstacle (m).
    pub travel: f64,
    /// A penetration that no skin vertex exceeds (m), where known.
    pub depth_bound: Option<f64>,
    pub timings: Vec<Timing>,
}

/// Runs `work` on as many threads as the options ask for.
pub(super) fn with_threads<T: Send>(
    options: &ContactOptions,
    work: impl FnOnce() -> Result<T, ContactError> + Send,
) -> Result<T, ContactError> {
    match options.num_threads {
        None => work(),
        Some(threads) => match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => pool.install(work),
            Err(_) => Err(ContactError::Option {
                option: "num_threads",
                value: threads as f64,
                expected: "a number of threads that the system can start",
            }),
        },
    }
}

pub(super) fn solve_in_place(
    surface: &Surface,
    place: Place,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
    interrupt: Interrupt,
) -> Result<Contact, ContactError> {
    let mut timings = place.timings;
    if !surface.skin_mask().contains(&true) {
        return Err(ContactError::NoSkin { vertex_count: surface.vertices().len() });
    }
    skin.check_surface(surface)?;
    let mut left_out = Vec::new();
    leave_out(&mut left_out, "product response", "the product is rigid: its displacement under load is zero");

    let started = Instant::now();
    let search_distance = options
        .search_distance
        .unwrap_or(place.depth_bound.unwrap_or(0.0) + SEARCH_EDGES * surface.mean_edge_length());
    let mut gaps =
        InitialGaps::measure(surface.vertices(), &place.obstacle, search_distance, place.depth_bound)?;
    clock(&mut timings, "signed_distance", started);
    note_search(&mut left_out, &gaps, surface);

    let inside = super::candidates::penetrating(surface, &gaps.distance);
    let max_penetration_before = inside.iter().map(|&vertex| -gaps.distance[vertex]).fold(0.0, f64::max);
    let compliance = Compliance::new(surface, skin, options, interrupt);
    let solved = if inside.is_empty() {
        leave_out(&mut left_out, "response matrix", "no skin vertex lies inside the obstacle");
        leave_out(&mut left_out, "complementarity problem", "no skin vertex lies inside the obstacle");
        Equilibrium::none(surface.vertices().len(), &gaps)
    } else {
        let solved =
            equilibrium::solve(surface, &place.obstacle, &compliance, &mut gaps, options, interrupt)?;
        timings.push(Timing { stage: "response", seconds: solved.response_seconds });
        timings.push(Timing { stage: "lcp", seconds: solved.lcp_seconds });
        note_solve(&mut left_out, &compliance, &solved, surface, options);
        solved
    };

    let started = Instant::now();
    let status = match solved.failure {
        Some(ending) => ContactStatus::Failed(ending),
        None if inside.is_empty() => ContactStatus::NoContact,
        None => ContactStatus::Solved,
    };
    let moved = if status == ContactStatus::Solved {
        deform(surface, &compliance, &gaps, &solved)?
    } else {
        Deformation::none(surface.vertices().len())
    };
    let deformed = match status {
        ContactStatus::Solved => surface
            .with_vertices(surface.vertices().iter().zip(&moved.displacement).map(|(x, u)| x + u).collect()),
        _ => surface.clone(),
    };
    let max_penetration_after = match status {
        ContactStatus::Solved => deepest_penetration(
            &deformed,
            &place.obstacle,
            &inside,
            &moved.displacement,
            max_penetration_before,
        )?,
        _ => max_penetration_before,
    };
    let active = solved.active();
    let pressure = node_pressure(surface, skin.pressure(), &solved.node_force, &active);
    let resultant_of = |nodes: &[usize]| {
        let areas = surface.vertex_areas();
        resultant(nodes, &solved.node_force, &pressure, &gaps.normal, areas, deformed.vertices())
    };
    let total = match status {
        ContactStatus::Failed(_) => super::Resultant::unknown(),
        _ => resultant_of(&active),
    };
    let accuracy = Accuracy::new(
        surface,
        &solved.node_force,
        &active,
        total.contact_area,
        options.tolerance,
        &solved.solutions,
        &solved.definiteness,
    );
    let patches = patches(surface, &active, resultant_of);
    let warnings = size_warning(surface, &place.obstacle)
        .into_iter()
        .chain(penetration_warning(status, skin.gap(), max_penetration_before, max_penetration_after))
        .collect();
    clock(&mut timings, "outcome", started);

    Ok(Contact {
        status,
        resultant: total,
        volume_change: moved.volume_change,
        max_penetration_before,
        max_penetration_after,
        pressure,
        node_force: solved.node_force,
        gap: solved.gap,
        displacement: moved.displacement,
        fade_distance: moved.fade_distance,
        candidates: solved.candidates,
        active,
        patches,
        deformed,
        obstacle: place.obstacle,
        travel: place.travel,
        lcp_solutions: solved.solutions,
        accuracy,
        timings,
        left_out,
        warnings,
    })
}

pub(super) fn clock(timings: &mut Vec<Timing>, stage: &'static str, started: Instant) {
    timings.push(Timing { stage, seconds: started.elapsed().as_secs_f64() });
}

fn leave_out(left_out: &mut Vec<LeftOut>, what: &'static str, why: impl Into<String>) {
    left_out.push(LeftOut { what, why: why.into() });
}

fn note_search(left_out: &mut Vec<LeftOut>, gaps: &InitialGaps, surface: &Surface) {
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

fn note_solve(
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
    if solved.solutions.len() > 1 {
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

/// Deepest penetration of a skin vertex that moved or was `inside`, measured anew (m, ≥ 0).
fn deepest_penetration(
    deformed: &Surface,
    obstacle: &Obstacle,
    inside: &[usize],
    displacement: &[Vector3<f64>],
    max_penetration_before: f64,
) -> Result<f64, ContactError> {
    let may_penetrate = |&vertex: &usize| {
        deformed.skin_mask()[vertex]
            && (displacement[vertex] != Vector3::zeros() || inside.binary_search(&vertex).is_ok())
    };
    let points: Vec<Vector3<f64>> =
        (0..displacement.len()).filter(may_penetrate).map(|vertex| deformed.vertices()[vertex]).collect();
    let measured = InitialGaps::measure(&points, obstacle, max_penetration_before, None)?;
    Ok(measured.distance.iter().map(|distance| -distance).fold(0.0, f64::max))
}

/// Says when the obstacle is too finely shaped for the gaps linearised at this depth, or the mesh too coarse for
/// averaged gaps.
fn penetration_warning(status: ContactStatus, gap: Gap, before: f64, after: f64) -> Option<String> {
    let unresolved = status == ContactStatus::Solved && after > UNRESOLVED_SHARE * before;
    let cause = match gap {
        Gap::Node => {
            "the obstacle has features (a thin rim, an edge) no larger than the depth, where gaps along the closest normal do not hold; press less deep or thicken the feature, and do not trust force and area there"
        }
        Gap::Weighted => {
            "gaps are averaged over triangles as large as the features of this contact; refine the mesh there, or take the gap at the nodes"
        }
    };
    unresolved
        .then(|| format!("the deformed skin still penetrates by {after:.3e} m of {before:.3e} m: {cause}"))
}

/// Says when skin and obstacle look as if they were in different units.
fn size_warning(surface: &Surface, obstacle: &Obstacle) -> Option<String> {
    let (low, high) = surface.bounding_box();
    let (obstacle_low, obstacle_high) = obstacle.bounding_box()?;
    let (skin, product) = ((high - low).norm(), (obstacle_high - obstacle_low).norm());
    let ratio = product / skin;
    let suspicious =
        obstacle.kind() == "mesh" && !(1.0 / SUSPICIOUS_SIZE_RATIO..SUSPICIOUS_SIZE_RATIO).contains(&ratio);
    suspicious.then(|| {
        format!(
            "the obstacle's diagonal ({product:.4e} m) is {ratio:.3e} times the skin's ({skin:.4e} m): is one of them in another unit? Lengths are metres; `unit=\"mm\"` converts a file when it is read"
        )
    })
}
