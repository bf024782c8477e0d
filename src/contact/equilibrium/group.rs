//! The complementarity problem of one group of candidates that feels no other.

use std::time::Instant;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::candidate::groups::with_rings;
use crate::contact::discretization::gap_at;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::equilibrium::growth::PRESSED_SHARE;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::ContactOptions;
use crate::contact::report::record::Report;
use crate::lcp::options::{DefinitenessCheck, LcpOptions};
use crate::lcp::problem::LcpProblem;
use crate::lcp::solution::{LcpSolution, LcpStatus};
use crate::lcp::solve as lcp;
use crate::linalg::definiteness::{Definiteness, Spectrum, spectrum_until};
use crate::mesh::distinct::distinct;
use crate::response::kernel::basis::Discretization;

/// Response matrices up to this size are examined for definiteness and condition unasked: it costs less there
/// than their assembly.
const EXAMINED_SIZE: usize = 64;
/// Rings around the vertices that are expected to carry force which enter the problem with them.
pub(super) const EXPECTED_RINGS: usize = 1;
/// Share of a group from which all of it enters at once.
const MOST_OF_A_GROUP: f64 = 0.95;

/// Contact nodes whose problem on a refined mesh single pivots may end: of 3,200 they take a minute.
pub(crate) const MOST_BY_PIVOTS: usize = 1500;
/// Nodes that may change sides from a near guess: so many, or that share of all.
const FEW_CHANGES: usize = 64;
const SHARE_OF_CHANGES: f64 = 0.25;

/// What is expected of a contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Guess<'a> {
    /// Vertices under force, ascending.
    pub active: &'a [usize],
    /// What a problem that is far from it may do.
    pub nearness: Nearness,
    /// The fingers of a contact of the same undeformed skin, where known.
    pub fingers: Option<&'a Fingers>,
}

/// How near a guess is expected to be, and so how much is done for an answer elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Nearness {
    /// Anything: there must be an answer.
    Any,
    /// Most others are under force already; a large problem that block exchanges do not end may go without an answer, since
    /// a coarser mesh has one.
    OfCoarser,
    /// Few others are under force: a problem that is far from it may end without an answer.
    Near,
}

/// What the problems of all groups have in common.
pub(crate) struct GroupProblem<'a> {
    pub gaps: &'a Gaps<'a>,
    pub response: &'a Compliance<'a>,
    pub guess: Option<Guess<'a>>,
    pub options: &'a ContactOptions<'a>,
}

