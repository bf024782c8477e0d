//! `quasirigid.reference`: closed forms as classes, tables as lists of tuples.

use std::f64::consts::FRAC_PI_2;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};

use crate::python::convert::number;
use crate::reference::{self, Cone, CoredSphere, FlatPunch, Hertz};

fn out_of_range(name: &str, value: f64, expected: &str) -> PyErr {
    PyValueError::new_err(format!("{name} is {value}, expected {expected}"))
}

/// The number, if it is finite and above 0.
fn positive(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let value = number(value, name)?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(out_of_range(name, value, "a finite number above 0"))
    }
}

/// What pickle and copy make an object of anew: no positions, and keywords.
type NewArguments<'py> = (Bound<'py, PyTuple>, Bound<'py, PyDict>);

fn new_arguments<'py>(py: Python<'py>, keywords: [(&str, f64); 2]) -> PyResult<NewArguments<'py>> {
    Ok((PyTuple::empty(py), keywords.into_py_dict(py)?))
}

fn shown(class: &str, keywords: [(&str, f64); 2]) -> String {
    let [(first, one), (second, other)] = keywords;
    format!("{class}({first}={one:?}, {second}={other:?})")
}

fn approach(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    number(value, "approach")
}

fn distance(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    number(value, "distance")
}

fn force(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    number(value, "force")
}

/// A rigid sphere pressed into an elastic half-space, in Hertz's parabolic approximation (Johnson 1985, section 4.2).
///
/// Parameters
/// ----------
/// radius : float
///     Radius of the sphere R (m), > 0.
/// contact_modulus : float
///     Contact modulus of the half-space E* (Pa), > 0.
///
/// Raises
/// ------
/// ValueError
///     If one is out of range.
///
/// Examples
/// --------
/// >>> import quasirigid as qr
/// >>> modulus = qr.reference.contact_modulus(shear_modulus=60e3, poisson_ratio=0.5)
/// >>> round(qr.reference.Hertz(radius=8e-3, contact_modulus=modulus).force(0.5e-3), 3)
/// 0.32
#[pyclass(name = "Hertz", module = "quasirigid.reference", frozen)]
pub(super) struct PyHertz(Hertz);

#[pymethods]
impl PyHertz {
    #[new]
    #[pyo3(signature = (*, radius, contact_modulus))]
    fn new(radius: &Bound<'_, PyAny>, contact_modulus: &Bound<'_, PyAny>) -> PyResult<Self> {
        let radius = positive("radius", radius)?;
        Ok(Self(Hertz { radius, contact_modulus: positive("contact_modulus", contact_modulus)? }))
    }

    /// Return the force (N) at an approach (m).
    fn force(&self, #[pyo3(from_py_with = approach)] approach: f64) -> f64 {
        self.0.force(approach)
    }

    /// Return the contact radius (m) at an approach (m).
    fn contact_radius(&self, #[pyo3(from_py_with = approach)] approach: f64) -> f64 {
        self.0.contact_radius(approach)
    }

    /// Return the peak pressure (Pa) at an approach (m).
    fn max_pressure(&self, #[pyo3(from_py_with = approach)] approach: f64) -> f64 {
        self.0.max_pressure(approach)
    }

    /// Return the pressure (Pa) at an approach (m) and a distance from the axis (m).
    fn pressure(
        &self,
        #[pyo3(from_py_with = approach)] approach: f64,
        #[pyo3(from_py_with = distance)] distance: f64,
    ) -> f64 {
        self.0.pressure(approach, distance)
    }

    /// Return the stored elastic energy (J) at an approach (m).
    fn energy(&self, #[pyo3(from_py_with = approach)] approach: f64) -> f64 {
        self.0.energy(approach)
    }

    /// Return the approach (m) under a force (N).
    fn approach(&self, #[pyo3(from_py_with = force)] force: f64) -> f64 {
        self.0.approach(force)
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        new_arguments(py, self.keywords())
    }

