//! The contact of a skin with an obstacle at a given place.

use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::solve::{self as equilibrium, Equilibrium};
use crate::contact::error::ContactError;
use crate::contact::figures::accuracy::Accuracy;
use crate::contact::figures::area::contact_areas;
use crate::contact::figures::displacement::{Deformation, deform};
use crate::contact::figures::resultant::{node_pressure, patches, resultant};
use crate::contact::gap::entry::{Travel, WayBack, measure_way_back};
use crate::contact::gap::initial::InitialGaps;
use crate::contact::options::{ContactOptions, Interrupt};
use crate::contact::outcome::{Contact, ContactStatus, Timing};
use crate::contact::report::left_out::{leave_out, note_offsets, note_search, note_solve, note_way_back};
use crate::contact::report::warnings::{penetration_warning, size_warning, thin_wall_warning};
use crate::obstacle::posed::Obstacle;
use crate::response::kernel::skin::Gap;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

/// Default search distance beyond the depth, in mean edge lengths.
const SEARCH_EDGES: f64 = 2.0;

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
        let place = Place {
            obstacle: obstacle.clone(),
            travel: 0.0,
            press: None,
            depth_bound: None,
            timings: Vec::new(),
        };
        solve_in_place(surface, place, skin, options, interrupt)
    })
}

/// Where the obstacle stands and what is known from bringing it there.
pub(super) struct Place {
    pub obstacle: Obstacle,
    /// Way of the obstacle (m).
    pub travel: f64,
    /// The press that brought it there, where one did.
    pub press: Option<Travel>,
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
    let way_back = match place.press {
        Some(travel) if skin.gap() == Gap::Node => {
            measure_way_back(surface, &place.obstacle, &travel, &mut gaps)?
        }
        _ => WayBack::default(),
    };
    clock(&mut timings, "signed_distance", started);
    note_search(&mut left_out, &gaps, surface);
    note_way_back(&mut left_out, way_back);

    let inside = crate::contact::candidate::groups::penetrating(surface, &gaps.distance);
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
    note_offsets(&mut left_out, &moved.offsets);
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
    let mut pressure = node_pressure(surface, skin, &solved.node_force, &active);
    let areas = match (status, skin.gap()) {
        (ContactStatus::Solved, Gap::Weighted) => {
            let gap = solved.gap_around(surface, &place.obstacle, &compliance, &mut gaps)?;
            let areas = contact_areas(surface, &gap, &solved.touching(), &solved.node_force, &active);
            pressure.raise_to_means(surface, &solved.node_force, &areas, &active);
            areas
        }
        _ => surface.vertex_areas().to_vec(),
    };
    let resultant_of = |nodes: &[usize]| {
        resultant(nodes, &solved.node_force, &pressure, &gaps.normal, &areas, deformed.vertices())
    };
    let total = match status {
        ContactStatus::Failed(_) => crate::contact::outcome::Resultant::unknown(),
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
        .chain(thin_wall_warning(way_back.through_walls))
        .chain(penetration_warning(status, skin.gap(), max_penetration_before, max_penetration_after))
        .collect();
    clock(&mut timings, "outcome", started);

    Ok(Contact {
        status,
        resultant: total,
        volume_change: moved.volume_change,
        max_penetration_before,
        max_penetration_after,
        pressure: pressure.at_vertices,
        force_vectors: along_normals(&solved.node_force, &gaps.normal),
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

/// Node forces as vectors; zero where there is none, whatever the normal.
fn along_normals(node_force: &[f64], normals: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let vector = |(force, normal): (&f64, &Vector3<f64>)| match *force {
        0.0 => Vector3::zeros(),
        force => force * normal,
    };
    node_force.iter().zip(normals).map(vector).collect()
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
