//! The response matrix, and what is known of the symmetric part of a matrix.

use numpy::PyArray2;
use pyo3::prelude::*;

use crate::linalg::definiteness::spectrum_until;
use crate::linalg::factor::Interrupt;
use crate::python::arrays_out::matrix_out;
use crate::python::convert::{MatrixArgument, nodes, shape_message, vectors};
use crate::python::errors::{IntoPyErr, ResponseError};
use crate::python::interrupt::detached_with;
use crate::python::skin::PySkin;
use crate::python::surface::PySurface;
use crate::response::matrix::options::check_memory;
use crate::response::{AssemblyOptions, Request};

#[pyfunction]
#[pyo3(signature = (surface, skin, nodes, *, directions, tolerance, num_threads))]
pub(super) fn response_matrix<'py>(
    py: Python<'py>,
    surface: &PySurface,
    skin: &PySkin,
    nodes: &Bound<'py, PyAny>,
    directions: Option<&Bound<'py, PyAny>>,
    tolerance: f64,
    num_threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
    let directions = match directions {
        Some(value) => vectors(value, "directions")?,
        None => nodes.iter().map(|&vertex| -surface.inner.vertex_normals()[vertex]).collect(),
    };
    let assemble = |interrupt: Interrupt| {
        let options = AssemblyOptions {
            tolerance,
            num_threads,
            interrupt: Some(interrupt),
            ..AssemblyOptions::default()
        };
        skin.elastic().traits(&surface.inner)?;
        // The array that is handed over is a copy by rows.
        check_memory(nodes.len(), 2 * nodes.len(), &options)?;
        let asked = Request { surface: &surface.inner, nodes: &nodes, options: &options };
        skin.elastic().matrix(&asked, &directions)
    };
    let matrix = detached_with(py, num_threads, assemble)?;
    Ok(matrix_out(py, &matrix.map_err(IntoPyErr::into_py_err)?))
}

/// What is known of the symmetric part of a matrix.
#[pyclass(name = "Definiteness", module = "quasirigid._core", frozen, get_all)]
pub(super) struct PyDefiniteness {
    positive_definite: bool,
    smallest: f64,
    largest: f64,
    condition: f64,
    estimated: bool,
}

/// Whether the symmetric part of a matrix is positive definite, its extreme eigenvalues and condition number.
#[pyfunction]
#[pyo3(text_signature = "(matrix)")]
pub(super) fn definiteness(py: Python<'_>, matrix: &Bound<'_, PyAny>) -> PyResult<PyDefiniteness> {
    let matrix = MatrixArgument::new(matrix, "matrix", ResponseError::new_err)?;
    let view = matrix.view();
    if view.nrows() != view.ncols() {
        let shape = [view.nrows(), view.ncols()];
        return Err(ResponseError::new_err(shape_message("matrix", "(k, k)", &shape)));
    }
    if !view.is_all_finite() {
        return Err(ResponseError::new_err("`matrix` has entries that are not finite"));
    }
    let found = detached_with(py, None, |interrupt| spectrum_until(view, interrupt))?;
    Ok(PyDefiniteness {
        positive_definite: found.is_positive_definite(),
        smallest: found.smallest,
        largest: found.largest,
        condition: found.condition,
        estimated: found.estimated,
    })
}