    fn __repr__(&self) -> String {
        shown("Hertz", self.keywords())
    }
}

impl PyHertz {
    fn keywords(&self) -> [(&'static str, f64); 2] {
        [("radius", self.0.radius), ("contact_modulus", self.0.contact_modulus)]
    }
}

/// A rigid flat-ended cylinder pressed into an elastic half-space (Johnson 1985, section 3.8).
///
/// Parameters
/// ----------
/// radius : float
///     Radius of the flat end a (m), > 0.
/// contact_modulus : float
///     Contact modulus of the half-space E* (Pa), > 0.
///
/// Raises
/// ------
/// ValueError
///     If one is out of range.
#[pyclass(name = "FlatPunch", module = "quasirigid.reference", frozen)]
pub(super) struct PyFlatPunch(FlatPunch);

#[pymethods]
impl PyFlatPunch {
    #[new]
    #[pyo3(signature = (*, radius, contact_modulus))]
    fn new(radius: &Bound<'_, PyAny>, contact_modulus: &Bound<'_, PyAny>) -> PyResult<Self> {
        let radius = positive("radius", radius)?;
        Ok(Self(FlatPunch { radius, contact_modulus: positive("contact_modulus", contact_modulus)? }))
    }

    /// Return the force (N) at an approach (m).
    fn force(&self, #[pyo3(from_py_with = approach)] approach: f64) -> f64 {
        self.0.force(approach)
    }

    /// Return the pressure (Pa) at an approach (m) and a distance from the axis (m); infinite at the rim.
    fn pressure(
        &self,
        #[pyo3(from_py_with = approach)] approach: f64,
        #[pyo3(from_py_with = distance)] distance: f64,
    ) -> f64 {
        self.0.pressure(approach, distance)
    }

    /// Return the surface displacement along the punch's motion (m) at an approach (m) and a distance from the axis (m).
    fn displacement(
        &self,
        #[pyo3(from_py_with = approach)] approach: f64,
        #[pyo3(from_py_with = distance)] distance: f64,
    ) -> f64 {
        self.0.displacement(approach, distance)
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        new_arguments(py, self.keywords())
    }

    fn __repr__(&self) -> String {
        shown("FlatPunch", self.keywords())
    }
}

impl PyFlatPunch {
    fn keywords(&self) -> [(&'static str, f64); 2] {
        [("radius", self.0.radius), ("contact_modulus", self.0.contact_modulus)]
    }
}

/// A rigid blunt cone pressed point first into an elastic half-space (Sneddon 1965; Johnson 1985, section 5.2).
///
/// Parameters
/// ----------
/// semi_angle : float
///     Angle between the axis and the face (rad), in (0, pi/2).
/// contact_modulus : float
///     Contact modulus of the half-space E* (Pa), > 0.
///
/// Raises
/// ------
/// ValueError
///     If one is out of range.
#[pyclass(name = "Cone", module = "quasirigid.reference", frozen)]
pub(super) struct PyCone(Cone);

#[pymethods]
impl PyCone {
    #[new]
    #[pyo3(signature = (*, semi_angle, contact_modulus))]
    fn new(semi_angle: &Bound<'_, PyAny>, contact_modulus: &Bound<'_, PyAny>) -> PyResult<Self> {
        let semi_angle = number(semi_angle, "semi_angle")?;
        if !(semi_angle > 0.0 && semi_angle < FRAC_PI_2) {
            return Err(out_of_range("semi_angle", semi_angle, "an angle between 0 and pi/2 rad"));
        }
        Ok(Self(Cone { semi_angle, contact_modulus: positive("contact_modulus", contact_modulus)? }))
    }

    /// Return the force (N) at an approach (m).
    fn force(&self, #[pyo3(from_py_with = approach)] approach: f64) -> f64 {
        self.0.force(approach)
    }

