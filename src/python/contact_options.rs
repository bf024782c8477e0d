//! Options of a contact.

use super::lcp::method_named;
use crate::contact::ContactOptions;
use pyo3::prelude::*;

/// Options of a contact.
#[pyclass(name = "ContactOptions", module = "quasirigid._core", frozen, get_all)]
pub(super) struct PyContactOptions {
    tolerance: f64,
    target_error: Option<f64>,
    max_nodes: usize,
    gap_tolerance: f64,
    max_linearizations: usize,
    rings: Option<usize>,
    method: String,
    num_threads: Option<usize>,
    memory_limit: Option<usize>,
    search_distance: Option<f64>,
    condition: bool,
    couple_fingers: bool,
    max_growths: usize,
}

#[pymethods]
impl PyContactOptions {
    #[new]
    #[pyo3(signature = (*, tolerance, target_error, max_nodes, gap_tolerance, max_linearizations, rings, method, num_threads, memory_limit, search_distance, condition, couple_fingers, max_growths))]
    #[expect(clippy::too_many_arguments, reason = "a call has the arguments that it has")]
    fn new(
        tolerance: f64,
        target_error: Option<f64>,
        max_nodes: usize,
        gap_tolerance: f64,
        max_linearizations: usize,
        rings: Option<usize>,
        method: String,
        num_threads: Option<usize>,
        memory_limit: Option<usize>,
        search_distance: Option<f64>,
        condition: bool,
        couple_fingers: bool,
        max_growths: usize,
    ) -> Self {
        Self {
            tolerance,
            target_error,
            max_nodes,
            gap_tolerance,
            max_linearizations,
            rings,
            method,
            num_threads,
            memory_limit,
            search_distance,
            condition,
            couple_fingers,
            max_growths,
        }
    }

    /// Those of the crate.
    #[staticmethod]
    fn defaults() -> Self {
        let options = ContactOptions::default();
        Self {
            tolerance: options.tolerance,
            target_error: options.target_error,
            max_nodes: options.max_nodes,
            gap_tolerance: options.gap_tolerance,
            max_linearizations: options.max_linearizations,
            rings: options.rings,
            method: options.method.as_str().into(),
            num_threads: options.num_threads,
            memory_limit: options.memory_limit,
            search_distance: options.search_distance,
            condition: options.condition,
            couple_fingers: options.couple_fingers,
            max_growths: options.max_growths,
        }
    }
}

impl PyContactOptions {
    /// Those of the crate, without an interrupt.
    pub(super) fn to_core(&self) -> PyResult<ContactOptions<'static>> {
        Ok(ContactOptions {
            tolerance: self.tolerance,
            target_error: self.target_error,
            max_nodes: self.max_nodes,
            gap_tolerance: self.gap_tolerance,
            max_linearizations: self.max_linearizations,
            rings: self.rings,
            method: method_named(&self.method)?,
            num_threads: self.num_threads,
            memory_limit: self.memory_limit,
            search_distance: self.search_distance,
            condition: self.condition,
            couple_fingers: self.couple_fingers,
            max_growths: self.max_growths,
            interrupt: None,
        })
    }
}
