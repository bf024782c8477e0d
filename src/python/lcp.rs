//! `solve_lcp`.

use super::convert::{MatrixIn, nodes_out, scalars};
use super::errors::IntoPyErr;
use super::interrupt::detached;
use crate::lcp::{self, DefinitenessCheck, LcpMethod, LcpOptions, LcpProblem, LcpSolution, RayConclusion};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The method of a name.
pub(super) fn method_named(name: &str) -> PyResult<LcpMethod> {
    named("method", name, &LcpMethod::ALL, LcpMethod::as_str)
}

/// The one of `all` that has the name.
fn named<T: Copy>(option: &str, name: &str, all: &[T], name_of: fn(T) -> &'static str) -> PyResult<T> {
    all.iter().copied().find(|&one| name_of(one) == name).ok_or_else(|| {
        let known: Vec<String> = all.iter().map(|&one| format!("{:?}", name_of(one))).collect();
        PyValueError::new_err(format!("{option} is {name:?}, expected one of {}", known.join(", ")))
    })
}

/// Options of a complementarity problem; their defaults are the crate's.
#[pyclass(name = "LcpOptions", module = "quasirigid._core", frozen)]
pub(super) struct PyLcpOptions {
    inner: LcpOptions<'static>,
    known_p_matrix: bool,
}

#[pymethods]
impl PyLcpOptions {
    #[new]
    #[pyo3(signature = (
        *, max_pivots, pivot_tol, tolerance, initial_active, covering, definiteness, crash, known_p_matrix
    ))]
    #[allow(clippy::too_many_arguments, reason = "one for each option, by keyword")]
    fn new(
        max_pivots: Option<usize>,
        pivot_tol: f64,
        tolerance: f64,
        initial_active: Option<Vec<usize>>,
        covering: Option<&Bound<'_, PyAny>>,
        definiteness: &str,
        crash: bool,
        known_p_matrix: bool,
    ) -> PyResult<Self> {
        let inner = LcpOptions {
            max_pivots,
            pivot_tol,
            tolerance,
            initial_active,
            covering: covering.map(|value| scalars(value, "covering")).transpose()?,
            interrupt: None,
            definiteness: named(
                "definiteness",
                definiteness,
                &DefinitenessCheck::ALL,
                DefinitenessCheck::as_str,
            )?,
            crash,
        };
        Ok(Self { inner, known_p_matrix })
    }

    /// The crate's defaults by name.
    #[staticmethod]
    fn defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let options = LcpOptions::default();
        let defaults = PyDict::new(py);
        defaults.set_item("max_pivots", options.max_pivots)?;
        defaults.set_item("pivot_tol", options.pivot_tol)?;
        defaults.set_item("tolerance", options.tolerance)?;
        defaults.set_item("definiteness", options.definiteness.as_str())?;
        defaults.set_item("crash", options.crash)?;
        Ok(defaults)
    }
}

/// What the crate returns for a complementarity problem, read by the facade.
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
        RayConclusion::InfeasibleToRounding => "infeasible_to_rounding",
        RayConclusion::NotCopositive => "not_copositive",
        RayConclusion::Inconclusive => "inconclusive",
    }
}

#[pymethods]
impl PyLcpSolution {
    /// Everything by the names of the facade's `LcpSolution`; certificate and ray as dicts of theirs, attempts as
    /// tuples (method, status, pivots, warm, crash).
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let solution = &self.inner;
        let fields = PyDict::new(py);
        fields.set_item(intern!(py, "status"), solution.status.as_str())?;
        fields.set_item(intern!(py, "z"), PyArray1::from_slice(py, &solution.z))?;
        fields.set_item(intern!(py, "w"), PyArray1::from_slice(py, &solution.w))?;
        fields.set_item(intern!(py, "active"), nodes_out(py, &solution.active()))?;
        fields.set_item(intern!(py, "pivots"), solution.pivots)?;
        fields.set_item(intern!(py, "natural_residual"), solution.natural_residual)?;
        fields.set_item(intern!(py, "complementarity"), solution.complementarity)?;
        fields.set_item(intern!(py, "method"), solution.method.as_str())?;
        fields.set_item(intern!(py, "advice"), solution.advice())?;
        fields.set_item(intern!(py, "certificate"), self.certificate(py)?)?;
        fields.set_item(intern!(py, "ray"), self.ray(py)?)?;
        let attempt = |attempt: &lcp::LcpAttempt| {
            let (method, status) = (attempt.method.as_str(), attempt.status.as_str());
            (method, status, attempt.pivots, attempt.warm, attempt.crash)
        };
        let attempts: Vec<_> = solution.attempts.iter().map(attempt).collect();
        fields.set_item(intern!(py, "attempts"), attempts)?;
        fields.set_item(intern!(py, "candidates"), solution.candidates)?;
        Ok(fields)
    }
}

impl PyLcpSolution {
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let certificate = &self.inner.certificate;
        let fields = PyDict::new(py);
        fields.set_item(intern!(py, "natural_residual"), certificate.natural_residual)?;
        fields.set_item(intern!(py, "complementarity"), certificate.complementarity)?;
        fields.set_item(intern!(py, "infeasibility"), certificate.infeasibility)?;
        fields.set_item(intern!(py, "definiteness"), certificate.definiteness.as_str())?;
        fields.set_item(intern!(py, "is_unique"), certificate.is_unique())?;
        Ok(fields)
    }

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
}

#[pyfunction]
#[pyo3(signature = (matrix, q, method, options))]
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
        let known_p_matrix = options.known_p_matrix;
        let options = LcpOptions { interrupt: Some(interrupt), ..options.inner.clone() };
        let mut problem = LcpProblem::new(view, &q)?;
        if known_p_matrix {
            problem = problem.with_known_p_matrix();
        }
        lcp::solve(&problem, method, &options)
    })?;
    solution.map(PyLcpSolution::from).map_err(IntoPyErr::into_py_err)
}
