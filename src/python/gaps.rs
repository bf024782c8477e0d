//! Initial gaps as a response measures them.

use super::convert::{nodes, scalars, vectors_out};
use super::errors::IntoPyErr;
use super::skin::PySkin;
use super::surface::PySurface;
use crate::response::{Gap, pressure_average};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// Initial gap of each node from a function that gives it at points (p, 3).
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
    let nodes = self::nodes(nodes, "nodes", surface.vertices().len())?;
    skin.elastic().check_surface(surface).map_err(IntoPyErr::into_py_err)?;
    let measure = |points: &[nalgebra::Vector3<f64>]| -> PyResult<Vec<f64>> {
        let found = scalars(&distance.call1((vectors_out(py, points),))?, "distance(points)")?;
        if found.len() != points.len() || found.iter().any(|gap| !gap.is_finite()) {
            let message =
                format!("distance(points) must give {} finite numbers, one per point", points.len());
            return Err(PyValueError::new_err(message));
        }
        Ok(found)
    };
    if skin.elastic().gap() == Gap::Node {
        let points: Vec<_> = nodes.iter().map(|&vertex| surface.vertices()[vertex]).collect();
        return Ok(PyArray1::from_vec(py, measure(&points)?));
    }
    let around = surface.k_ring(&nodes, 1);
    let edge = |a: u32, b: u32| [a.min(b), a.max(b)];
    let mut place_of: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    let mut points: Vec<_> = around.iter().map(|&vertex| surface.vertices()[vertex]).collect();
    for &face in nodes.iter().flat_map(|&vertex| surface.faces_around(vertex)) {
        let [a, b, c] = surface.faces()[face as usize];
        for [a, b] in [edge(a, b), edge(b, c), edge(c, a)] {
            place_of.entry([a, b]).or_insert_with(|| {
                points.push(0.5 * (surface.vertices()[a as usize] + surface.vertices()[b as usize]));
                points.len() - 1
            });
        }
    }
    let found = measure(&points)?;
    let mut at_vertices = vec![f64::NAN; surface.vertices().len()];
    around.iter().zip(&found).for_each(|(&vertex, &gap)| at_vertices[vertex] = gap);
    let at_middle = |a: u32, b: u32| found[place_of[&edge(a, b)]];
    let pressure = skin.elastic().pressure();
    let average = |&vertex: &usize| pressure_average(surface, pressure, vertex, &at_vertices, at_middle);
    Ok(PyArray1::from_vec(py, nodes.iter().map(average).collect()))
}
