//! The response matrix, and what is known of the symmetric part of a matrix.

use super::convert::{MatrixIn, matrix_out, nodes, vectors};
use super::errors::IntoPyErr;
use super::interrupt::{detached, detached_on_thread};
use super::skin::PySkin;
use super::surface::PySurface;
use crate::response::{self, AssemblyOptions};
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

#[pyfunction]
#[pyo3(signature = (surface, skin, nodes, directions, *, tolerance, num_threads))]
pub(super) fn response_matrix<'py>(
    py: Python<'py>,
    surface: &PySurface,
    skin: &PySkin,
    nodes: &Bound<'py, PyAny>,
    directions: Option<&Bound<'py, PyAny>>,
    tolerance: f64,
    num_threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len())?;
    let directions = match directions {
        Some(value) => vectors(value, "directions")?,
        None => nodes.iter().map(|&vertex| -surface.inner.vertex_normals()[vertex]).collect(),
    };
    let assemble = |interrupt: &(dyn Fn() -> bool + Sync)| {
        let options = AssemblyOptions {
            tolerance,
            num_threads,
            interrupt: Some(interrupt),
            ..AssemblyOptions::default()
        };
        skin.elastic().traits(&surface.inner)?;
        skin.elastic().matrix(&surface.inner, &nodes, &directions, &options)
    };
    let matrix = match num_threads {
        None => detached(py, assemble)?,
        Some(_) => detached_on_thread(py, assemble)?,
    };
    Ok(matrix_out(py, &matrix.map_err(IntoPyErr::into_py_err)?))
}

/// Whether the symmetric part of a matrix is positive definite, its extreme eigenvalues and condition number.
#[pyfunction]
#[pyo3(text_signature = "(matrix)")]
pub(super) fn definiteness<'py>(py: Python<'py>, matrix: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    let matrix = MatrixIn::new(matrix, "matrix")?;
    let view = matrix.view();
    if view.nrows() != view.ncols() {
        let message = format!("`matrix` has shape [{}, {}], expected (k, k)", view.nrows(), view.ncols());
        return Err(PyValueError::new_err(message));
    }
    if !view.is_all_finite() {
        return Err(PyValueError::new_err("`matrix` has entries that are not finite"));
    }
    let found = py.detach(|| response::definiteness(view));
    let fields = PyDict::new(py);
    fields.set_item("positive_definite", found.positive_definite)?;
    fields.set_item("smallest", found.smallest)?;
    fields.set_item("largest", found.largest)?;
    fields.set_item("condition", found.condition)?;
    fields.set_item("estimated", found.estimated)?;
    Ok(fields)
}
