//! `solve_contact` and `press`.

use super::convert::{nodes_out, vector, vector_out, vectors_out};
use super::errors::IntoPyErr;
use super::interrupt::{detached, detached_on_thread};
use super::lcp::{PyLcpSolution, method_named};
use super::obstacle::PyObstacle;
use super::skin::PySkin;
use super::surface::PySurface;
use crate::contact::{self, Contact, ContactError, ContactOptions, Press, Resultant, Start};
use crate::response::ElasticSkin;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Options of a contact; their defaults are the crate's.
#[pyclass(name = "ContactOptions", module = "quasirigid._core", frozen)]
pub(super) struct PyContactOptions {
    inner: ContactOptions,
}

#[pymethods]
impl PyContactOptions {
    #[new]
    #[pyo3(signature = (*, tolerance, rings, method, num_threads, memory_limit, search_distance, condition, couple_fingers, max_growths))]
    #[expect(clippy::too_many_arguments, reason = "a call has the arguments that it has")]
    fn new(
        tolerance: f64,
        rings: Option<usize>,
        method: &str,
        num_threads: Option<usize>,
        memory_limit: Option<usize>,
        search_distance: Option<f64>,
        condition: bool,
        couple_fingers: bool,
        max_growths: usize,
    ) -> PyResult<Self> {
        let method = method_named(method)?;
        let inner = ContactOptions {
            tolerance,
            rings,
            method,
            num_threads,
            memory_limit,
            search_distance,
            condition,
            couple_fingers,
            max_growths,
        };
        Ok(Self { inner })
    }

    /// The crate's defaults by name.
    #[staticmethod]
    fn defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let ContactOptions {
            tolerance,
            rings,
            method,
            num_threads,
            memory_limit,
            search_distance,
            condition,
            couple_fingers,
            max_growths,
        } = ContactOptions::default();
        let defaults = PyDict::new(py);
        defaults.set_item("tolerance", tolerance)?;
        defaults.set_item("rings", rings)?;
        defaults.set_item("method", method.as_str())?;
        defaults.set_item("num_threads", num_threads)?;
        defaults.set_item("memory_limit", memory_limit)?;
        defaults.set_item("search_distance", search_distance)?;
        defaults.set_item("condition", condition)?;
        defaults.set_item("couple_fingers", couple_fingers)?;
        defaults.set_item("max_growths", max_growths)?;
        Ok(defaults)
    }
}

/// What the crate returns for a contact, read field by field by the facade.
#[pyclass(name = "Contact", module = "quasirigid._core", frozen)]
pub(super) struct PyContact {
    inner: Contact,
    /// What it was solved with, for the drawn skin.
    skin: Py<PySkin>,
    options: ContactOptions,
}

fn resultant_out<'py>(py: Python<'py>, resultant: &Resultant) -> PyResult<Bound<'py, PyDict>> {
    let fields = PyDict::new(py);
    fields.set_item("force", vector_out(py, &resultant.force))?;
    fields.set_item("moment", vector_out(py, &resultant.moment))?;
    fields.set_item("center_of_pressure", vector_out(py, &resultant.center_of_pressure))?;
    fields.set_item("contact_area", resultant.contact_area)?;
    fields.set_item("max_pressure", resultant.max_pressure)?;
    Ok(fields)
}

