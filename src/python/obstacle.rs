//! `quasirigid.Obstacle`.

use super::convert::{faces, faces_out, matrix3, vector, vector_out, vectors, vectors_out};
use super::errors::IntoPyErr;
use crate::obstacle::{MeshObstacleOptions, Obstacle};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

/// A rigid product at a pose: a closed mesh or a primitive.
#[pyclass(name = "Obstacle", module = "quasirigid", frozen, weakref)]
pub(super) struct PyObstacle {
    pub inner: Obstacle,
}

fn made(obstacle: Result<Obstacle, crate::obstacle::ObstacleError>) -> PyResult<PyObstacle> {
    obstacle.map(PyObstacle::from).map_err(IntoPyErr::into_py_err)
}

impl From<Obstacle> for PyObstacle {
    fn from(inner: Obstacle) -> Self {
        Self { inner }
    }
}

type Triangles<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>);
type Distances<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl PyObstacle {
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, *, check_crossings=true), text_signature = "(vertices, faces, *, check_crossings=True)")]
    fn mesh(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        check_crossings: bool,
    ) -> PyResult<Self> {
        let vertices = vectors(vertices, "vertices")?;
        let faces = self::faces(faces, "faces")?;
        made(py.detach(|| Obstacle::mesh(vertices, faces, &MeshObstacleOptions { check_crossings })))
    }

    #[staticmethod]
    #[pyo3(text_signature = "(point, normal)")]
    fn half_space(point: &Bound<'_, PyAny>, normal: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Obstacle::half_space(vector(point, "point")?, vector(normal, "normal")?))
    }

    #[staticmethod]
    #[pyo3(text_signature = "(center, radius)")]
    fn sphere(center: &Bound<'_, PyAny>, radius: f64) -> PyResult<Self> {
        made(Obstacle::sphere(vector(center, "center")?, radius))
    }

    #[staticmethod]
    #[pyo3(name = "box", text_signature = "(half_extents)")]
    fn cuboid(half_extents: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Obstacle::cuboid(vector(half_extents, "half_extents")?))
    }

    #[staticmethod]
    #[pyo3(text_signature = "(a, b, radius)")]
    fn capsule(a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>, radius: f64) -> PyResult<Self> {
        made(Obstacle::capsule(vector(a, "a")?, vector(b, "b")?, radius))
    }

    #[staticmethod]
    #[pyo3(text_signature = "(half_height, radius)")]
    fn cylinder(half_height: f64, radius: f64) -> PyResult<Self> {
        made(Obstacle::cylinder(half_height, radius))
    }

    #[pyo3(text_signature = "(self, rotation, translation)")]
    fn moved(&self, rotation: &Bound<'_, PyAny>, translation: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(self.inner.moved(&matrix3(rotation, "rotation")?, &vector(translation, "translation")?))
    }

    #[pyo3(signature = (points, max_distance=None), text_signature = "(self, points, max_distance=None)")]
    fn signed_distance<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        max_distance: Option<f64>,
    ) -> PyResult<Distances<'py>> {
        let points = vectors(points, "points")?;
        let answer = py
            .detach(|| self.inner.signed_distance(&points, max_distance))
            .map_err(IntoPyErr::into_py_err)?;
        Ok((
            PyArray1::from_vec(py, answer.distance),
            vectors_out(py, &answer.closest),
            vectors_out(py, &answer.normal),
        ))
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.inner.kind()
    }

    /// Lowest and highest corner in the world (2, 3), or None for a half-space.
    #[getter]
    fn bounding_box<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.inner.bounding_box().map(|(low, high)| vectors_out(py, &[low, high]))
    }

    /// Vertices and faces of a mesh obstacle in the world, or None for a primitive.
    fn triangles<'py>(&self, py: Python<'py>) -> Option<Triangles<'py>> {
        self.inner.triangles().map(|(vertices, faces)| (vectors_out(py, &vertices), faces_out(py, &faces)))
    }

    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let rotation = self.inner.pose().rotation.to_rotation_matrix();
        let rows: Vec<_> = (0..3).map(|row| rotation.matrix().row(row).transpose()).collect();
        vectors_out(py, &rows)
    }

    #[getter]
    fn translation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector_out(py, &self.inner.pose().translation.vector)
    }

    fn __repr__(&self) -> String {
        let at = self.inner.pose().translation.vector;
        format!("Obstacle({} at ({:.6}, {:.6}, {:.6}) m)", self.inner.kind(), at.x, at.y, at.z)
    }
}
