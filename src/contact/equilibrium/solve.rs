//! Node forces that end all penetration: solve, look at the rest, add what got pressed, repeat.

use std::time::Instant;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::candidate::groups::{loaded_rim, penetrating, uncoupled_groups, with_rings};
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::growth::pressed_outside;
use crate::contact::error::ContactError;
use crate::contact::gap::averaged::WeightedGaps;
use crate::contact::gap::initial::InitialGaps;
use crate::contact::options::{ContactOptions, Interrupt};
use crate::lcp;
use crate::lcp::options::LcpOptions;
use crate::lcp::problem::LcpProblem;
use crate::lcp::solution::{LcpSolution, LcpStatus};
use crate::obstacle::posed::Obstacle;
use crate::response::kernel::skin::Gap;
use crate::response::matrix::definiteness::{Definiteness, definiteness};
use crate::surface::checked::Surface;

/// Rings added to the penetrating vertices where a response has negative entries (Xie, Kanai, Date 2011, §2.5).
const DEFAULT_RINGS: usize = 3;

/// Response matrices up to this size are examined for definiteness and condition unasked: it costs less there
/// than their assembly.
const EXAMINED_SIZE: usize = 64;

/// Solved node forces and what it took to find them.
#[derive(Debug)]
pub(crate) struct Equilibrium {
    /// Vertices in the complementarity problems, ascending.
    pub candidates: Vec<usize>,
    /// Which of them feel each other.
    pub fingers: Fingers,
    /// One solution per uncoupled group of candidates.
    pub solutions: Vec<LcpSolution>,
    /// f (n, N): node forces, zero outside the candidates; NaN on candidates of a problem that did not solve.
    pub node_force: Vec<f64>,
    /// g = g0 + R f on the candidates (n, m), g0 elsewhere.
    pub gap: Vec<f64>,
    /// What is known of each group's response matrix, where it was examined.
    pub definiteness: Vec<Option<Definiteness>>,
    /// First ending other than `Solved`.
    pub failure: Option<LcpStatus>,
    /// Seconds in assembly and in the solver.
    pub response_seconds: f64,
    /// Seconds in the solver.
    pub lcp_seconds: f64,
}

/// Finds the node forces. `gaps` is completed where growth asks for vertices beyond the search distance.
pub(crate) fn solve(
    surface: &Surface,
    obstacle: &Obstacle,
    compliance: &Compliance,
    gaps: &mut InitialGaps,
    options: &ContactOptions,
    interrupt: Interrupt,
) -> Result<Equilibrium, ContactError> {
    let inside = penetrating(surface, &gaps.distance);
    let deepest = inside.iter().map(|&vertex| -gaps.distance[vertex]).fold(0.0, f64::max);
    let grows = compliance.skin.has_negative_entries();
    let rings = options.rings.unwrap_or(if grows { DEFAULT_RINGS } else { 0 });
    // Growth stays among the vertices whose response is known; a penetrating one must be.
    let known = |mut vertices: Vec<usize>| {
        vertices.retain(|&vertex| compliance.skin.knows(vertex) || inside.binary_search(&vertex).is_ok());
        vertices
    };
    let mut weighted =
        (compliance.skin.gap() == Gap::Weighted).then(|| WeightedGaps::new(compliance.skin.pressure()));
    let mut candidates = known(with_rings(surface, &inside, rings.max(usize::from(weighted.is_some()))));
    if let Some(weighted) = &mut weighted {
        // A node's gap is averaged over its triangles: it may be open with its vertex inside, and closed outside.
        weighted.complete(surface, obstacle, gaps, &candidates)?;
        candidates.retain(|&vertex| weighted.average(surface, gaps, vertex) < 0.0);
    }
    let (mut response_seconds, mut lcp_seconds) = (0.0, 0.0);

    for growth in 0.. {
        gaps.complete(surface.vertices(), obstacle, &candidates)?;
        if let Some(weighted) = &mut weighted {
            weighted.complete(surface, obstacle, gaps, &candidates)?;
        }
        let told_apart = compliance.skin.is_kernel() && !options.couple_fingers;
        let mut round = Equilibrium {
            fingers: match told_apart {
                true => Fingers::tell_apart(surface, &candidates),
                false => Fingers::one(&candidates),
            },
            solutions: Vec::new(),
            definiteness: Vec::new(),
            node_force: vec![0.0; surface.vertices().len()],
            gap: gaps.distance.clone(),
            failure: None,
            response_seconds: 0.0,
            lcp_seconds: 0.0,
            candidates,
        };
        for group in uncoupled_groups(surface, &round.fingers, compliance.skin.reach()) {
            let started = Instant::now();
            let response = compliance.square(&group, &gaps.normal)?;
            response_seconds += started.elapsed().as_secs_f64();
            let started = Instant::now();
            let initial_gap = |&vertex: &usize| match &weighted {
                Some(weighted) => weighted.average(surface, gaps, vertex),
                None => gaps.distance[vertex],
            };
            let q: Vec<f64> = group.iter().map(initial_gap).collect();
            let problem = LcpProblem::new(response.as_ref(), &q)?;
            let lcp_options = LcpOptions { interrupt: Some(interrupt), ..LcpOptions::default() };
            let solution = lcp::solve(&problem, options.method, &lcp_options)?;
            lcp_seconds += started.elapsed().as_secs_f64();
            if solution.status == LcpStatus::Interrupted {
                return Err(ContactError::Interrupted { stage: "lcp" });
            }
            let examined = options.condition || group.len() <= EXAMINED_SIZE;
            round.definiteness.push(examined.then(|| definiteness(response.as_ref())));
            round.adopt(&group, solution);
        }
        if weighted.is_some() && round.failure.is_none() {
            round.measure_at_vertices(compliance, gaps)?;
        }
        round.response_seconds = response_seconds;
        round.lcp_seconds = lcp_seconds;
        if round.failure.is_some() || rings == 0 && !grows {
            return Ok(round);
        }
        let started = Instant::now();
        let mut added = loaded_rim(surface, &round.candidates, &round.node_force);
        if grows {
            added.extend(pressed_outside(surface, obstacle, compliance, gaps, &round, deepest)?);
        }
        response_seconds += started.elapsed().as_secs_f64();
        if added.is_empty() {
            return Ok(Equilibrium { response_seconds, ..round });
        }
        if growth == options.max_growths {
            let skin_vertices = surface.skin_mask().iter().filter(|&&may_touch| may_touch).count();
            let candidates = round.candidates.len();
            return Err(ContactError::Growth { growths: growth, candidates, skin_vertices });
        }
        let mut grown = known(with_rings(surface, &added, rings.max(1)));
        grown.extend(&added);
        grown.extend(&round.candidates);
        grown.sort_unstable();
        grown.dedup();
        candidates = grown;
        if interrupt() {
            return Err(ContactError::Interrupted { stage: "candidates" });
        }
    }
    unreachable!("the loop ends by a return")
}