#[pymethods]
impl PyContact {
    /// Scalars, vectors and arrays by the names of the facade's `Contact`.
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let contact = &self.inner;
        let fields = resultant_out(py, &contact.resultant)?;
        fields.set_item("status", contact.status.as_str())?;
        fields.set_item("advice", contact.advice())?;
        fields.set_item("max_penetration_before", contact.max_penetration_before)?;
        fields.set_item("max_penetration_after", contact.max_penetration_after)?;
        fields.set_item("travel", contact.travel)?;
        fields.set_item("natural_residual", contact.accuracy.natural_residual)?;
        for (name, values) in
            [("pressure", &contact.pressure), ("node_force", &contact.node_force), ("gap", &contact.gap)]
        {
            fields.set_item(name, PyArray1::from_slice(py, values))?;
        }
        fields.set_item("force_vectors", vectors_out(py, &contact.force_vectors))?;
        fields.set_item("candidates", nodes_out(py, &contact.candidates))?;
        fields.set_item("active", nodes_out(py, &contact.active))?;
        fields.set_item("warnings", contact.warnings.clone())?;
        let timings = PyDict::new(py);
        for timing in &contact.timings {
            timings.set_item(timing.stage, timing.seconds)?;
        }
        fields.set_item("timings", timings)?;
        let left_out: Vec<(&str, &str)> =
            contact.left_out.iter().map(|left_out| (left_out.what, left_out.why.as_str())).collect();
        fields.set_item("left_out", left_out)?;
        Ok(fields)
    }

    /// One dictionary per connected part of the active set.
    fn patches<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let fields_of = |patch: &contact::Patch| {
            let fields = resultant_out(py, &patch.resultant)?;
            fields.set_item("vertices", nodes_out(py, &patch.vertices))?;
            Ok(fields)
        };
        self.inner.patches.iter().map(fields_of).collect()
    }

    /// The figures of `Accuracy`.
    fn accuracy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let accuracy = &self.inner.accuracy;
        let fields = PyDict::new(py);
        fields.set_item("natural_residual", accuracy.natural_residual)?;
        fields.set_item("complementarity", accuracy.complementarity)?;
        fields.set_item("integration_tolerance", accuracy.integration_tolerance)?;
        fields.set_item("condition", accuracy.condition)?;
        fields.set_item("definite", accuracy.definite)?;
        fields.set_item("cells_per_radius", accuracy.cells_per_radius)?;
        fields.set_item("area_resolution", accuracy.area_resolution)?;
        Ok(fields)
    }

    /// The drawn skin, computed now: displacement (n, 3), fade distance (m), volume change (m^3), deformed surface.
    fn drawn<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray2<f64>>, f64, f64, PySurface)> {
        let skin = self.skin.get().elastic();
        let drawn = detached(py, |interrupt| self.inner.drawn_skin(skin, &self.options, interrupt))?;
        let drawn = drawn.map_err(IntoPyErr::into_py_err)?;
        let displacement = vectors_out(py, &drawn.displacement);
        Ok((displacement, drawn.fade_distance, drawn.volume_change, drawn.deformed.into()))
    }

    fn obstacle(&self) -> PyObstacle {
        self.inner.obstacle.clone().into()
    }

    fn lcp_solutions(&self) -> Vec<PyLcpSolution> {
        self.inner.lcp_solutions.iter().cloned().map(PyLcpSolution::from).collect()
    }
}

/// Runs a solve with the interpreter released and Ctrl-C heard.
fn run(
    skin: &Bound<'_, PySkin>,
    options: &PyContactOptions,
    solve: impl FnOnce(&dyn ElasticSkin, contact::Interrupt) -> Result<Contact, ContactError> + Send,
) -> PyResult<PyContact> {
    let (py, elastic) = (skin.py(), skin.get().elastic());
    let result = match options.inner.num_threads {
        None => detached(py, |interrupt| solve(elastic, interrupt))?,
        Some(_) => detached_on_thread(py, |interrupt| solve(elastic, interrupt))?,
    };
    let inner = result.map_err(IntoPyErr::into_py_err)?;
    Ok(PyContact { inner, skin: skin.clone().unbind(), options: options.inner.clone() })
}

#[pyfunction]
pub(super) fn solve_contact(
    surface: &PySurface,
    obstacle: &PyObstacle,
    skin: &Bound<'_, PySkin>,
    options: &PyContactOptions,
) -> PyResult<PyContact> {
    run(skin, options, |skin, interrupt| {
        contact::solve_contact(&surface.inner, &obstacle.inner, skin, &options.inner, interrupt)
    })
}

#[pyfunction]
#[pyo3(signature = (surface, obstacle, skin, direction, *, depth, start, options))]
pub(super) fn press(
    surface: &PySurface,
    obstacle: &PyObstacle,
    skin: &Bound<'_, PySkin>,
    direction: &Bound<'_, PyAny>,
    depth: f64,
    start: &str,
    options: &PyContactOptions,
) -> PyResult<PyContact> {
    let start = match start {
        "infinity" => Start::Infinity,
        "current" => Start::Current,
        other => {
            let message = format!("start is {other:?}, expected \"infinity\" or \"current\"");
            return Err(PyValueError::new_err(message));
        }
    };
    let press = Press { direction: vector(direction, "direction")?, depth, start };
    run(skin, options, |skin, interrupt| {
        contact::press(&surface.inner, &obstacle.inner, skin, &press, &options.inner, interrupt)
    })
}