    /// Return the contact radius (m) at an approach (m).
    fn contact_radius(&self, #[pyo3(from_py_with = approach)] approach: f64) -> f64 {
        self.0.contact_radius(approach)
    }

    /// Return the pressure (Pa) at an approach (m) and a distance from the axis (m); infinite at the tip.
    fn pressure(
        &self,
        #[pyo3(from_py_with = approach)] approach: f64,
        #[pyo3(from_py_with = distance)] distance: f64,
    ) -> f64 {
        self.0.pressure(approach, distance)
    }

    /// Return the stored elastic energy (J) at an approach (m).
    fn energy(&self, #[pyo3(from_py_with = approach)] approach: f64) -> f64 {
        self.0.energy(approach)
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        new_arguments(py, self.keywords())
    }

    fn __repr__(&self) -> String {
        shown("Cone", self.keywords())
    }
}

impl PyCone {
    fn keywords(&self) -> [(&'static str, f64); 2] {
        [("semi_angle", self.0.semi_angle), ("contact_modulus", self.0.contact_modulus)]
    }
}

/// Return the contact modulus E* = 2 G / (1 - nu) (Pa) of an isotropic elastic body.
///
/// Parameters
/// ----------
/// shear_modulus : float
///     Shear modulus G (Pa), > 0.
/// poisson_ratio : float
///     Poisson's ratio nu, in [0, 0.5].
///
/// Raises
/// ------
/// ValueError
///     If one is out of range.
#[pyfunction]
#[pyo3(signature = (*, shear_modulus, poisson_ratio))]
pub(super) fn contact_modulus(
    shear_modulus: &Bound<'_, PyAny>,
    poisson_ratio: &Bound<'_, PyAny>,
) -> PyResult<f64> {
    let shear_modulus = positive("shear_modulus", shear_modulus)?;
    let poisson_ratio = number(poisson_ratio, "poisson_ratio")?;
    if !(0.0..=0.5).contains(&poisson_ratio) {
        return Err(out_of_range("poisson_ratio", poisson_ratio, "a number from 0 to 0.5"));
    }
    Ok(reference::contact_modulus(shear_modulus, poisson_ratio))
}

/// Thinness, force ratio and accuracy of each case.
#[pyfunction]
pub(super) fn sphere_on_layer() -> Vec<(f64, f64, f64)> {
    reference::sphere_on_layer().map(|case| (case.thinness, case.force_ratio, case.accuracy)).into()
}

/// Pairs of `r / h` and `h u / K`.
#[pyfunction]
pub(super) fn point_load_on_layer() -> Vec<(f64, f64)> {
    reference::point_load_on_layer().into()
}

/// Radius, core radius and indenter radius (m), shear modulus (Pa), accuracy, Poisson's ratio and pairs of depth (m) and
/// force (N).
type CoredSphereCase = (f64, f64, f64, f64, f64, f64, Vec<(f64, f64)>);

/// One case for each Poisson's ratio.
#[pyfunction]
pub(super) fn plate_on_cored_sphere() -> Vec<CoredSphereCase> {
    reference::plate_on_cored_sphere().map(cored_sphere).into()
}

/// One case for each Poisson's ratio.
#[pyfunction]
pub(super) fn ball_on_cored_sphere() -> Vec<CoredSphereCase> {
    reference::ball_on_cored_sphere().map(cored_sphere).into()
}

fn cored_sphere(case: CoredSphere) -> CoredSphereCase {
    let (radius, core_radius) = (CoredSphere::RADIUS, CoredSphere::CORE_RADIUS);
    let (shear_modulus, accuracy) = (CoredSphere::SHEAR_MODULUS, CoredSphere::ACCURACY);
    let CoredSphere { poisson_ratio, indenter_radius, indentations } = case;
    (radius, core_radius, indenter_radius, shear_modulus, accuracy, poisson_ratio, indentations.to_vec())
}