impl Equilibrium {
    /// Skin and obstacle are apart.
    pub fn none(vertex_count: usize, gaps: &InitialGaps) -> Self {
        Self {
            candidates: Vec::new(),
            fingers: Fingers::one(&[]),
            solutions: Vec::new(),
            definiteness: Vec::new(),
            node_force: vec![0.0; vertex_count],
            gap: gaps.distance.clone(),
            failure: None,
            response_seconds: 0.0,
            lcp_seconds: 0.0,
        }
    }

    /// Takes over the solution of one group.
    fn adopt(&mut self, group: &[usize], solution: LcpSolution) {
        let solved = solution.status == LcpStatus::Solved;
        for (node, &vertex) in group.iter().enumerate() {
            self.node_force[vertex] = if solved { solution.z[node] } else { f64::NAN };
            self.gap[vertex] = if solved { solution.w[node] } else { f64::NAN };
        }
        if !solved {
            self.failure.get_or_insert(solution.status);
        }
        self.solutions.push(solution);
    }

    /// Replaces averaged gaps by those of the vertices themselves.
    fn measure_at_vertices(
        &mut self,
        compliance: &Compliance,
        gaps: &InitialGaps,
    ) -> Result<(), ContactError> {
        let active = self.active();
        let rise =
            compliance.rise(&self.fingers, &self.candidates, &active, &self.node_force, &gaps.normal)?;
        for (&vertex, rise) in self.candidates.iter().zip(rise) {
            self.gap[vertex] = gaps.distance[vertex] + rise;
        }
        Ok(())
    }

    /// Gaps (n, m) as solved, measured two rings around the forces where they are no candidates.
    pub fn gap_around(
        &self,
        surface: &Surface,
        obstacle: &Obstacle,
        compliance: &Compliance,
        gaps: &mut InitialGaps,
    ) -> Result<Vec<f64>, ContactError> {
        let active = self.active();
        let mut beside = surface.k_ring(&active, 2);
        beside.retain(|vertex| self.candidates.binary_search(vertex).is_err());
        gaps.complete(surface.vertices(), obstacle, &beside)?;
        let rise = compliance.rise(&self.fingers, &beside, &active, &self.node_force, &gaps.normal)?;
        let mut gap = self.gap.clone();
        for (&vertex, rise) in beside.iter().zip(rise) {
            gap[vertex] = gaps.distance[vertex] + rise;
        }
        Ok(gap)
    }

    /// Which vertices (n) carry force or have a closed gap.
    pub fn touching(&self) -> Vec<bool> {
        let mut touches = vec![false; self.gap.len()];
        for &vertex in &self.candidates {
            touches[vertex] = self.node_force[vertex] > 0.0 || self.gap[vertex] <= 0.0;
        }
        touches
    }

    /// Vertices with f > 0, ascending.
    pub fn active(&self) -> Vec<usize> {
        self.candidates.iter().copied().filter(|&vertex| self.node_force[vertex] > 0.0).collect()
    }
}
