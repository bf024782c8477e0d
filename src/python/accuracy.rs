//! `_core.Accuracy` and `_core.Refinement`: how far the figures of a contact can be trusted.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::contact::{Accuracy, Refinement, RefinementEnd};
use crate::python::arrays_out::{read_only, vector_out};

/// How far the figures of a contact can be trusted.
#[pyclass(name = "Accuracy", module = "quasirigid._core", frozen, get_all)]
pub(super) struct PyAccuracy {
    natural_residual: f64,
    complementarity: f64,
    integration_tolerance: f64,
    discretization: &'static str,
    condition: Option<f64>,
    definite: Option<bool>,
    cells_per_radius: f64,
    force_error: Option<f64>,
    mesh_error: Option<f64>,
    body_error: Option<f64>,
    area_error: Option<f64>,
    max_pressure_error: Option<f64>,
}

impl From<&Accuracy> for PyAccuracy {
    fn from(accuracy: &Accuracy) -> Self {
        Self {
            natural_residual: accuracy.natural_residual,
            complementarity: accuracy.complementarity,
            integration_tolerance: accuracy.integration_tolerance,
            discretization: accuracy.discretization.as_str(),
            condition: accuracy.condition,
            definite: accuracy.definite,
            cells_per_radius: accuracy.cells_per_radius,
            force_error: accuracy.force_error,
            mesh_error: accuracy.mesh_error,
            body_error: accuracy.body_error,
            area_error: accuracy.area_error,
            max_pressure_error: accuracy.max_pressure_error,
        }
    }
}

/// What one mesh gave, or one linear problem on the way there.
#[pyclass(name = "Refinement", module = "quasirigid._core", frozen, get_all)]
pub(super) struct PyRefinement {
    kind: &'static str,
    nodes: usize,
    force: Py<PyArray1<f64>>,
    contact_area: Option<f64>,
    max_pressure: Option<f64>,
    force_error: Option<f64>,
    area_error: Option<f64>,
    max_penetration: f64,
    seconds: f64,
    reason: &'static str,
}

impl PyRefinement {
    pub fn new(py: Python<'_>, round: &Refinement) -> PyResult<Py<Self>> {
        let values = Self {
            kind: round.kind.as_str(),
            nodes: round.nodes,
            force: read_only(vector_out(py, &round.force)),
            contact_area: round.contact_area,
            max_pressure: round.max_pressure,
            force_error: round.force_error,
            area_error: round.area_error,
            max_penetration: round.max_penetration,
            seconds: round.seconds,
            reason: round.end.map_or("", RefinementEnd::as_str),
        };
        Py::new(py, values)
    }
}
