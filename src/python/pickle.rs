//! Obstacles to pickles and back, equal to the bit.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use pyo3::prelude::*;

use crate::obstacle::{MeshObstacleOptions, Obstacle, Primitive};
use crate::python::arrays_out::{faces_out, vectors_out};
use crate::python::convert::{faces, vectors};
use crate::python::errors::{IntoPyErr, ObstacleError};
use crate::python::forked::released;
use crate::python::material::material_out;

/// Quaternion i, j, k, w and translation (m).
pub(super) type Pose = [f64; 7];

/// The function that restores, and its arguments: kind, mesh or numbers of the primitive, pose, material.
pub(super) type Reduced<'py> =
    (Bound<'py, PyAny>, (&'static str, Bound<'py, PyAny>, Pose, Option<Bound<'py, PyAny>>));

/// What pickle asks of an obstacle.
pub(super) fn reduced<'py>(py: Python<'py>, obstacle: &Obstacle) -> PyResult<Reduced<'py>> {
    let shape = match obstacle.own_triangles() {
        Some((vertices, faces)) => {
            (vectors_out(py, vertices), faces_out(py, faces)).into_pyobject(py)?.into_any()
        }
        None => numbers(obstacle.primitive().expect("mesh or primitive")).into_pyobject(py)?.into_any(),
    };
    let pose = obstacle.pose();
    let (turn, shift) = (pose.rotation.coords, pose.translation.vector);
    let pose = [turn.x, turn.y, turn.z, turn.w, shift.x, shift.y, shift.z];
    let restore = py.import("quasirigid._core")?.getattr("restore_obstacle")?;
    Ok((restore, (obstacle.kind(), shape, pose, material_out(py, obstacle)?)))
}

fn numbers(primitive: &Primitive) -> Vec<f64> {
    match primitive {
        Primitive::HalfSpace { point, normal } => flat(&[point, normal], &[]),
        Primitive::Sphere { center, radius } => flat(&[center], &[*radius]),
        Primitive::Cuboid { half_extents } => flat(&[half_extents], &[]),
        Primitive::Capsule { a, b, radius } => flat(&[a, b], &[*radius]),
        Primitive::Cylinder { half_height, radius } => vec![*half_height, *radius],
    }
}

fn flat(vectors: &[&Vector3<f64>], numbers: &[f64]) -> Vec<f64> {
    vectors.iter().flat_map(|vector| vector.iter()).chain(numbers).copied().collect()
}

/// The obstacle of a pickle: kind, mesh or numbers of the primitive, pose.
///
/// A mesh is checked again, but not for faces that cross: that was done, or waived, when it was made.
pub(super) fn restored(kind: &str, shape: &Bound<'_, PyAny>, pose: Pose) -> PyResult<Obstacle> {
    let at_rest = if kind == "mesh" {
        let (vertices, triangles): (Bound<'_, PyAny>, Bound<'_, PyAny>) = shape.extract()?;
        let vertices = vectors(&vertices, "vertices")?;
        let triangles = faces(&triangles, "faces", ObstacleError::new_err)?;
        let unchecked = MeshObstacleOptions { check_crossings: false };
        released(shape.py(), || Obstacle::mesh(vertices, triangles, &unchecked))
            .map_err(IntoPyErr::into_py_err)?
    } else {
        let numbers: Vec<f64> = shape.extract()?;
        let primitive = primitive(kind, &numbers).ok_or_else(|| {
            ObstacleError::new_err(format!("no obstacle is a {kind:?} of {} numbers", numbers.len()))
        })?;
        Obstacle::of_primitive(primitive)
    };
    let [i, j, k, w, x, y, z] = pose;
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
    Ok(at_rest.at(Isometry3::from_parts(Translation3::new(x, y, z), turn)))
}

fn primitive(kind: &str, numbers: &[f64]) -> Option<Primitive> {
    let vector = |first: usize| Vector3::from_column_slice(&numbers[first..first + 3]);
    Some(match (kind, numbers.len()) {
        ("half_space", 6) => Primitive::HalfSpace { point: vector(0), normal: vector(3) },
        ("sphere", 4) => Primitive::Sphere { center: vector(0), radius: numbers[3] },
        ("box", 3) => Primitive::Cuboid { half_extents: vector(0) },
        ("capsule", 7) => Primitive::Capsule { a: vector(0), b: vector(3), radius: numbers[6] },
        ("cylinder", 2) => Primitive::Cylinder { half_height: numbers[0], radius: numbers[1] },
        _ => return None,
    })
}
