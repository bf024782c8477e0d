//! `quasirigid.Skin`, prepared skins and combinations of them, as the core keeps them.

use super::body::{PartIn, combined};
use super::convert::{
    MatrixIn, faces_out, mask, matrix_out, matrix3, nodes, nodes_out, scalars, vector, vectors, vectors_out,
};
use super::errors::{IntoPyErr, ResponseError};
use super::interrupt::{detached, detached_on_thread};
use super::surface::PySurface;
use crate::geometry::rigid_motion;
use crate::response::body::{Body, BodyCompliance, BodyCost, BodyOptions, BodyParts, BodyProgress};
use crate::response::{
    self, AssemblyOptions, CombinedSkin, ElasticSkin, Gap, PreparedResponse, PreparedSkin, Pressure,
    Response, Skin, Thickness,
};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, OnceLock};

/// Material and response, checked; computed as it is needed, or once.
#[pyclass(name = "Skin", module = "quasirigid._core", frozen)]
pub(super) struct PySkin {
    inner: Elastic,
}

enum Elastic {
    Computed(Skin),
    Prepared(PreparedSkin),
    Combined(CombinedSkin),
}

fn pressure_named(name: &str) -> PyResult<Pressure> {
    match name {
        "linear" => Ok(Pressure::Linear),
        "one_ring" => Ok(Pressure::OneRing),
        other => {
            Err(PyValueError::new_err(format!("pressure is {other:?}, expected \"linear\" or \"one_ring\"")))
        }
    }
}

fn gap_named(name: &str) -> PyResult<Gap> {
    match name {
        "node" => Ok(Gap::Node),
        "weighted" => Ok(Gap::Weighted),
        other => {
            let message = format!("gap is {other:?}, expected \"node\" or \"weighted\"");
            Err(PyValueError::new_err(message))
        }
    }
}

fn made(shear_modulus: f64, poisson_ratio: f64, response: Response) -> PyResult<PySkin> {
    Skin::new(shear_modulus, poisson_ratio, response)
        .map(|skin| PySkin { inner: Elastic::Computed(skin) })
        .map_err(IntoPyErr::into_py_err)
}

fn prepared(skin: Result<PreparedSkin, response::ResponseError>) -> PyResult<PySkin> {
    skin.map(|skin| PySkin { inner: Elastic::Prepared(skin) }).map_err(IntoPyErr::into_py_err)
}

impl PySkin {
    pub(super) fn elastic(&self) -> &dyn ElasticSkin {
        match &self.inner {
            Elastic::Computed(skin) => skin,
            Elastic::Prepared(skin) => skin,
            Elastic::Combined(skin) => skin,
        }
    }

    pub(super) fn computed(&self) -> PyResult<&Skin> {
        match &self.inner {
            Elastic::Computed(skin) => Ok(skin),
            _ => Err(ResponseError::new_err("this skin is prepared already")),
        }
    }

    pub(super) fn prepared(&self) -> PyResult<&PreparedSkin> {
        match &self.inner {
            Elastic::Prepared(skin) => Ok(skin),
            _ => Err(ResponseError::new_err("this skin is not prepared for one surface")),
        }
    }
}

#[pymethods]
impl PySkin {
    #[staticmethod]
    fn half_space(shear_modulus: f64, poisson_ratio: f64, pressure: &str, gap: &str) -> PyResult<Self> {
        let (pressure, gap) = (pressure_named(pressure)?, gap_named(gap)?);
        made(shear_modulus, poisson_ratio, Response::HalfSpace { pressure, gap })
    }

    #[staticmethod]
    fn gaussian_corrected(
        shear_modulus: f64,
        poisson_ratio: f64,
        height: f64,
        width: f64,
        cutoff: f64,
        pressure: &str,
    ) -> PyResult<Self> {
        let pressure = pressure_named(pressure)?;
        made(shear_modulus, poisson_ratio, Response::GaussianCorrected { height, width, cutoff, pressure })
    }

    #[staticmethod]
    fn layer(
        shear_modulus: f64,
        poisson_ratio: f64,
        thickness: &Bound<'_, PyAny>,
        pressure: &str,
        gap: &str,
    ) -> PyResult<Self> {
        let thickness = match thickness.extract::<f64>() {
            Ok(uniform) => Thickness::Uniform(uniform),
            Err(_) => Thickness::PerVertex(scalars(thickness, "thickness")?.into()),
        };
        let (pressure, gap) = (pressure_named(pressure)?, gap_named(gap)?);
        made(shear_modulus, poisson_ratio, Response::Layer { thickness, pressure, gap })
    }

    /// What a user should know of the constants, or None.
    fn caution(&self) -> Option<String> {
        match &self.inner {
            Elastic::Computed(skin) => skin.caution(),
            _ => None,
        }
    }

