//! What works on raw vertices and faces.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::geometry::bounds::is_within_range;
use crate::mesh::RepairOptions;
use crate::python::arrays_out::{faces_out, numbers_out, pairs_out, vectors_out};
use crate::python::convert::{faces as faces_in, vectors};
use crate::python::errors::SurfaceError;
use crate::python::forked::released;

/// Pairs of faces (k, 2) that cross beyond what they share.
#[pyfunction]
#[pyo3(signature = (vertices, faces))]
pub(super) fn find_crossings<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let vertices = vectors(vertices, "vertices")?;
    let faces = faces_in(faces, "faces", SurfaceError::new_err)?;
    let count = vertices.len();
    if let Some(vertex) = faces.iter().flatten().find(|&&vertex| vertex as usize >= count) {
        return Err(SurfaceError::new_err(format!("a face refers to vertex {vertex} of {count}")));
    }
    if let Some(vertex) = vertices.iter().position(|point| !is_within_range(point)) {
        let point = vertices[vertex];
        return Err(SurfaceError::new_err(format!(
            "vertex {vertex} is at ({:e}, {:e}, {:e}) m, expected finite coordinates within 1e60 m",
            point.x, point.y, point.z
        )));
    }
    let pairs = released(py, || crate::geometry::find_crossings(&vertices, &faces));
    Ok(pairs_out(py, &pairs))
}

/// Repairs raw vertices and faces; returns vertices, faces, vertex map (-1: dropped) and a report.
#[pyfunction]
#[pyo3(signature = (vertices, faces, *, weld_tolerance), text_signature = "(vertices, faces, *, weld_tolerance)")]
#[expect(clippy::type_complexity, reason = "a tuple for the facade to name")]
pub(super) fn repair<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    weld_tolerance: f64,
) -> PyResult<(
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyDict>,
)> {
    let vertices = vectors(vertices, "vertices")?;
    let faces = faces_in(faces, "faces", SurfaceError::new_err)?;
    let repaired = released(py, || crate::mesh::repair(&vertices, &faces, &RepairOptions { weld_tolerance }))
        .map_err(|error| SurfaceError::new_err(error.to_string()))?;
    let report = PyDict::new(py);
    let counts = &repaired.report;
    report.set_item("welded_vertices", counts.welded_vertices)?;
    report.set_item("collapsed_faces", counts.collapsed_faces)?;
    report.set_item("zero_area_faces", counts.zero_area_faces)?;
    report.set_item("duplicate_faces", counts.duplicate_faces)?;
    report.set_item("unused_vertices", counts.unused_vertices)?;
    report.set_item("flipped_faces", counts.flipped_faces)?;
    report.set_item("turned_components", counts.turned_components)?;
    Ok((
        vectors_out(py, &repaired.vertices),
        faces_out(py, &repaired.faces),
        numbers_out(py, &repaired.vertex_map),
        report,
    ))
}
