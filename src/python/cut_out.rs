//! Parts of a skin, cut out for a body of their own.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::python::arrays_out::{numbers_out, read_only};
use crate::python::convert::{mask, vector};
use crate::python::errors::{IntoPyErr, SurfaceError};
use crate::python::forked::released;
use crate::python::surface::PySurface;
use crate::surface::{self, CutOut, CutOutError};

/// A part of a skin: its surface, fixed vertices, and the vertex numbers both ways (-1 for none).
type CutOutParts = (PySurface, Py<PyArray1<bool>>, Py<PyArray1<i64>>, Py<PyArray1<i64>>);

/// The part of a surface around a vertex in front of a plane, closed.
#[pyfunction]
#[pyo3(signature = (surface, tip, point, normal))]
pub(super) fn cut_out(
    py: Python<'_>,
    surface: &PySurface,
    tip: usize,
    point: &Bound<'_, PyAny>,
    normal: &Bound<'_, PyAny>,
) -> PyResult<CutOutParts> {
    let (point, normal) = (vector(point, "point")?, vector(normal, "normal")?);
    parts_out(released(py, || surface::cut_out(&surface.inner, tip, &point, &normal)), py)
}

/// The part of a surface that a mask marks, closed.
#[pyfunction]
#[pyo3(signature = (surface, keep))]
pub(super) fn cut_out_marked(
    py: Python<'_>,
    surface: &PySurface,
    keep: &Bound<'_, PyAny>,
) -> PyResult<CutOutParts> {
    let keep = mask(keep, "keep")?;
    parts_out(released(py, || surface::cut_out_marked(&surface.inner, &keep)), py)
}

fn parts_out(part: Result<CutOut, CutOutError>, py: Python<'_>) -> PyResult<CutOutParts> {
    let part = part.map_err(|error| match error {
        CutOutError::Surface(error) => error.into_py_err(),
        other => SurfaceError::new_err(other.to_string()),
    })?;
    Ok((
        part.surface.into(),
        read_only(PyArray1::from_slice(py, &part.fixed)),
        read_only(numbers_out(py, &part.source_vertices)),
        read_only(numbers_out(py, &part.part_vertices)),
    ))
}
