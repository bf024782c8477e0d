//! Resultants of a contact and of its patches.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::contact::{Patch, Resultant};
use crate::python::arrays_out::{nodes_out, read_only, vector_out};

/// Force (N), moment (N m), center (m), area (m²) and peak (Pa) of a contact or of one of its patches.
#[pyclass(name = "Resultant", module = "quasirigid._core", frozen, get_all)]
pub(super) struct PyResultant {
    force: Py<PyArray1<f64>>,
    moment: Py<PyArray1<f64>>,
    center_of_pressure: Py<PyArray1<f64>>,
    contact_area: f64,
    max_pressure: f64,
    mean_pressure: f64,
}

impl PyResultant {
    pub(super) fn new(py: Python<'_>, resultant: &Resultant) -> PyResult<Py<Self>> {
        let values = Self {
            force: read_only(vector_out(py, &resultant.force)),
            moment: read_only(vector_out(py, &resultant.moment)),
            center_of_pressure: read_only(vector_out(py, &resultant.center_of_pressure)),
            contact_area: resultant.contact_area,
            max_pressure: resultant.max_pressure,
            mean_pressure: resultant.mean_pressure,
        };
        Py::new(py, values)
    }
}

/// Vertices and resultant of a patch.
pub(super) type PyPatch = (Py<PyArray1<i64>>, Py<PyResultant>);

pub(super) fn patches_out(py: Python<'_>, patches: &[Patch]) -> PyResult<Vec<PyPatch>> {
    let patch = |patch: &Patch| {
        Ok((read_only(nodes_out(py, &patch.vertices)), PyResultant::new(py, &patch.resultant)?))
    };
    patches.iter().map(patch).collect()
}
