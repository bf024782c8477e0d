//! What a posed hand asks of the crate.

use numpy::PyArray2;
use pyo3::prelude::*;

use crate::hand::{Blending, SkinWeights, SkinningError};
use crate::python::arrays_out::vectors_out;
use crate::python::convert::{index_rows, motions, number_rows};
use crate::python::errors::IntoPyErr;
use crate::python::forked::released;
use crate::python::surface::PySurface;

/// By which joints each vertex of a skin is moved, and how much: checked once, for every pose.
#[pyclass(name = "SkinWeights", module = "quasirigid._core", frozen)]
pub(super) struct PySkinWeights(SkinWeights);

#[pymethods]
impl PySkinWeights {
    #[new]
    #[pyo3(signature = (joints, weights, *, joint_count))]
    fn new(joints: &Bound<'_, PyAny>, weights: &Bound<'_, PyAny>, joint_count: usize) -> PyResult<Self> {
        let ((joints, columns), (weights, per_vertex)) =
            (index_rows(joints, "joints")?, number_rows(weights, "weights")?);
        if columns != per_vertex {
            let lengths = SkinningError::Lengths { joints: joints.len(), weights: weights.len() };
            return Err(lengths.into_py_err());
        }
        let checked = SkinWeights::new(&joints, &weights, per_vertex, joint_count);
        checked.map(Self).map_err(IntoPyErr::into_py_err)
    }

    /// The surface after motions (J, 4, 4) of its joints, its faces not checked again.
    #[pyo3(signature = (surface, motions, *, linear=false))]
    fn posed(
        &self,
        py: Python<'_>,
        surface: &PySurface,
        motions: &Bound<'_, PyAny>,
        linear: bool,
    ) -> PyResult<PySurface> {
        let motions = self::motions(motions, "motions")?;
        let blending = if linear { Blending::Linear } else { Blending::DualQuaternion };
        let surface = &surface.inner;
        let posed = released(py, || {
            let moved = self.0.move_vertices(surface.vertices(), &motions, blending)?;
            Ok::<_, SkinningError>(surface.with_vertices(moved))
        });
        posed.map(PySurface::from).map_err(IntoPyErr::into_py_err)
    }

    /// Where the vertices (n, 3) of a surface are after that, without normals and areas, which take most of the time.
    fn moved<'py>(
        &self,
        py: Python<'py>,
        surface: &PySurface,
        motions: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motions = self::motions(motions, "motions")?;
        let surface = &surface.inner;
        let moved =
            released(py, || self.0.move_vertices(surface.vertices(), &motions, Blending::DualQuaternion));
        moved.map(|moved| vectors_out(py, &moved)).map_err(IntoPyErr::into_py_err)
    }
}
