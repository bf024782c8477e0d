//! Initial gaps as a response measures them, and depths of a skin in an obstacle.

use nalgebra::Vector3;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::contact;
use crate::linalg::factor::Interrupt;
use crate::python::arrays_out::vectors_out;
use crate::python::contact_options::PyContactOptions;
use crate::python::convert::{nodes, scalars};
use crate::python::errors::{IntoPyErr, ResponseError};
use crate::python::forked::released;
use crate::python::interrupt::detached_with;
use crate::python::obstacle::PyObstacle;
use crate::python::skin::PySkin;
use crate::python::surface::PySurface;
use crate::response;

/// Initial gap of each node from a function of points (p, 3).
#[pyfunction]
#[pyo3(text_signature = "(surface, skin, nodes, distance)")]
pub(super) fn initial_gaps<'py>(
    py: Python<'py>,
    surface: &PySurface,
    skin: &PySkin,
    nodes: &Bound<'py, PyAny>,
    distance: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let surface = &surface.inner;
    let nodes = self::nodes(nodes, "nodes", surface.vertices().len(), ResponseError::new_err)?;
    let distance = distance.clone().unbind();
    let traits = skin.elastic().traits(surface).map_err(IntoPyErr::into_py_err)?;
    let measure = |py: Python<'_>, points: &[Vector3<f64>]| {
        let found = scalars(&distance.bind(py).call1((vectors_out(py, points),))?, "distance(points)")?;
        if found.len() != points.len() || found.iter().any(|gap| !gap.is_finite()) {
            let message =
                format!("distance(points) must return {} finite numbers, one per point", points.len());
            return Err(ResponseError::new_err(message));
        }
        Ok(found)
    };
    let gaps = released(py, || {
        let measure = |points: &[Vector3<f64>]| Python::attach(|py| measure(py, points));
        response::initial_gaps(surface, traits.basis, traits.discretization, &nodes, measure)
    })?;
    Ok(PyArray1::from_vec(py, gaps))
}

/// How deep each vertex stands in an obstacle (m, >= 0), as a contact measures it.
#[pyfunction]
pub(super) fn overlaps<'py>(
    py: Python<'py>,
    surface: &PySurface,
    obstacle: &PyObstacle,
    options: &PyContactOptions,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (surface, obstacle, options) = (&surface.inner, &obstacle.inner, &options.0);
    let measure = |_: Interrupt| contact::overlaps(surface, obstacle, options);
    let found = detached_with(py, options.num_threads, measure)?.map_err(IntoPyErr::into_py_err)?;
    Ok(PyArray1::from_vec(py, found))
}
