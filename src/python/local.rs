//! `quasirigid.LocalResponseMatrix` as the core keeps it.

use super::convert::{matrix_out, nodes, nodes_out, scalars};
use super::errors::IntoPyErr;
use super::interrupt::{detached, detached_on_thread};
use super::skin::PySkin;
use super::surface::PySurface;
use crate::response::{LocalMatrix, LocalOptions, assemble_local};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A response matrix of a kernel that fades, in blocks.
#[pyclass(name = "LocalMatrix", module = "quasirigid._core", frozen)]
pub(super) struct PyLocalMatrix {
    inner: LocalMatrix,
}

impl PyLocalMatrix {
    fn forces(&self, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
        let forces = scalars(value, "forces")?;
        if forces.len() == self.inner.order() {
            return Ok(forces);
        }
        let (found, expected) = (forces.len(), self.inner.order());
        Err(PyValueError::new_err(format!("`forces` has {found} entries, expected {expected}, one per node")))
    }
}

#[pymethods]
impl PyLocalMatrix {
    #[getter]
    fn order(&self) -> usize {
        self.inner.order()
    }

    #[getter]
    fn entries(&self) -> usize {
        self.inner.entries()
    }

    #[getter]
    fn nbytes(&self) -> usize {
        self.inner.bytes()
    }

    /// R f (m).
    fn apply<'py>(&self, py: Python<'py>, forces: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let forces = self.forces(forces)?;
        Ok(PyArray1::from_vec(py, py.detach(|| self.inner.apply(&forces))))
    }

    /// R' f (m).
    fn apply_transposed<'py>(
        &self,
        py: Python<'py>,
        forces: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let forces = self.forces(forces)?;
        Ok(PyArray1::from_vec(py, py.detach(|| self.inner.apply_transposed(&forces))))
    }

    /// The dense matrix.
    fn to_dense<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix_out(py, &py.detach(|| self.inner.to_dense()))
    }

    /// Diagonal entries.
    fn diagonal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.inner.diagonal())
    }

    /// Positions in the list of nodes that are coupled, group by group.
    fn groups<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<i64>>> {
        let groups = py.detach(|| self.inner.groups());
        groups.iter().map(|group| nodes_out(py, group)).collect()
    }

    /// What is known of the symmetric part.
    fn definiteness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = py.detach(|| self.inner.definiteness());
        let fields = PyDict::new(py);
        fields.set_item("positive_definite", found.positive_definite)?;
        fields.set_item("decided", found.decided)?;
        fields.set_item("smallest", found.smallest)?;
        fields.set_item("largest", found.largest)?;
        fields.set_item("condition", found.condition)?;
        fields.set_item("margin", found.margin)?;
        fields.set_item("advice", found.advice(&self.inner))?;
        Ok(fields)
    }
}

#[pyfunction]
#[pyo3(signature = (surface, skin, nodes, *, threshold, tolerance, num_threads, memory_limit))]
#[expect(clippy::too_many_arguments, reason = "a call has the arguments that it has")]
pub(super) fn local_response_matrix(
    py: Python<'_>,
    surface: &PySurface,
    skin: &PySkin,
    nodes: &Bound<'_, PyAny>,
    threshold: f64,
    tolerance: Option<f64>,
    num_threads: Option<usize>,
    memory_limit: Option<usize>,
) -> PyResult<PyLocalMatrix> {
    let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len())?;
    let skin = skin.computed()?;
    let assemble = |interrupt: &(dyn Fn() -> bool + Sync)| {
        let options =
            LocalOptions { threshold, tolerance, num_threads, memory_limit, interrupt: Some(interrupt) };
        assemble_local(&surface.inner, skin, &nodes, &options)
    };
    let matrix = match num_threads {
        None => detached(py, assemble)?,
        Some(_) => detached_on_thread(py, assemble)?,
    };
    Ok(PyLocalMatrix { inner: matrix.map_err(IntoPyErr::into_py_err)? })
}