    /// Height of the Gaussian that keeps volume (m/N).
    #[staticmethod]
    fn balanced_height(shear_modulus: f64, poisson_ratio: f64, width: f64, cutoff: f64) -> PyResult<f64> {
        let half_space = Response::HalfSpace { pressure: Pressure::Linear, gap: Gap::Node };
        let skin = Skin::new(shear_modulus, poisson_ratio, half_space).map_err(IntoPyErr::into_py_err)?;
        response::balanced_height(skin.kernel_constant(), width, cutoff).map_err(IntoPyErr::into_py_err)
    }

    /// Net and gross volume that the mesh moves per newton at a vertex (m^3/N).
    fn net_volume(&self, surface: &PySurface, node: usize) -> PyResult<(f64, f64)> {
        // a sum of both signs over the whole mesh asks for more digits than a matrix does, and takes one column
        let options = AssemblyOptions { tolerance: 1e-9, ..AssemblyOptions::default() };
        let volume = response::net_volume(&surface.inner, self.computed()?, node, &options);
        volume.map(|volume| (volume.net, volume.gross)).map_err(IntoPyErr::into_py_err)
    }

    /// The kernel's matrix over `nodes`, computed once.
    fn prepare(&self, py: Python<'_>, surface: &PySurface, nodes: &Bound<'_, PyAny>) -> PyResult<Self> {
        let skin = self.computed()?;
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len())?;
        prepared(detached(py, |interrupt| {
            let options = AssemblyOptions { interrupt: Some(interrupt), ..AssemblyOptions::default() };
            PreparedSkin::of_kernel(&surface.inner, skin, &nodes, &options)
        })?)
    }

    /// The kernel's matrix over `nodes`, as stored.
    fn restore(
        &self,
        surface: &PySurface,
        nodes: &Bound<'_, PyAny>,
        matrix: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len())?;
        let matrix = Arc::new(MatrixIn::new(matrix, "matrix")?.view().to_owned());
        let skin = self.computed()?.clone();
        prepared(PreparedSkin::new(&surface.inner, &nodes, PreparedResponse::Kernel { skin, matrix }))
    }

    /// A matrix that somebody else computed or measured.
    #[staticmethod]
    fn given(surface: &PySurface, nodes: &Bound<'_, PyAny>, matrix: &Bound<'_, PyAny>) -> PyResult<Self> {
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len())?;
        let matrix = Arc::new(MatrixIn::new(matrix, "compliance")?.view().to_owned());
        prepared(PreparedSkin::new(&surface.inner, &nodes, PreparedResponse::Given(matrix)))
    }

    /// A body solved for unit forces at `nodes`; what `progress` raises ends the work and is raised here.
    #[staticmethod]
    #[pyo3(signature = (surface, shear_modulus, poisson_ratio, bone, fixed, nodes, *, bone_pressure, num_threads, memory_limit, progress))]
    #[expect(clippy::too_many_arguments, reason = "a call has the arguments that it has")]
    fn body(
        py: Python<'_>,
        surface: &PySurface,
        shear_modulus: f64,
        poisson_ratio: f64,
        bone: Option<&PySurface>,
        fixed: Option<&Bound<'_, PyAny>>,
        nodes: &Bound<'_, PyAny>,
        bone_pressure: bool,
        num_threads: Option<usize>,
        memory_limit: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let fixed = fixed.map(|value| mask(value, "fixed")).transpose()?;
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len())?;
        let body = Body { bone: bone.map(|bone| bone.inner.clone()), fixed };
        let failure = OnceLock::new();
        let report = |told: BodyProgress| {
            if let (Some(progress), None) = (&progress, failure.get())
                && let Err(error) = Python::attach(|py| progress.call1(py, (told.stage, told.done)))
            {
                // The first failure ends the work and is raised then; others have nothing to add.
                let _ = failure.set(error);
            }
        };
        let done = detached_on_thread(py, |interrupt| {
            let stop = || failure.get().is_some() || interrupt();
            let options = BodyOptions {
                num_threads,
                memory_limit,
                bone_pressure,
                interrupt: Some(&stop),
                progress: progress.is_some().then_some(&report as _),
                ..BodyOptions::default()
            };
            PreparedSkin::of_body(&surface.inner, &body, shear_modulus, poisson_ratio, &nodes, &options)
        })?;
        failure.into_inner().map_or_else(|| prepared(done), Err)
    }

    /// Blocks of a body, or of somebody else where `solved` is false: `displacement` (3 n, 3 k), `area_vectors` (n, 3)
    /// and `bone_pressure` (m, 3 k) as stored, turned by `rotation` since.
    #[staticmethod]
    #[pyo3(signature = (surface, shear_modulus, poisson_ratio, nodes, displacement, area_vectors, rotation, *, bone_pressure, solved))]
    #[expect(clippy::too_many_arguments, reason = "a call has the arguments that it has")]
    fn restore_body(
        surface: &PySurface,
        shear_modulus: f64,
        poisson_ratio: f64,
        nodes: &Bound<'_, PyAny>,
        displacement: &Bound<'_, PyAny>,
        area_vectors: &Bound<'_, PyAny>,
        rotation: &Bound<'_, PyAny>,
        bone_pressure: Option<&Bound<'_, PyAny>>,
        solved: bool,
    ) -> PyResult<Self> {
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len())?;
        let bone_pressure = bone_pressure
            .map(|value| Ok::<_, PyErr>(MatrixIn::new(value, "bone_pressure")?.view().to_owned()));
        let rotation = matrix3(rotation, "rotation")?;
        let displacement = MatrixIn::new(displacement, "displacement")?.view().to_owned();
        let area_vectors = vectors(area_vectors, "area_vectors")?;
        let compliance = BodyCompliance::from_parts(BodyParts {
            nodes: nodes.clone(),
            displacement,
            area_vectors,
            bone_pressure: bone_pressure.transpose()?,
            rotation,
            shear_modulus,
            poisson_ratio,
        });
        let compliance = compliance.map_err(|error| ResponseError::new_err(error.to_string()))?;
        let response = match solved {
            true => PreparedResponse::Body(compliance),
            false => PreparedResponse::GivenBlocks(compliance),
        };
        prepared(PreparedSkin::new(&surface.inner, &nodes, response))
    }

    /// Prepared bodies on parts of a surface, a kernel elsewhere.
    #[staticmethod]
    fn combined(surface: &PySurface, elsewhere: &PySkin, parts: Vec<PartIn<'_>>) -> PyResult<Self> {
        Ok(PySkin { inner: Elastic::Combined(combined(surface, elsewhere, parts)?) })
    }

    /// Pressure (m,) in Pa on the bone under forces (n, 3) in N at the vertices; None if it was not asked for.
    fn bone_pressures<'py>(
        &self,
        py: Python<'py>,
        forces: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let forces = vectors(forces, "forces")?;
        let pressures = self.prepared()?.bone_pressures(&forces).map_err(IntoPyErr::into_py_err)?;
        Ok(pressures.map(|pressures| PyArray1::from_vec(py, pressures)))
    }

    /// Memory (bytes) and operations that `body` would take, before it is asked for.
    #[staticmethod]
    fn body_cost(skin_vertices: usize, bone_vertices: usize, nodes: usize) -> (usize, f64) {
        let cost = BodyCost::estimate(skin_vertices, bone_vertices, nodes);
        (cost.peak_bytes, cost.flops)
    }

    /// Vertices whose response is known.
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        Ok(nodes_out(py, self.prepared()?.nodes()))
    }

    /// The prepared or combined skin after a rigid motion of its surface.
    fn moved(&self, rotation: &Bound<'_, PyAny>, translation: &Bound<'_, PyAny>) -> PyResult<Self> {
        let motion = rigid_motion(&matrix3(rotation, "rotation")?, &vector(translation, "translation")?)
            .map_err(|error| ResponseError::new_err(error.to_string()))?;
        if let Elastic::Combined(skin) = &self.inner {
            let moved = skin.moved(&motion).map_err(IntoPyErr::into_py_err)?;
            return Ok(PySkin { inner: Elastic::Combined(moved) });
        }
        prepared(self.prepared()?.moved(&motion))
    }

    /// Whether the surface is the one that this skin fits.
    fn check_surface(&self, surface: &PySurface) -> PyResult<()> {
        self.elastic().check_surface(&surface.inner).map_err(IntoPyErr::into_py_err)
    }

    /// Arrays of a prepared skin: nodes, vertices, faces, and matrix or displacement and rotation.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let skin = self.prepared()?;
        let parts = PyDict::new(py);
        parts.set_item("nodes", nodes_out(py, skin.nodes()))?;
        parts.set_item("vertices", vectors_out(py, skin.vertices()))?;
        parts.set_item("faces", faces_out(py, skin.faces()))?;
        match skin.response() {
            PreparedResponse::Kernel { matrix, .. } | PreparedResponse::Given(matrix) => {
                parts.set_item("matrix", matrix_out(py, matrix))?;
            }
            PreparedResponse::Body(compliance) | PreparedResponse::GivenBlocks(compliance) => {
                if let Some(bone_pressure) = &compliance.parts().bone_pressure {
                    parts.set_item("bone_pressure", matrix_out(py, bone_pressure))?;
                }
                parts.set_item("displacement", matrix_out(py, &compliance.parts().displacement))?;
                parts.set_item("area_vectors", vectors_out(py, &compliance.parts().area_vectors))?;
                let rotation = compliance.rotation();
                let rows: Vec<_> = (0..3).map(|row| rotation.row(row).transpose()).collect();
                parts.set_item("rotation", vectors_out(py, &rows))?;
            }
        }
        Ok(parts)
    }
}
