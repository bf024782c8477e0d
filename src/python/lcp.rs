//! `solve_lcp`.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::lcp::{
    self, DefinitenessCheck, LcpMethod, LcpMethodName, LcpOptions, LcpProblem, LcpSolution, LemkeOptions,
    RayConclusion, StartingBasis,
};
use crate::python::arrays_out::{nodes_out, read_only};
use crate::python::convert::{MatrixArgument, named, scalars};
use crate::python::errors::{IntoPyErr, LcpError};
use crate::python::interrupt::detached;

pub(super) fn method_named(name: &str) -> PyResult<LcpMethodName> {
    let names = LcpMethodName::ALL.map(|method| (method, method.as_str()));
    named("method", name, &names, LcpError::new_err)
}

/// Options of a complementarity problem; their defaults are the crate's.
#[pyclass(name = "LcpOptions", module = "quasirigid._core", frozen)]
pub(super) struct PyLcpOptions {
    shared: LcpOptions<'static>,
    lemke: LemkeOptions,
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
        let covering = covering.map(|value| scalars(value, "covering")).transpose()?;
        let shared = LcpOptions {
            max_pivots,
            tolerance,
            exchanges_only: false,
            initial_active,
            interrupt: None,
            definiteness: named(
                "definiteness",
                definiteness,
                &DefinitenessCheck::ALL.map(|check| (check, check.as_str())),
                LcpError::new_err,
            )?,
        };
        Ok(Self { shared, lemke: LemkeOptions { pivot_tol, covering, crash }, known_p_matrix })
    }

    /// The crate's defaults by name.
    #[staticmethod]
    fn defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let (options, lemke) = (LcpOptions::default(), LemkeOptions::default());
        let defaults = PyDict::new(py);
        defaults.set_item("max_pivots", options.max_pivots)?;
        defaults.set_item("pivot_tol", lemke.pivot_tol)?;
        defaults.set_item("tolerance", options.tolerance)?;
        defaults.set_item("definiteness", options.definiteness.as_str())?;
        defaults.set_item("crash", lemke.crash)?;
        Ok(defaults)
    }
}

/// Direction of the path on which Lemke's method ended.
#[pyclass(name = "LcpRay", module = "quasirigid._core", frozen, get_all)]
pub(super) struct PyLcpRay {
    z: Py<PyArray1<f64>>,
    w: Py<PyArray1<f64>>,
    z0: f64,
    residual: f64,
    curvature: f64,
    conclusion: &'static str,
}

/// Method, ending, pivots, whether it began from a guess, whether it looked for a crash basis.
type Attempt = (&'static str, &'static str, usize, bool, bool);

/// What a solve of a complementarity problem found.
#[pyclass(name = "LcpSolution", module = "quasirigid._core", frozen, get_all)]
pub(super) struct PyLcpSolution {
    status: &'static str,
    z: Py<PyArray1<f64>>,
    w: Py<PyArray1<f64>>,
    active: Py<PyArray1<i64>>,
    pivots: usize,
    natural_residual: f64,
    complementarity: f64,
    infeasibility: f64,
    definiteness: &'static str,
    is_unique: bool,
    method: &'static str,
    advice: String,
    ray: Option<Py<PyLcpRay>>,
    attempts: Vec<Attempt>,
    candidates: usize,
}

fn conclusion_name(conclusion: RayConclusion) -> &'static str {
    match conclusion {
        RayConclusion::Infeasible => "infeasible",
        RayConclusion::InfeasibleToRounding => "infeasible_to_rounding",
        RayConclusion::NotCopositive => "not_copositive",
        RayConclusion::Inconclusive => "inconclusive",
    }
}

impl PyLcpSolution {
    pub(super) fn new(py: Python<'_>, solution: &LcpSolution) -> PyResult<Py<Self>> {
        let certificate = &solution.certificate;
        let attempt = |attempt: &lcp::LcpAttempt| {
            let (method, status) = (attempt.method.as_str(), attempt.status.as_str());
            let is = |start| attempt.start == start;
            (method, status, attempt.pivots, is(StartingBasis::Guess), is(StartingBasis::Crash))
        };
        let values = Self {
            status: solution.status.as_str(),
            z: numbers_out(py, &solution.z),
            w: numbers_out(py, &solution.w),
            active: read_only(nodes_out(py, &solution.active())),
            pivots: solution.pivots,
            natural_residual: certificate.natural_residual,
            complementarity: certificate.complementarity,
            infeasibility: certificate.infeasibility,
            definiteness: match certificate.definiteness {
                _ if certificate.known_p_matrix => "p_matrix",
                found => found.as_str(),
            },
            is_unique: certificate.is_unique(),
            method: solution.method.as_str(),
            advice: solution.advice(),
            ray: solution.ray.as_ref().map(|ray| Py::new(py, PyLcpRay::new(py, ray))).transpose()?,
            attempts: solution.attempts.iter().map(attempt).collect(),
            candidates: solution.candidates,
        };
        Py::new(py, values)
    }
}

impl PyLcpRay {
    fn new(py: Python<'_>, ray: &lcp::LcpRay) -> Self {
        Self {
            z: numbers_out(py, &ray.z),
            w: numbers_out(py, &ray.w),
            z0: ray.z0,
            residual: ray.residual,
            curvature: ray.curvature,
            conclusion: conclusion_name(ray.conclusion),
        }
    }
}

fn numbers_out(py: Python<'_>, numbers: &[f64]) -> Py<PyArray1<f64>> {
    read_only(PyArray1::from_slice(py, numbers))
}

#[pyfunction]
#[pyo3(signature = (matrix, q, method, options))]
pub(super) fn solve_lcp(
    py: Python<'_>,
    matrix: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    method: &str,
    options: &PyLcpOptions,
) -> PyResult<Py<PyLcpSolution>> {
    let matrix = MatrixArgument::new(matrix, "M", LcpError::new_err)?;
    let q = scalars(q, "q")?;
    let method = LcpMethod::named(method_named(method)?, options.lemke.clone());
    let view = matrix.view();
    let solution = detached(py, |interrupt| {
        let shared = LcpOptions { interrupt: Some(interrupt), ..options.shared.clone() };
        let mut problem = LcpProblem::new(view, &q)?;
        if options.known_p_matrix {
            problem = problem.with_known_p_matrix();
        }
        // One that the method does not read is checked as well.
        options.lemke.validate(q.len())?;
        lcp::solve(&problem, &method, &shared)
    })?;
    PyLcpSolution::new(py, &solution.map_err(IntoPyErr::into_py_err)?)
}
