//! The vertices under force, from which the figures of any part of a contact are summed.

use faer::Mat;
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::contact::figures::loaded::{LoadedVertex, LoadedVertices};
use crate::python::arrays_out::{matrix_out, nodes_out};
use crate::python::convert::{MatrixArgument, mask, number};
use crate::python::errors::{ContactError as PyContactError, IntoPyErr};
use crate::python::resultant::{PyPatch, PyResultant, patches_out};

/// Numbers of a vertex, its given vertex and its patch; their figures in SI; vertices of the given mesh and of the one that
/// was solved; whether the contact solved.
type Stored<'py> = ([Bound<'py, PyArray1<i64>>; 3], Bound<'py, PyArray2<f64>>, [usize; 2], bool);

/// All vertices under force.
#[pyclass(name = "LoadedVertices", module = "quasirigid._core", frozen)]
pub(super) struct PyLoadedVertices {
    inner: LoadedVertices,
}

impl From<LoadedVertices> for PyLoadedVertices {
    fn from(inner: LoadedVertices) -> Self {
        Self { inner }
    }
}

/// Figures of a vertex in the order that they are stored in.
fn figures(one: &LoadedVertex) -> [f64; 12] {
    let [p, d, f] = [one.position, one.deformed, one.force];
    [p.x, p.y, p.z, d.x, d.y, d.z, f.x, f.y, f.z, one.node_force, one.contact_area, one.peak_pressure]
}

#[pymethods]
impl PyLoadedVertices {
    /// What `__reduce__` returned.
    #[new]
    fn new(
        numbers: [PyReadonlyArray1<'_, i64>; 3],
        figures: &Bound<'_, PyAny>,
        vertex_counts: [usize; 2],
        is_known: bool,
    ) -> PyResult<Self> {
        let figures = MatrixArgument::new(figures, "figures", PyContactError::new_err)?;
        let figures = figures.view();
        let [vertex, given_vertex, patch] = &numbers;
        let count = figures.nrows();
        if figures.ncols() != 12 || numbers.iter().any(|list| list.as_array().len() != count) {
            return Err(PyContactError::new_err("these are no loaded vertices"));
        }
        let at = |list: &PyReadonlyArray1<'_, i64>, row| {
            let number = list.as_array()[row];
            usize::try_from(number)
                .map_err(|_| PyContactError::new_err(format!("{number} numbers no vertex under force")))
        };
        let loaded = |row: usize| {
            let vector = |first| Vector3::from_fn(|axis, _| figures[(row, first + axis)]);
            let one = LoadedVertex {
                vertex: at(vertex, row)?,
                given_vertex: at(given_vertex, row)?,
                patch: at(patch, row)?,
                position: vector(0),
                deformed: vector(3),
                force: vector(6),
                node_force: figures[(row, 9)],
                contact_area: figures[(row, 10)],
                peak_pressure: figures[(row, 11)],
            };
            if one.given_vertex >= vertex_counts[0] || one.vertex >= vertex_counts[1] {
                let message = format!("vertex {} of {} carries force", one.vertex, vertex_counts[1]);
                return Err(PyContactError::new_err(message));
            }
            Ok(one)
        };
        let list = (0..count).map(loaded).collect::<PyResult<_>>()?;
        Ok(Self { inner: LoadedVertices { list, vertex_counts, is_known } })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, Stored<'py>) {
        let LoadedVertices { list, vertex_counts, is_known } = &self.inner;
        let numbers =
            |number: fn(&LoadedVertex) -> usize| nodes_out(py, &list.iter().map(number).collect::<Vec<_>>());
        let numbers = [numbers(|one| one.vertex), numbers(|one| one.given_vertex), numbers(|one| one.patch)];
        let rows: Vec<[f64; 12]> = list.iter().map(figures).collect();
        let figures = matrix_out(py, &Mat::from_fn(rows.len(), 12, |row, column| rows[row][column]));
        (py.get_type::<Self>(), (numbers, figures, *vertex_counts, *is_known))
    }

    /// Largest mean pressure (Pa) over a disc of `area` (m²).
    fn mean_pressure(&self, area: &Bound<'_, PyAny>) -> PyResult<f64> {
        self.inner.mean_pressure(number(area, "area")?).map_err(IntoPyErr::into_py_err)
    }

    /// Resultant and patches of the vertices where `mask` is true.
    fn part(&self, py: Python<'_>, mask: &Bound<'_, PyAny>) -> PyResult<(Py<PyResultant>, Vec<PyPatch>)> {
        let mask = self::mask(mask, "mask")?;
        let part = self.inner.part(&mask).map_err(IntoPyErr::into_py_err)?;
        Ok((PyResultant::new(py, &part.resultant)?, patches_out(py, &part.patches)?))
    }
}
