//! Materials of products, from and to the facade's `Material`.

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::obstacle::material::CheckedResponse;
use crate::obstacle::{Obstacle, ProductResponse};
use crate::python::arrays_out::{matrix_out, nodes_out};
use crate::python::convert::{MatrixArgument, nodes};
use crate::python::errors::{IntoPyErr, ResponseError};
use crate::python::forked::released;
use crate::python::skin::PySkin;
use crate::response::{Kernel, Thickness};

/// Nodes and compliance of a given matrix.
type NodesAndMatrix<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// The kernel of a product's response, built by the facade, and its given matrix if it has one; a new one warns of a kernel
/// that is not well posed.
fn product_skin<'py>(
    py: Python<'py>,
    material: (f64, f64),
    response: Option<&Bound<'py, PyAny>>,
    is_new: bool,
) -> PyResult<(Bound<'py, PySkin>, Option<NodesAndMatrix<'py>>)> {
    py.import("quasirigid.skin.product")?
        .getattr("product_skin")?
        .call1((material, response, is_new))?
        .extract()
}

/// A copy of an obstacle that is made of a material; a new one warns of a response that is not well posed.
pub(super) fn made_of(
    py: Python<'_>,
    obstacle: &Obstacle,
    constants: (f64, f64),
    response: Option<&Bound<'_, PyAny>>,
    is_new: bool,
) -> PyResult<Obstacle> {
    let (kernel, given) = product_skin(py, constants, response, is_new)?;
    let refuse: fn(String) -> PyErr = ResponseError::new_err;
    let response = match given {
        None => ProductResponse::Kernel(kernel.get().inner().kernel()?.kernel().clone()),
        Some((nodes, compliance)) => {
            let count = obstacle.triangles().map_or(usize::MAX, |(vertices, _)| vertices.len());
            ProductResponse::Matrix {
                nodes: self::nodes(&nodes, "nodes", count, refuse)?,
                matrix: MatrixArgument::new(&compliance, "compliance", refuse)?.view().to_owned(),
            }
        }
    };
    released(py, || obstacle.with_material(constants.0, constants.1, response))
        .map_err(IntoPyErr::into_py_err)
}

/// The facade's `Material` of an obstacle; None of a rigid one.
pub(super) fn material_out<'py>(py: Python<'py>, obstacle: &Obstacle) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(material) = obstacle.material() else { return Ok(None) };
    let (kind, arguments) = match &material.response {
        CheckedResponse::Matrix(given) => {
            let arguments = PyDict::new(py);
            arguments.set_item("nodes", nodes_out(py, given.nodes().list()))?;
            arguments.set_item("compliance", matrix_out(py, given.response_matrix()))?;
            ("GivenMatrix", arguments)
        }
        CheckedResponse::Kernel(skin) => match skin.kernel() {
            Kernel::GaussianCorrected { height, width, cutoff } => {
                let arguments = [("height", height), ("width", width), ("cutoff", cutoff)];
                ("GaussianCorrected", arguments.into_py_dict(py)?)
            }
            Kernel::Layer { thickness: Thickness::Uniform(thickness) } => {
                ("Layer", [("thickness", thickness)].into_py_dict(py)?)
            }
            Kernel::Layer { thickness: Thickness::PerVertex(_) } => {
                unreachable!("a product's layer has one thickness")
            }
            Kernel::HalfSpace => ("HalfSpace", PyDict::new(py)),
        },
    };
    let response = py.import("quasirigid.skin.response")?.getattr(kind)?.call((), Some(&arguments))?;
    let made = py.import("quasirigid.skin.product")?.getattr("Material")?;
    made.call1((material.shear_modulus(), material.poisson_ratio(), response)).map(Some)
}