impl GroupProblem<'_> {
    /// Finds the forces of a group and the gaps that they leave.
    ///
    /// Where a guess is good, the vertices far from it stay clear of the obstacle once the others are pushed out. They
    /// enter the problem only where they do not: the answer is that of the whole group.
    pub fn solve(
        &self,
        group: &[usize],
        forces: &mut NodeForces,
        report: &mut Report,
    ) -> Result<(), ContactError> {
        let mut nodes = self.expected(group);
        let mut guess = self.guess.map(|guess| guess.active.to_vec());
        loop {
            let (solution, spectrum) = self.solve_on(&nodes, guess.as_deref(), forces, report)?;
            forces.adopt(&nodes, &solution);
            forces.settle();
            let started = Instant::now();
            let pressed = match solution.status {
                LcpStatus::Solved if nodes.len() < group.len() => self.pressed(group, &nodes, forces)?,
                _ => Vec::new(),
            };
            report.clock("response", started);
            if pressed.is_empty() {
                forces.solutions.push(solution);
                forces.spectra.push(spectrum);
                return Ok(());
            }
            let mut pushed = [&forces.active[..], &pressed].concat();
            pushed.sort_unstable();
            guess = Some(pushed);
            nodes = self.around(group, &pressed, nodes);
        }
    }

    /// The nodes to begin with.
    fn expected(&self, group: &[usize]) -> Vec<usize> {
        let is_refined = self.gaps.scene.inherited.is_some();
        let is_collocation = self.response.traits.discretization == Discretization::Collocation;
        match self.guess {
            Some(guess) if is_refined && is_collocation => self.around(group, guess.active, Vec::new()),
            _ => group.to_vec(),
        }
    }

    /// `known` and those of a group within the expected rings of `nodes`; all of it where few are left out.
    fn around(&self, group: &[usize], nodes: &[usize], known: Vec<usize>) -> Vec<usize> {
        let mut around = with_rings(self.gaps.surface, nodes, EXPECTED_RINGS);
        around.retain(|vertex| group.binary_search(vertex).is_ok());
        around.extend(known);
        let around = distinct(around);
        let is_enough = !around.is_empty() && (around.len() as f64) < MOST_OF_A_GROUP * group.len() as f64;
        if is_enough { around } else { group.to_vec() }
    }

    /// The rest of a group that `forces` leave inside the obstacle; the gaps of all of the rest are noted.
    fn pressed(
        &self,
        group: &[usize],
        nodes: &[usize],
        forces: &mut NodeForces,
    ) -> Result<Vec<usize>, ContactError> {
        let is_rest = |vertex: &usize| nodes.binary_search(vertex).is_err();
        let rest: Vec<usize> = group.iter().copied().filter(is_rest).collect();
        let gap = gap_at(self.gaps, self.response, forces, &rest)?;
        let pressed = -PRESSED_SHARE * self.gaps.deepest();
        for (&vertex, &gap) in rest.iter().zip(&gap) {
            forces.gap[vertex] = gap;
        }
        Ok(rest.into_iter().filter(|&vertex| forces.gap[vertex] < pressed).collect())
    }

    fn solve_on(
        &self,
        nodes: &[usize],
        guess: Option<&[usize]>,
        forces: &NodeForces,
        report: &mut Report,
    ) -> Result<(LcpSolution, Option<Spectrum>), ContactError> {
        let Self { gaps, response, options, .. } = *self;
        let started = Instant::now();
        let normals = gaps.at(nodes)?.normal;
        let matrix = response.matrix(nodes, &normals, forces.applied())?;
        report.clock("response", started);
        let started = Instant::now();
        let q = response.traits.discretization.initial_gap(gaps, response, nodes)?;
        report.clock("signed_distance", started);
        let is_examined = options.condition || nodes.len() <= EXAMINED_SIZE;
        let started = Instant::now();
        let is_interrupted = || options.is_interrupted();
        let spectrum = is_examined.then(|| spectrum_until(matrix.as_ref(), &is_interrupted));
        let definiteness = spectrum.map_or(Definiteness::Unknown, |spectrum| spectrum.definiteness);
        // What fingers feel of each other may change with the candidates.
        let kept = response.kept_factors(&normals).filter(|_| forces.fingers.coupling.extremes()[1] == 0.0);
        let problem = LcpProblem::new(matrix.as_ref(), &q)?
            .with_known_definiteness(definiteness)
            .with_kept_factors(kept, nodes);
        let is_guessed = |guess: &[usize]| {
            (0..nodes.len()).filter(|&node| guess.binary_search(&nodes[node]).is_ok()).collect()
        };
        let nearness = self.guess.map_or(Nearness::Any, |guess| guess.nearness);
        let is_near = nearness == Nearness::Near;
        let lcp_options = LcpOptions {
            interrupt: options.interrupt,
            exchanges_only: is_near || nearness == Nearness::OfCoarser && nodes.len() > MOST_BY_PIVOTS,
            initial_active: guess.map(is_guessed),
            max_pivots: is_near.then(|| most_changes(nodes.len())),
            // A factor of all nodes costs more than the solve that begins from a good guess.
            definiteness: if is_examined { DefinitenessCheck::Cheap } else { DefinitenessCheck::Never },
            ..LcpOptions::default()
        };
        let solution = lcp::solve(&problem, &options.method, &lcp_options)?;
        report.clock("lcp", started);
        if solution.status == LcpStatus::Interrupted {
            return Err(ContactError::Interrupted { stage: "lcp" });
        }
        Ok((solution, spectrum))
    }
}

/// Pivots from a near guess.
fn most_changes(nodes: usize) -> usize {
    FEW_CHANGES.max((SHARE_OF_CHANGES * nodes as f64) as usize)
}
