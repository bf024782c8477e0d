//! `quasirigid.Skin` as the core keeps it, and the response matrix.

use super::convert::{matrix_out, nodes, vectors};
use super::errors::IntoPyErr;
use super::interrupt::{detached, detached_on_thread};
use super::surface::PySurface;
use crate::response::{self, AssemblyOptions, Pressure, Response, Skin};
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Material and response, checked.
#[pyclass(name = "Skin", module = "quasirigid._core", frozen)]
pub(super) struct PySkin {
    pub inner: Skin,
}

fn pressure_named(name: &str) -> PyResult<Pressure> {
    match name {
        "linear" => Ok(Pressure::Linear),
        "one_ring" => Ok(Pressure::OneRing),
        other => {
            Err(PyValueError::new_err(format!("pressure is {other:?}, expected \"linear\" or \"one_ring\"")))
        }
    }
}

fn made(shear_modulus: f64, poisson_ratio: f64, response: Response) -> PyResult<PySkin> {
    Skin::new(shear_modulus, poisson_ratio, response)
        .map(|inner| PySkin { inner })
        .map_err(IntoPyErr::into_py_err)
}

#[pymethods]
impl PySkin {
    #[staticmethod]
    fn half_space(shear_modulus: f64, poisson_ratio: f64, pressure: &str) -> PyResult<Self> {
        made(shear_modulus, poisson_ratio, Response::HalfSpace { pressure: pressure_named(pressure)? })
    }

    #[staticmethod]
    fn gaussian_corrected(
        shear_modulus: f64,
        poisson_ratio: f64,
        height: f64,
        width: f64,
        cutoff: f64,
        pressure: &str,
    ) -> PyResult<Self> {
        let pressure = pressure_named(pressure)?;
        made(shear_modulus, poisson_ratio, Response::GaussianCorrected { height, width, cutoff, pressure })
    }
}

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
    let directions = directions.map(|value| vectors(value, "directions")).transpose()?;
    let assemble = |interrupt: &(dyn Fn() -> bool + Sync)| {
        let options = AssemblyOptions {
            tolerance,
            num_threads,
            interrupt: Some(interrupt),
            ..AssemblyOptions::default()
        };
        response::assemble(&surface.inner, &skin.inner, &nodes, directions.as_deref(), &options)
    };
    let matrix = match num_threads {
        None => detached(py, assemble)?,
        Some(_) => detached_on_thread(py, assemble)?,
    };
    Ok(matrix_out(py, &matrix.map_err(IntoPyErr::into_py_err)?))
}
