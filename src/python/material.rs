//! Materials of products, from and to the facade's `Material`.

use super::convert::{matrix_out, nodes_out};
use super::skin::PySkin;
use crate::obstacle::Obstacle;
use crate::response::{Kernel, Thickness};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

/// Nodes and compliance of a given matrix.
type Given<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// The kernel of a product's response, built by the facade, and its given matrix if it has one; a new one warns of a kernel
/// that is not well posed.
pub(super) fn product_skin<'py>(
    py: Python<'py>,
    material: (f64, f64),
    response: Option<&Bound<'py, PyAny>>,
    is_new: bool,
) -> PyResult<(Bound<'py, PySkin>, Option<Given<'py>>)> {
    py.import("quasirigid.skin.product")?
        .getattr("product_skin")?
        .call1((material, response, is_new))?
        .extract()
}

/// The facade's `Material` of an obstacle; None of a rigid one.
pub(super) fn material_out<'py>(py: Python<'py>, obstacle: &Obstacle) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(material) = obstacle.material() else { return Ok(None) };
    let (kind, arguments) = match (material.given(), material.kernel().map(|skin| skin.kernel())) {
        (Some(given), _) => {
            let arguments = PyDict::new(py);
            arguments.set_item("nodes", nodes_out(py, given.nodes().list()))?;
            arguments.set_item("compliance", matrix_out(py, given.response_matrix()))?;
            ("GivenMatrix", arguments)
        }
        (None, Some(&Kernel::GaussianCorrected { height, width, cutoff })) => {
            let arguments = [("height", height), ("width", width), ("cutoff", cutoff)];
            ("GaussianCorrected", arguments.into_py_dict(py)?)
        }
        (None, Some(Kernel::Layer { thickness: Thickness::Uniform(thickness) })) => {
            ("Layer", [("thickness", *thickness)].into_py_dict(py)?)
        }
        _ => ("HalfSpace", PyDict::new(py)),
    };
    let response = py.import("quasirigid.skin.response")?.getattr(kind)?.call((), Some(&arguments))?;
    let made = py.import("quasirigid.skin.product")?.getattr("Material")?;
    made.call1((material.shear_modulus(), material.poisson_ratio(), response)).map(Some)
}
