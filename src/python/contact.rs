//! `solve_contact` and `press`.

use std::mem::take;
use std::sync::{Mutex, PoisonError};

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::contact::{
    self, Balance, Contact, ContactError, ContactOptions, Goal, Press, PressedContact, Start, Tilt, TiltAxes,
    WarmStart,
};
use crate::lcp::LcpSolution;
use crate::linalg::factor::Interrupt;
use crate::python::accuracy::{PyAccuracy, PyRefinement};
use crate::python::arrays_out::{nodes_out, pairs_out, read_only, vectors_out};
use crate::python::contact_options::PyContactOptions;
use crate::python::convert::{named, number, vector, vectors};
use crate::python::errors::{ContactError as PyContactError, IntoPyErr};
use crate::python::forked::released;
use crate::python::interrupt::detached_with;
use crate::python::lcp::PyLcpSolution;
use crate::python::loaded::PyLoadedVertices;
use crate::python::obstacle::PyObstacle;
use crate::python::resultant::{PyPatch, PyResultant, patches_out};
use crate::python::skin::PySkin;
use crate::python::surface::PySurface;
use crate::response::ElasticSkin;

/// A contact, and what draws its skin.
#[pyclass(name = "Contact", module = "quasirigid._core", frozen, get_all)]
pub(super) struct PyContact {
    status: &'static str,
    advice: String,
    resultant: Py<PyResultant>,
    /// Vertices and resultant of each connected part of the active set.
    patches: Vec<PyPatch>,
    loaded: Py<PyLoadedVertices>,
    max_penetration_before: f64,
    max_penetration_after: f64,
    obstacle_share: Option<f64>,
    pressure: Py<PyArray1<f64>>,
    node_force: Py<PyArray1<f64>>,
    force_vectors: Py<PyArray2<f64>>,
    gap: Py<PyArray1<f64>>,
    candidates: Py<PyArray1<i64>>,
    active: Py<PyArray1<i64>>,
    obstacle: Py<PyObstacle>,
    travel: f64,
    depth: Option<f64>,
    lcp_solutions: Vec<Py<PyLcpSolution>>,
    given_vertex_count: usize,
    /// The two vertices that each added one lies between (k, 2).
    parents: Py<PyArray2<i64>>,
    refinements: Vec<Py<PyRefinement>>,
    accuracy: Py<PyAccuracy>,
    /// Stage and seconds, in order.
    timings: Vec<(&'static str, f64)>,
    /// What the scene did not need, and why.
    left_out: Vec<(&'static str, String)>,
    /// What each is about, and its message.
    warnings: Vec<(&'static str, String)>,
    drawing: Py<PyDrawing>,
}

impl PyContact {
    fn new(
        mut contact: Contact,
        skin: &Bound<'_, PySkin>,
        options: ContactOptions<'static>,
    ) -> PyResult<Self> {
        let py = skin.py();
        let lcp_solution = |solution: &LcpSolution| PyLcpSolution::new(py, solution);
        // The arrays that nothing is drawn from move out without a copy.
        let moved = |numbers: &mut Vec<f64>| read_only(PyArray1::from_vec(py, take(numbers)));
        Ok(Self {
            status: contact.status.as_str(),
            advice: contact.advice(),
            resultant: PyResultant::new(py, &contact.resultant)?,
            patches: patches_out(py, &contact.patches)?,
            loaded: Py::new(py, PyLoadedVertices::from(contact.loaded.clone()))?,
            max_penetration_before: contact.max_penetration_before,
            max_penetration_after: contact.max_penetration_after,
            obstacle_share: contact.obstacle_share,
            pressure: moved(&mut contact.pressure),
            node_force: moved(&mut contact.node_force),
            force_vectors: read_only(vectors_out(py, &contact.force_vectors)),
            gap: moved(&mut contact.gap),
            candidates: read_only(nodes_out(py, &contact.candidates)),
            active: read_only(nodes_out(py, &contact.active)),
            obstacle: Py::new(py, PyObstacle::from(contact.obstacle.clone()))?,
            travel: contact.travel,
            depth: contact.depth,
            lcp_solutions: contact.lcp_solutions.iter().map(lcp_solution).collect::<PyResult<_>>()?,
            given_vertex_count: contact.given_vertex_count(),
            parents: read_only(pairs_out(py, &contact.parents())),
            refinements: contact
                .refinements
                .iter()
                .map(|round| PyRefinement::new(py, round))
                .collect::<PyResult<_>>()?,
            accuracy: Py::new(py, PyAccuracy::from(&contact.accuracy))?,
            timings: contact.timings.iter().map(|timing| (timing.stage, timing.seconds)).collect(),
            left_out: take(&mut contact.left_out).into_iter().map(|one| (one.what, one.why)).collect(),
            warnings: take(&mut contact.warnings)
                .into_iter()
                .map(|one| (one.kind.as_str(), one.message))
                .collect(),
            drawing: Py::new(py, PyDrawing { contact, skin: PySkin::for_drawing(skin)?, options })?,
        })
    }
}

/// Displacement of the product opposite the vertices (n, 3) in m, and its moved mesh.
type DrawnObstacle = (Py<PyArray2<f64>>, Option<PySurface>);

/// What the drawn skin is computed from.
#[pyclass(name = "Drawing", module = "quasirigid._core", frozen)]
pub(super) struct PyDrawing {
    contact: Contact,
    skin: Py<PySkin>,
    options: ContactOptions<'static>,
}

#[pymethods]
impl PyDrawing {
    /// The mesh that was solved; `None` where nothing was refined.
    fn surface(&self, py: Python<'_>) -> Option<PySurface> {
        released(py, || self.contact.refined_surface().map(|mesh| mesh.surface.clone())).map(Into::into)
    }

    /// Displacement of the product (n, 3) in m and its mesh moved, None of a primitive; None of a rigid product.
    fn draw_obstacle(&self, py: Python<'_>) -> PyResult<Option<DrawnObstacle>> {
        if self.contact.obstacle.material().is_none() {
            return Ok(None);
        }
        let draw = |interrupt: Interrupt| {
            let options = ContactOptions { interrupt: Some(interrupt), ..self.options.clone() };
            Ok::<_, ContactError>((
                self.contact.obstacle_displacement(),
                self.contact.deformed_obstacle(&options)?,
            ))
        };
        let drawn = detached_with(py, self.options.num_threads, draw)?.map_err(IntoPyErr::into_py_err)?;
        let (displacement, deformed) = drawn;
        Ok(Some((read_only(vectors_out(py, &displacement)), deformed.map(Into::into))))
    }

    /// Displacement (n, 3) in m, fade distance (m), volume change (m³) and deformed surface, computed now.
    fn draw(&self, py: Python<'_>) -> PyResult<(Py<PyArray2<f64>>, f64, f64, PySurface)> {
        let skin = self.skin.get().elastic();
        let draw = |interrupt: Interrupt| {
            let options = ContactOptions { interrupt: Some(interrupt), ..self.options.clone() };
            self.contact.drawn_skin(skin, &options)
        };
        let drawn = detached_with(py, self.options.num_threads, draw)?.map_err(IntoPyErr::into_py_err)?;
        let displacement = read_only(vectors_out(py, &drawn.displacement));
        Ok((displacement, drawn.fade_distance, drawn.volume_change, drawn.deformed.into()))
    }
}

/// What a press leaves to the next one of the same question but for the goal.
#[pyclass(name = "WarmStart", module = "quasirigid._core", frozen)]
#[derive(Default)]
pub(super) struct PyWarmStart(Mutex<WarmStart>);

#[pymethods]
impl PyWarmStart {
    #[new]
    fn new() -> Self {
        Self::default()
    }
}

/// Runs a solve with the interpreter released and Ctrl-C heard.
fn run(
    skin: &Bound<'_, PySkin>,
    options: &PyContactOptions,
    solve: impl FnOnce(&dyn ElasticSkin, &ContactOptions) -> Result<Contact, ContactError> + Send,
) -> PyResult<PyContact> {
    let (elastic, options) = (skin.get().elastic(), options.0.clone());
    let contact = detached_with(skin.py(), options.num_threads, |interrupt| {
        solve(elastic, &ContactOptions { interrupt: Some(interrupt), ..options.clone() })
    })?;
    match contact {
        Ok(contact) => PyContact::new(contact, skin, options),
        Err(error) => Err(raised(error, skin, options)?),
    }
}

/// The exception for an error; the contact of a press that fell short or found no balance goes with it.
fn raised(
    error: ContactError,
    skin: &Bound<'_, PySkin>,
    options: ContactOptions<'static>,
) -> PyResult<PyErr> {
    let message = error.to_string();
    let (ContactError::NotReached { contact: PressedContact(contact), .. }
    | ContactError::NotBalanced { contact: PressedContact(contact), .. }) = error
    else {
        return Ok(error.into_py_err());
    };
    let py = skin.py();
    let raised = PyContactError::new_err(message);
    raised.value(py).setattr("contact", PyContact::new(*contact, skin, options)?)?;
    Ok(raised)
}

#[pyfunction]
pub(super) fn solve_contact(
    surface: &PySurface,
    obstacle: &PyObstacle,
    skin: &Bound<'_, PySkin>,
    options: &PyContactOptions,
) -> PyResult<PyContact> {
    run(skin, options, |skin, options| contact::solve_contact(&surface.inner, &obstacle.inner, skin, options))
}

#[pyfunction]
#[pyo3(signature = (surface, obstacle, skin, direction, *, start, options, depth = None, force = None, overlap = None, balance = "none", tilt_axes = None, tilt_point = None, warm = None))]
#[expect(clippy::too_many_arguments, reason = "a call has the arguments that it has")]
pub(super) fn press(
    surface: &PySurface,
    obstacle: &PyObstacle,
    skin: &Bound<'_, PySkin>,
    direction: &Bound<'_, PyAny>,
    start: &str,
    options: &PyContactOptions,
    depth: Option<&Bound<'_, PyAny>>,
    force: Option<&Bound<'_, PyAny>>,
    overlap: Option<&Bound<'_, PyAny>>,
    balance: &str,
    tilt_axes: Option<&Bound<'_, PyAny>>,
    tilt_point: Option<&Bound<'_, PyAny>>,
    warm: Option<&PyWarmStart>,
) -> PyResult<PyContact> {
    let goal = match (depth, force, overlap) {
        (Some(depth), None, None) => Goal::Depth(number(depth, "depth")?),
        (None, Some(force), None) => Goal::Force(number(force, "force")?),
        (None, None, Some(overlap)) => Goal::Overlap(number(overlap, "overlap")?),
        _ => {
            return Err(PyContactError::new_err(not_one_goal(
                [depth, force, overlap].map(|value| value.is_some()),
            )));
        }
    };
    let starts = [(Start::Infinity, "infinity"), (Start::Current, "current")];
    let start = named("start", start, &starts, PyContactError::new_err)?;
    let balance = balance_in(balance, tilt_axes, tilt_point)?;
    let press = Press { direction: vector(direction, "direction")?, goal, start, balance };
    run(skin, options, |skin, options| match warm {
        None => contact::press(&surface.inner, &obstacle.inner, skin, &press, options),
        Some(PyWarmStart(before)) => {
            let mut before = before.lock().unwrap_or_else(PoisonError::into_inner);
            contact::press_after(&surface.inner, &obstacle.inner, skin, &press, options, &mut before)
        }
    })
}

/// Whether an obstacle turns, and about what.
fn balance_in(
    name: &str,
    axes: Option<&Bound<'_, PyAny>>,
    point: Option<&Bound<'_, PyAny>>,
) -> PyResult<Balance> {
    let refused = |why: &str| Err(PyContactError::new_err(why.to_owned()));
    let is_tilt = named("balance", name, &[(false, "none"), (true, "tilt")], PyContactError::new_err)?;
    match (is_tilt, axes, point) {
        (false, None, None) => Ok(Balance::None),
        (false, ..) => refused("`tilt_axes` and `tilt_point` go with `balance=\"tilt\"`"),
        (true, _, None) => {
            refused("`balance=\"tilt\"` needs `tilt_point`, the point (m) that the obstacle turns about")
        }
        (true, axes, Some(point)) => {
            let axes = match axes {
                None => TiltAxes::Across,
                Some(axes) => match vectors(axes, "tilt_axes")?[..] {
                    [one] => TiltAxes::One(one),
                    [a, b] => TiltAxes::Two([a, b]),
                    ref more => {
                        return refused(&format!("tilt_axes has {} rows, expected one or two", more.len()));
                    }
                },
            };
            Ok(Balance::Tilt(Tilt { point: vector(point, "tilt_point")?, axes }))
        }
    }
}

fn not_one_goal(is_given: [bool; 3]) -> String {
    let names = ["depth", "force", "overlap"].into_iter().zip(is_given);
    let given: Vec<&str> = names.filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect();
    let given = if given.is_empty() { "none of them".to_owned() } else { given.join(" and ") };
    format!("a press takes depth, force or overlap, and one of them alone; given: {given}")
}
