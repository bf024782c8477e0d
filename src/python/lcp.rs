//! `solve_lcp`.

use super::convert::{MatrixIn, nodes_out, scalars};
use super::errors::IntoPyErr;
use super::interrupt::detached;
use crate::lcp::{self, LcpMethod, LcpOptions, LcpProblem, LcpSolution, RayConclusion};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The method of a name.
pub(super) fn method_named(name: &str) -> PyResult<LcpMethod> {
    LcpMethod::ALL.into_iter().find(|method| method.as_str() == name).ok_or_else(|| {
        let known: Vec<String> =
            LcpMethod::ALL.iter().map(|method| format!("{:?}", method.as_str())).collect();
        PyValueError::new_err(format!("method is {name:?}, expected one of {}", known.join(", ")))
    })
}

/// Options of a complementarity problem; their defaults are the crate's.
#[pyclass(name = "LcpOptions", module = "quasirigid._core", frozen)]
pub(super) struct PyLcpOptions {
    max_pivots: Option<usize>,
    pivot_tol: f64,
    tolerance: f64,
    initial_active: Option<Vec<usize>>,
    covering: Option<Vec<f64>>,
}

#[pymethods]
impl PyLcpOptions {
    #[new]
    #[pyo3(signature = (*, max_pivots, pivot_tol, tolerance, initial_active, covering))]
    fn new(
        max_pivots: Option<usize>,
        pivot_tol: f64,
        tolerance: f64,
        initial_active: Option<Vec<usize>>,
        covering: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let covering = covering.map(|value| scalars(value, "covering")).transpose()?;
        Ok(Self { max_pivots, pivot_tol, tolerance, initial_active, covering })
    }

    /// The crate's defaults by name.
    #[staticmethod]
    fn defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let options = LcpOptions::default();
        let defaults = PyDict::new(py);
        defaults.set_item("max_pivots", options.max_pivots)?;
        defaults.set_item("pivot_tol", options.pivot_tol)?;
        defaults.set_item("tolerance", options.tolerance)?;
        Ok(defaults)
    }
}

/// What the crate returns for a complementarity problem, read field by field by the facade.
#[pyclass(name = "LcpSolution", module = "quasirigid._core", frozen)]
pub(super) struct PyLcpSolution {
    inner: LcpSolution,
}

impl From<LcpSolution> for PyLcpSolution {
    fn from(inner: LcpSolution) -> Self {
        Self { inner }
    }
}

fn conclusion_name(conclusion: RayConclusion) -> &'static str {
    match conclusion {
        RayConclusion::Infeasible => "infeasible",
        RayConclusion::NotCopositive => "not_copositive",
        RayConclusion::Inconclusive => "inconclusive",
    }
}

#[pymethods]
impl PyLcpSolution {
    /// Scalars and arrays by the names of the facade's `LcpSolution`.
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let solution = &self.inner;
        let fields = PyDict::new(py);
        fields.set_item("status", solution.status.as_str())?;
        fields.set_item("z", PyArray1::from_slice(py, &solution.z))?;
        fields.set_item("w", PyArray1::from_slice(py, &solution.w))?;
        fields.set_item("active", nodes_out(py, &solution.active()))?;
        fields.set_item("pivots", solution.pivots)?;
        fields.set_item("natural_residual", solution.natural_residual)?;
        fields.set_item("complementarity", solution.complementarity)?;
        fields.set_item("method", solution.method.as_str())?;
        fields.set_item("advice", solution.advice())?;
        Ok(fields)
    }

    /// The figures of `Certificate`.
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let certificate = &self.inner.certificate;
        let fields = PyDict::new(py);
        fields.set_item("natural_residual", certificate.natural_residual)?;
        fields.set_item("complementarity", certificate.complementarity)?;
        fields.set_item("infeasibility", certificate.infeasibility)?;
        fields.set_item("definiteness", certificate.definiteness.as_str())?;
        fields.set_item("is_unique", certificate.is_unique())?;
        Ok(fields)
    }

    /// The figures of `LcpRay`, or None.
    fn ray<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(ray) = &self.inner.ray else {
            return Ok(None);
        };
        let fields = PyDict::new(py);
        fields.set_item("z", PyArray1::from_slice(py, &ray.z))?;
        fields.set_item("w", PyArray1::from_slice(py, &ray.w))?;
        fields.set_item("z0", ray.z0)?;
        fields.set_item("residual", ray.residual)?;
        fields.set_item("curvature", ray.curvature)?;
        fields.set_item("conclusion", conclusion_name(ray.conclusion))?;
        Ok(Some(fields))
    }

    /// (method, status, pivots, warm) of every run, in order.
    fn attempts(&self) -> Vec<(&'static str, &'static str, usize, bool)> {
        let row = |attempt: &lcp::LcpAttempt| {
            (attempt.method.as_str(), attempt.status.as_str(), attempt.pivots, attempt.warm)
        };
        self.inner.attempts.iter().map(row).collect()
    }
}

#[pyfunction]
#[pyo3(signature = (matrix, q, *, method, options))]
pub(super) fn solve_lcp(
    py: Python<'_>,
    matrix: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    method: &str,
    options: &PyLcpOptions,
) -> PyResult<PyLcpSolution> {
    let matrix = MatrixIn::new(matrix, "M")?;
    let q = scalars(q, "q")?;
    let method = method_named(method)?;
    let view = matrix.view();
    let solution = detached(py, |interrupt| {
        let options = LcpOptions {
            max_pivots: options.max_pivots,
            pivot_tol: options.pivot_tol,
            tolerance: options.tolerance,
            initial_active: options.initial_active.clone(),
            covering: options.covering.clone(),
            interrupt: Some(interrupt),
            ..LcpOptions::default()
        };
        LcpProblem::new(view, &q).and_then(|problem| lcp::solve(&problem, method, &options))
    })?;
    solution.map(PyLcpSolution::from).map_err(IntoPyErr::into_py_err)
}
