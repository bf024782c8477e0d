//! Bodies of parts of a skin: cutting them out, joining them with a kernel, and what their bones feel.

use super::convert::{mask, vector};
use super::errors::{IntoPyErr, ResponseError, SurfaceError};
use super::skin::PySkin;
use super::surface::PySurface;
use crate::response::{CombinedSkin, Part};
use crate::surface::{self, CutOutError};
use numpy::PyArray1;
use pyo3::prelude::*;

/// A part of a skin: its surface, fixed vertices, and the vertex numbers both ways (-1 for none).
type CutOutParts<'py> =
    (PySurface, Bound<'py, PyArray1<bool>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>);

fn numbers_out<'py>(py: Python<'py>, numbers: &[Option<usize>]) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_vec(py, numbers.iter().map(|number| number.map_or(-1, |n| n as i64)).collect())
}

/// The part of a surface around a vertex in front of a plane, closed.
#[pyfunction]
#[pyo3(signature = (surface, tip, point, normal))]
pub(super) fn cut_out<'py>(
    py: Python<'py>,
    surface: &PySurface,
    tip: usize,
    point: &Bound<'py, PyAny>,
    normal: &Bound<'py, PyAny>,
) -> PyResult<CutOutParts<'py>> {
    let (point, normal) = (vector(point, "point")?, vector(normal, "normal")?);
    let part = py.detach(|| surface::cut_out(&surface.inner, tip, &point, &normal));
    let part = part.map_err(|error| match error {
        CutOutError::Surface(error) => error.into_py_err(),
        other => SurfaceError::new_err(other.to_string()),
    })?;
    // What was no skin before is none now, and neither is the cut.
    let may_touch = |(source, fixed): (&Option<usize>, &bool)| {
        !fixed && source.is_some_and(|vertex| surface.inner.skin_mask()[vertex])
    };
    let skin_mask = part.source_vertices.iter().zip(&part.fixed).map(may_touch).collect();
    let cut = part.surface.with_skin_mask(skin_mask).map_err(IntoPyErr::into_py_err)?;
    Ok((
        cut.into(),
        PyArray1::from_slice(py, &part.fixed),
        numbers_out(py, &part.source_vertices),
        numbers_out(py, &part.part_vertices),
    ))
}

/// A part of a combined skin: name, prepared body, vertex of the part for each of the whole (-1 for none), and the
/// part's fixed vertices.
pub(super) type PartIn<'py> = (String, Bound<'py, PySkin>, Vec<i64>, Bound<'py, PyAny>);

pub(super) fn combined(
    surface: &PySurface,
    elsewhere: &PySkin,
    parts: Vec<PartIn<'_>>,
) -> PyResult<CombinedSkin> {
    let made = parts.into_iter().map(|(name, prepared, part_vertices, fixed)| {
        Ok(Part {
            prepared: prepared.get().body_part(&name)?.clone(),
            name,
            part_vertices: part_vertices.into_iter().map(|own| usize::try_from(own).ok()).collect(),
            fixed: mask(&fixed, "fixed")?,
        })
    });
    let parts = made.collect::<PyResult<Vec<Part>>>()?;
    CombinedSkin::new(&surface.inner, elsewhere.kernel()?.clone(), parts)
        .map_err(|error| ResponseError::new_err(error.to_string()))
}
