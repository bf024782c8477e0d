//! How a contact is solved: options, their defaults, their checks.

use crate::contact::error::ContactError;
use crate::lcp::solution::LcpMethodName;
use crate::lcp::solve::LcpMethod;
use crate::linalg::threads;
use crate::response::error::ResponseError;
use crate::response::matrix::options::{AssemblyOptions, TOLERANCES};

/// Options of [`solve_contact`](crate::contact::solve_contact) and [`press`](crate::contact::press::press).
#[derive(Clone)]
pub struct ContactOptions<'a> {
    /// Largest error of an entry of the response matrix from numerical integration, over the half-space's entry
    /// (dimensionless, 0 ..= 0.1; 0 asks for all that double precision gives).
    pub tolerance: f64,
    /// Relative error of force and area that the mesh may leave, as far as it is estimated (0 < target < 1): the mesh is
    /// refined around the contact until then. `None`: the mesh is taken as it is.
    pub target_error: Option<f64>,
    /// Most contact nodes of a refined mesh.
    pub max_nodes: usize,
    /// Gap that may be left at the deformed skin where it touches, as a share of the deepest penetration before (between 0 and
    /// 1). The forces stand upright on the obstacle there to five times this, in the mean.
    pub gap_tolerance: f64,
    /// Most linear problems that a contact is solved with (≥ 1), each with gaps and normals taken at the skin as the one
    /// before deformed it; 1 takes them at the undeformed skin alone. As many again where skin slipped to steep sides.
    pub max_linearizations: usize,
    /// Rings of neighbours added to the penetrating vertices. `None`: none where the response has no negative
    /// entry (further vertices can never touch), 1 otherwise; what is pressed beyond them is found and added.
    pub rings: Option<usize>,
    /// Solver of the complementarity problem.
    pub method: LcpMethod,
    /// Threads, at most four for each processor; `None`: all that the machine has. Results are the same to the bit for any
    /// number.
    pub num_threads: Option<usize>,
    /// Largest memory for response matrices (bytes); `None`: what the system has free, where it says so.
    pub memory_limit: Option<usize>,
    /// Distance (m) from the obstacle up to which gaps are measured; `None`: depth plus two mean edge lengths, in overlap more
    /// where skin stands deeper.
    pub search_distance: Option<f64>,
    /// Whether to examine definiteness and condition of response matrices of any size; small ones always are.
    pub condition: bool,
    /// Whether a kernel couples patches on different fingers too, through the air between them. `false`: patches feel of
    /// each other what they share of their tissue ([`shared_tissue`](crate::surface::shared_tissue)).
    pub couple_fingers: bool,
    /// How often candidates may be added before the solve gives up (growth ends by itself in a few steps).
    pub max_growths: usize,
    /// Asked now and then, from any thread; `true` ends the work with [`ContactError::Interrupted`].
    pub interrupt: Option<&'a (dyn Fn() -> bool + Sync)>,
}

impl Default for ContactOptions<'_> {
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            target_error: Some(0.02),
            max_nodes: 4000,
            gap_tolerance: 1e-3,
            max_linearizations: 20,
            rings: None,
            method: LcpMethodName::Lemke.into(),
            num_threads: None,
            memory_limit: None,
            search_distance: None,
            condition: false,
            couple_fingers: false,
            max_growths: 50,
            interrupt: None,
        }
    }
}

impl std::fmt::Debug for ContactOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ContactOptions")
            .field("tolerance", &self.tolerance)
            .field("target_error", &self.target_error)
            .field("max_nodes", &self.max_nodes)
            .field("gap_tolerance", &self.gap_tolerance)
            .field("max_linearizations", &self.max_linearizations)
            .field("rings", &self.rings)
            .field("method", &self.method)
            .field("num_threads", &self.num_threads)
            .field("memory_limit", &self.memory_limit)
            .field("search_distance", &self.search_distance)
            .field("condition", &self.condition)
            .field("couple_fingers", &self.couple_fingers)
            .field("max_growths", &self.max_growths)
            .field("interrupt", &self.interrupt.is_some())
            .finish()
    }
}

impl<'a> ContactOptions<'a> {
    /// The defaults, but for the mesh, which is taken as it is.
    pub fn on_given_mesh() -> Self {
        Self { target_error: None, ..Self::default() }
    }

    /// How response matrices are assembled.
    pub(in crate::contact) fn assembly(&self) -> AssemblyOptions<'a> {
        AssemblyOptions {
            tolerance: self.tolerance,
            num_threads: None,
            memory_limit: self.memory_limit,
            interrupt: self.interrupt,
        }
    }

    pub(in crate::contact) fn is_interrupted(&self) -> bool {
        self.interrupt.is_some_and(|interrupt| interrupt())
    }

    /// # Errors
    /// [`ContactError::Interrupted`] if the caller wants the work to end, at `stage`.
    pub(in crate::contact) fn check_interrupt(&self, stage: &'static str) -> Result<(), ContactError> {
        if self.is_interrupted() { Err(ContactError::Interrupted { stage }) } else { Ok(()) }
    }

    /// # Errors
    /// [`ContactError::Option`] naming the option and its value.
    pub(super) fn validate(&self) -> Result<(), ContactError> {
        let fail = |option, value: f64, expected| Err(ContactError::Option { option, value, expected });
        if !TOLERANCES.contains(&self.tolerance) {
            return fail("tolerance", self.tolerance, "a number from 0 to 0.1");
        }
        if let Some(target) = self.target_error
            && !(target > 0.0 && target < 1.0)
        {
            return fail("target_error", target, "a number in (0, 1), or None for the mesh as it is");
        }
        if self.max_nodes == 0 {
            return fail("max_nodes", 0.0, "at least 1");
        }
        if !(self.gap_tolerance > 0.0 && self.gap_tolerance < 1.0) {
            return fail("gap_tolerance", self.gap_tolerance, "a number in (0, 1)");
        }
        if self.max_linearizations == 0 {
            return fail("max_linearizations", 0.0, "at least 1");
        }
        if let Some(distance) = self.search_distance
            && !(distance >= 0.0 && distance.is_finite())
        {
            return fail("search_distance", distance, "a finite length >= 0 (m)");
        }
        if self.num_threads == Some(0) {
            return fail("num_threads", 0.0, "at least 1, or None for all");
        }
        Ok(())
    }
}

/// Runs `work` on as many threads as the options ask for.
pub(crate) fn with_threads<T: Send>(
    options: &ContactOptions,
    work: impl FnOnce() -> Result<T, ContactError> + Send,
) -> Result<T, ContactError> {
    threads::with_threads(options.num_threads, work).map_err(ResponseError::from)?
}
