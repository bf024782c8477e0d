//! Options of a contact.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contact::ContactOptions;
use crate::python::lcp::method_named;

/// Options of a contact, without an interrupt; their defaults are the crate's.
#[pyclass(name = "ContactOptions", module = "quasirigid._core", frozen)]
pub(super) struct PyContactOptions(pub ContactOptions<'static>);

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
        method: &str,
        num_threads: Option<usize>,
        memory_limit: Option<usize>,
        search_distance: Option<f64>,
        condition: bool,
        couple_fingers: bool,
        max_growths: usize,
    ) -> PyResult<Self> {
        Ok(Self(ContactOptions {
            tolerance,
            target_error,
            max_nodes,
            gap_tolerance,
            max_linearizations,
            rings,
            method: method_named(method)?.into(),
            num_threads,
            memory_limit,
            search_distance,
            condition,
            couple_fingers,
            max_growths,
            interrupt: None,
        }))
    }

    /// The crate's defaults by name.
    #[staticmethod]
    fn defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let options = ContactOptions::default();
        let defaults = PyDict::new(py);
        defaults.set_item("tolerance", options.tolerance)?;
        defaults.set_item("target_error", options.target_error)?;
        defaults.set_item("max_nodes", options.max_nodes)?;
        defaults.set_item("gap_tolerance", options.gap_tolerance)?;
        defaults.set_item("max_linearizations", options.max_linearizations)?;
        defaults.set_item("rings", options.rings)?;
        defaults.set_item("method", options.method.as_str())?;
        defaults.set_item("num_threads", options.num_threads)?;
        defaults.set_item("memory_limit", options.memory_limit)?;
        defaults.set_item("search_distance", options.search_distance)?;
        defaults.set_item("condition", options.condition)?;
        defaults.set_item("couple_fingers", options.couple_fingers)?;
        defaults.set_item("max_growths", options.max_growths)?;
        Ok(defaults)
    }

    #[getter]
    fn num_threads(&self) -> Option<usize> {
        self.0.num_threads
    }
}
