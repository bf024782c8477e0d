//! Prepared skins to their arrays and back, equal to the bit.

use std::sync::Arc;

use nalgebra::Vector3;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::python::arrays_out::{faces_out, matrix_out, nodes_out, rotation_out, vectors_out};
use crate::python::convert::{MatrixArgument, faces, mask, matrix3, nodes, scalars, vectors};
use crate::python::elastic::{Elastic, discretization_of};
use crate::python::errors::{IntoPyErr, ResponseError};
use crate::python::forked::released;
use crate::python::skin::PySkin;
use crate::python::surface::PySurface;
use crate::response::body::{BodyCompliance, BodyError, BodyParts, OneLevel, TwoLevels};
use crate::response::{Levels, PreparedBody};
use crate::surface::CoarsePlace;

/// Of a body on two levels: loaded vertices of the coarse skin, places on it, its edges there, vertices that are held.
type LevelsArgument<'py> =
    (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Arrays of a prepared skin: nodes, vertices, faces, and matrix or displacement and rotation.
#[pyfunction]
pub(super) fn skin_parts<'py>(py: Python<'py>, skin: &PySkin) -> PyResult<Bound<'py, PyDict>> {
    let nodes = skin.inner().nodes()?;
    let parts = PyDict::new(py);
    parts.set_item("nodes", nodes_out(py, nodes.list()))?;
    parts.set_item("vertices", vectors_out(py, nodes.surface().vertices()))?;
    parts.set_item("faces", faces_out(py, nodes.surface().faces()))?;
    match skin.inner() {
        Elastic::PreparedKernel(skin) => {
            parts.set_item("matrix", matrix_out(py, skin.response_matrix()))?;
        }
        Elastic::Given(skin) => parts.set_item("matrix", matrix_out(py, skin.response_matrix()))?,
        Elastic::GivenBlocks(skin) => set_blocks(&parts, skin.compliance())?,
        Elastic::Body(skin) => {
            let compliance = skin.levels().compliance();
            if let Some(thickness) = skin.levels().thickness() {
                parts.set_item("tissue_thickness", PyArray1::from_slice(py, thickness))?;
            }
            if let Some(bone_pressure) = &compliance.parts().bone_pressure {
                parts.set_item("bone_pressure", matrix_out(py, bone_pressure))?;
            }
            set_blocks(&parts, compliance)?;
            if let Levels::Two(two) = skin.levels() {
                let corners: Vec<[u32; 3]> = two.places.iter().map(|place| place.corners).collect();
                let weights: Vec<Vector3<f64>> =
                    two.places.iter().map(|place| place.weights.into()).collect();
                parts.set_item("coarse_nodes", nodes_out(py, two.remainder.nodes()))?;
                parts.set_item("coarse_corners", faces_out(py, &corners))?;
                parts.set_item("coarse_weights", vectors_out(py, &weights))?;
                parts.set_item("coarse_edges", PyArray1::from_slice(py, &two.coarse_edges))?;
                parts.set_item("held", PyArray1::from_slice(py, &two.fixed))?;
            }
        }
        Elastic::Kernel(_) | Elastic::Combined(_) => {}
    }
    Ok(parts)
}

/// Adds blocks as they are stored, and how they have turned since.
fn set_blocks(parts: &Bound<'_, PyDict>, compliance: &BodyCompliance) -> PyResult<()> {
    let py = parts.py();
    parts.set_item("displacement", matrix_out(py, &compliance.parts().displacement))?;
    parts.set_item("rotation", rotation_out(py, compliance.rotation()))
}

/// Blocks of a body: `displacement` (3 n, 3 k) and `bone_pressure` (m, 3 k) as
/// stored, turned by `rotation` since.
#[pyfunction]
#[pyo3(signature = (surface, shear_modulus, poisson_ratio, nodes, displacement, rotation, *, discretization, bone_pressure, tissue_thickness, levels))]
#[expect(clippy::too_many_arguments, reason = "a call has the arguments that it has")]
pub(super) fn restore_body(
    surface: &PySurface,
    shear_modulus: f64,
    poisson_ratio: f64,
    nodes: &Bound<'_, PyAny>,
    displacement: &Bound<'_, PyAny>,
    rotation: &Bound<'_, PyAny>,
    discretization: Option<&str>,
    bone_pressure: Option<&Bound<'_, PyAny>>,
    tissue_thickness: Option<&Bound<'_, PyAny>>,
    levels: Option<LevelsArgument<'_>>,
) -> PyResult<PySkin> {
    let (py, discretization) = (nodes.py(), discretization_of(discretization)?);
    let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
    let matrix = |value: &Bound<'_, PyAny>, name| {
        Ok::<_, PyErr>(MatrixArgument::new(value, name, ResponseError::new_err)?.view().to_owned())
    };
    let bone_pressure = bone_pressure.map(|value| matrix(value, "bone_pressure"));
    let rotation = matrix3(rotation, "rotation")?;
    let displacement = matrix(displacement, "displacement")?;
    let loaded = match &levels {
        None => nodes.clone(),
        Some(levels) => {
            self::nodes(&levels.0, "coarse_nodes", displacement.nrows() / 3, ResponseError::new_err)?
        }
    };
    let parts = BodyParts {
        nodes: loaded,
        displacement,
        bone_pressure: bone_pressure.transpose()?,
        rotation,
        shear_modulus,
        poisson_ratio,
    };
    let compliance = released(py, || BodyCompliance::from_parts(parts))
        .map_err(|error| ResponseError::new_err(error.to_string()))?;
    let thickness = tissue_thickness.map(|list| scalars(list, "tissue_thickness")).transpose()?;
    let thickness = thickness.map(Into::into);
    let levels = match levels {
        None => Levels::One(OneLevel { compliance, thickness }),
        Some(levels) => Levels::Two(two_levels(py, compliance, thickness, levels)?),
    };
    let body = released(py, || PreparedBody::from_levels(&surface.inner, &nodes, levels));
    let body = body.map_err(IntoPyErr::into_py_err)?;
    Ok(Elastic::Body(body.with_discretization(discretization)).into())
}

fn two_levels(
    py: Python<'_>,
    remainder: BodyCompliance,
    thickness: Option<Arc<[f64]>>,
    (_, corners, weights, edges, fixed): LevelsArgument<'_>,
) -> PyResult<TwoLevels> {
    let corners = faces(&corners, "coarse_corners", ResponseError::new_err)?;
    let weights = vectors(&weights, "coarse_weights")?;
    let (what, found, expected) = ("coarse weights", weights.len(), corners.len());
    if found != expected {
        return Err(ResponseError::new_err(BodyError::Parts { what, found, expected }.to_string()));
    }
    let place = |(corners, weights): (_, Vector3<f64>)| CoarsePlace { corners, weights: weights.into() };
    let places = corners.into_iter().zip(weights).map(place).collect();
    let edges = scalars(&edges, "coarse_edges")?.into();
    let fixed = mask(&fixed, "fixed")?.into();
    let two = released(py, || TwoLevels::from_parts(remainder, places, thickness, edges, fixed));
    two.map_err(IntoPyErr::into_py_err)
}
