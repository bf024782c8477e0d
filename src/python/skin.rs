//! `quasirigid.Skin`, prepared skins and combinations of them, as the core keeps them.

use super::convert::{
    MatrixArgument, faces, faces_out, mask, matrix_out, matrix3, nodes, nodes_out, rotation_and_translation,
    scalars, vectors, vectors_out,
};
use super::elastic::Elastic;
use super::errors::{IntoPyErr, ResponseError};
use super::forked::released;
use super::interrupt::{detached, detached_on_thread};
use super::surface::PySurface;
use crate::geometry::rigid_motion;
use crate::response::body::{
    Body, BodyCompliance, BodyError, BodyOptions, BodyParts, BodyProgress, OneLevel, TwoLevels,
};
use crate::response::{
    self, AssemblyOptions, CombinedSkin, ElasticSkin, GivenMatrix, Kernel, KernelSkin, Levels, Part,
    PreparedBody, PreparedKernel, Thickness,
};
use crate::surface::CoarsePlace;
use nalgebra::Vector3;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Material and response, checked; computed as it is needed, or once.
#[pyclass(name = "Skin", module = "quasirigid._core", frozen)]
pub(super) struct PySkin {
    inner: Elastic,
}

/// Name, prepared body, vertex of the part for each of the whole (-1 for none), and the part's fixed vertices.
type PartArgument<'py> = (String, Bound<'py, PySkin>, Vec<i64>, Bound<'py, PyAny>);

/// Of a body on two levels: loaded vertices of the coarse skin, places on it, its edges there, vertices that are held.
type LevelsArgument<'py> =
    (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

impl From<Elastic> for PySkin {
    fn from(inner: Elastic) -> Self {
        Self { inner }
    }
}

impl PySkin {
    pub(super) fn elastic(&self) -> &dyn ElasticSkin {
        self.inner.as_skin()
    }

    pub(super) fn kernel(&self) -> PyResult<&KernelSkin> {
        self.inner.kernel()
    }

    /// The skin that draws what `skin` solved: of a prepared kernel the kernel, without its matrix.
    pub(super) fn for_drawing(skin: &Bound<'_, Self>) -> PyResult<Py<Self>> {
        match &skin.get().inner {
            Elastic::PreparedKernel(prepared) => {
                Py::new(skin.py(), Self::from(Elastic::Kernel(prepared.kernel().clone())))
            }
            _ => Ok(skin.clone().unbind()),
        }
    }
}

#[pymethods]
impl PySkin {
    #[staticmethod]
    fn half_space(
        shear_modulus: f64,
        poisson_ratio: f64,
        pressure: &str,
        discretization: Option<&str>,
    ) -> PyResult<Self> {
        Ok(Elastic::of_kernel(shear_modulus, poisson_ratio, Kernel::HalfSpace, pressure, discretization)?
            .into())
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
        let kernel = Kernel::GaussianCorrected { height, width, cutoff };
        Ok(Elastic::of_kernel(shear_modulus, poisson_ratio, kernel, pressure, None)?.into())
    }

    #[staticmethod]
    fn layer(
        shear_modulus: f64,
        poisson_ratio: f64,
        thickness: &Bound<'_, PyAny>,
        pressure: &str,
        discretization: Option<&str>,
    ) -> PyResult<Self> {
        let thickness = match thickness.extract::<f64>() {
            Ok(uniform) => Thickness::Uniform(uniform),
            Err(_) => Thickness::PerVertex(scalars(thickness, "thickness")?.into()),
        };
        Ok(Elastic::of_kernel(
            shear_modulus,
            poisson_ratio,
            Kernel::Layer { thickness },
            pressure,
            discretization,
        )?
        .into())
    }

    /// Why the kernel is not well posed, or None.
    fn ill_posedness(&self) -> Option<String> {
        match &self.inner {
            Elastic::Kernel(skin) => skin.ill_posedness(),
            _ => None,
        }
    }

    /// Height of the Gaussian that keeps volume (m/N).
    #[staticmethod]
    fn balanced_height(shear_modulus: f64, poisson_ratio: f64, width: f64, cutoff: f64) -> PyResult<f64> {
        let half_space = Kernel::HalfSpace;
        let skin =
            KernelSkin::new(shear_modulus, poisson_ratio, half_space).map_err(IntoPyErr::into_py_err)?;
        response::balanced_height(skin.kernel_constant(), width, cutoff).map_err(IntoPyErr::into_py_err)
    }

    /// Net and gross volume that the mesh moves per newton at a vertex (m^3/N).
    fn net_volume(&self, py: Python<'_>, surface: &PySurface, node: usize) -> PyResult<(f64, f64)> {
        // a sum of both signs over the whole mesh asks for more digits than a matrix does, and takes one column
        let options = AssemblyOptions { tolerance: 1e-9, ..AssemblyOptions::default() };
        let skin = self.inner.kernel()?;
        let volume = released(py, || response::net_volume(&surface.inner, skin, node, &options));
        volume.map(|volume| (volume.net, volume.gross)).map_err(IntoPyErr::into_py_err)
    }

    /// The kernel's matrix over `nodes`, computed once.
    fn prepare(&self, py: Python<'_>, surface: &PySurface, nodes: &Bound<'_, PyAny>) -> PyResult<Self> {
        let skin = self.inner.kernel()?;
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
        let prepared = detached(py, |interrupt| {
            let options = AssemblyOptions { interrupt: Some(interrupt), ..AssemblyOptions::default() };
            PreparedKernel::new(&surface.inner, skin, &nodes, &options)
        })?;
        Ok(Elastic::PreparedKernel(prepared.map_err(IntoPyErr::into_py_err)?).into())
    }

    /// The kernel's matrix over `nodes`, as stored.
    fn restore(
        &self,
        surface: &PySurface,
        nodes: &Bound<'_, PyAny>,
        matrix: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let py = matrix.py();
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
        let matrix = MatrixArgument::new(matrix, "matrix", ResponseError::new_err)?.view().to_owned();
        let skin = self.inner.kernel()?.clone();
        let prepared = released(py, || PreparedKernel::from_matrix(&surface.inner, skin, &nodes, matrix));
        Ok(Elastic::PreparedKernel(prepared.map_err(IntoPyErr::into_py_err)?).into())
    }

    /// A matrix that somebody else computed or measured.
    #[staticmethod]
    fn given(
        py: Python<'_>,
        surface: &PySurface,
        nodes: &Bound<'_, PyAny>,
        matrix: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
        let matrix = MatrixArgument::new(matrix, "compliance", ResponseError::new_err)?.view().to_owned();
        let given = released(py, || GivenMatrix::new(&surface.inner, &nodes, matrix));
        Ok(Elastic::Given(given.map_err(IntoPyErr::into_py_err)?).into())
    }

    /// A body solved for unit forces at `nodes`; `progress` hears memory and operations first, and what it raises ends the
    /// work and is raised here.
    #[staticmethod]
    #[pyo3(signature = (surface, shear_modulus, poisson_ratio, bone, fixed, nodes, *, coarse_edge_length, bone_pressure, num_threads, memory_limit, progress))]
    #[expect(clippy::too_many_arguments, reason = "a call has the arguments that it has")]
    fn body(
        py: Python<'_>,
        surface: &PySurface,
        shear_modulus: f64,
        poisson_ratio: f64,
        bone: Option<&PySurface>,
        fixed: Option<&Bound<'_, PyAny>>,
        nodes: &Bound<'_, PyAny>,
        coarse_edge_length: Option<f64>,
        bone_pressure: bool,
        num_threads: Option<usize>,
        memory_limit: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let fixed = fixed.map(|value| mask(value, "fixed")).transpose()?;
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
        let body = Body { bone: bone.map(|bone| bone.inner.clone()), fixed, coarse_edge_length };
        let failure = OnceLock::new();
        let announced = AtomicBool::new(false);
        let tell = |progress: &Py<PyAny>, step: BodyProgress| {
            Python::attach(|py| {
                // With the first sign of work, so that a body that is refused says only why.
                if !announced.swap(true, Ordering::Relaxed) {
                    progress.call1(py, (step.cost.to_string(), 0.0))?;
                }
                progress.call1(py, (step.stage, step.done))
            })
        };
        let report = |step: BodyProgress| {
            if let (Some(progress), None) = (&progress, failure.get())
                && let Err(error) = tell(progress, step)
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
            PreparedBody::new(&surface.inner, &body, shear_modulus, poisson_ratio, &nodes, &options)
        })?;
        match failure.into_inner() {
            Some(raised) => Err(raised),
            None => Ok(Elastic::Body(done.map_err(IntoPyErr::into_py_err)?).into()),
        }
    }

    /// Blocks of a body, or of somebody else where `solved` is false: `displacement` (3 n, 3 k), `area_vectors` (n, 3)
    /// and `bone_pressure` (m, 3 k) as stored, turned by `rotation` since.
    #[staticmethod]
    #[pyo3(signature = (surface, shear_modulus, poisson_ratio, nodes, displacement, area_vectors, rotation, *, bone_pressure, tissue_thickness, levels, solved))]
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
        tissue_thickness: Option<&Bound<'_, PyAny>>,
        levels: Option<LevelsArgument<'_>>,
        solved: bool,
    ) -> PyResult<Self> {
        let py = nodes.py();
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
        let matrix = |value: &Bound<'_, PyAny>, name| {
            Ok::<_, PyErr>(MatrixArgument::new(value, name, ResponseError::new_err)?.view().to_owned())
        };
        let bone_pressure = bone_pressure.map(|value| matrix(value, "bone_pressure"));
        let rotation = matrix3(rotation, "rotation")?;
        let displacement = matrix(displacement, "displacement")?;
        let area_vectors = vectors(area_vectors, "area_vectors")?;
        let loaded = match &levels {
            None => nodes.clone(),
            Some(levels) => {
                self::nodes(&levels.0, "coarse_nodes", area_vectors.len(), ResponseError::new_err)?
            }
        };
        let compliance = BodyCompliance::from_parts(BodyParts {
            nodes: loaded,
            displacement,
            area_vectors,
            bone_pressure: bone_pressure.transpose()?,
            rotation,
            shear_modulus,
            poisson_ratio,
        });
        let compliance = compliance.map_err(|error| ResponseError::new_err(error.to_string()))?;
        let thickness = tissue_thickness.map(|list| scalars(list, "tissue_thickness")).transpose()?;
        let thickness = thickness.map(Into::into);
        let levels = match levels {
            None if !solved => Levels::Given(compliance),
            None => Levels::One(OneLevel { compliance, thickness }),
            Some((_, corners, weights, edges, fixed)) => {
                let corners = faces(&corners, "coarse_corners", ResponseError::new_err)?;
                let weights = vectors(&weights, "coarse_weights")?;
                let (what, found, expected) = ("coarse weights", weights.len(), corners.len());
                if found != expected {
                    let error = BodyError::Parts { what, found, expected };
                    return Err(ResponseError::new_err(error.to_string()));
                }
                let place =
                    |(corners, weights): (_, Vector3<f64>)| CoarsePlace { corners, weights: weights.into() };
                let places = corners.into_iter().zip(weights).map(place).collect();
                let edges = scalars(&edges, "coarse_edges")?.into();
                let fixed = mask(&fixed, "fixed")?.into();
                let two = released(py, || TwoLevels::from_parts(compliance, places, thickness, edges, fixed));
                Levels::Two(two.map_err(IntoPyErr::into_py_err)?)
            }
        };
        let body = released(py, || PreparedBody::from_levels(&surface.inner, &nodes, levels));
        let body = body.map_err(IntoPyErr::into_py_err)?;
        Ok(if solved { Elastic::Body(body) } else { Elastic::GivenBlocks(body) }.into())
    }

    /// The same body in another discretization.
    fn with_discretization(&self, discretization: Option<&str>) -> PyResult<Self> {
        Ok(self.inner.with_discretization(discretization)?.into())
    }

    /// Prepared bodies on parts of a surface, a kernel off them.
    #[staticmethod]
    fn combined(
        py: Python<'_>,
        surface: &PySurface,
        background: &PySkin,
        parts: Vec<PartArgument<'_>>,
    ) -> PyResult<Self> {
        let part = |(name, prepared, part_vertices, fixed): PartArgument<'_>| {
            Ok(Part {
                prepared: prepared.get().inner.body_part(&name)?.clone(),
                name,
                part_vertices: part_vertices.into_iter().map(|own| usize::try_from(own).ok()).collect(),
                fixed: mask(&fixed, "fixed")?,
            })
        };
        let parts = parts.into_iter().map(part).collect::<PyResult<_>>()?;
        let background = background.inner.kernel()?.clone();
        let skin = released(py, || CombinedSkin::new(&surface.inner, background, parts));
        Ok(Elastic::Combined(skin.map_err(IntoPyErr::into_py_err)?).into())
    }

    /// Pressure (m,) in Pa on the bone under forces (n, 3) in N at the vertices; None if it was not asked for.
    fn bone_pressures<'py>(
        &self,
        py: Python<'py>,
        forces: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let forces = vectors(forces, "forces")?;
        let (Elastic::Body(body) | Elastic::GivenBlocks(body)) = &self.inner else {
            return self.inner.nodes().map(|_| None);
        };
        let pressures = released(py, || body.bone_pressures(&forces)).map_err(IntoPyErr::into_py_err)?;
        Ok(pressures.map(|pressures| PyArray1::from_vec(py, pressures)))
    }

    /// Vertices whose response is known.
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        Ok(nodes_out(py, self.inner.nodes()?.list()))
    }

    /// The prepared or combined skin after a rigid motion of its surface.
    #[pyo3(signature = (rotation=None, translation=None))]
    fn moved(
        &self,
        py: Python<'_>,
        rotation: Option<&Bound<'_, PyAny>>,
        translation: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (rotation, translation) = rotation_and_translation(rotation, translation)?;
        let motion = rigid_motion(&rotation, &translation)
            .map_err(|error| ResponseError::new_err(error.to_string()))?;
        Ok(released(py, || self.inner.moved(&motion))?.into())
    }

    /// Whether the surface is the one that this skin fits.
    fn check_surface(&self, surface: &PySurface) -> PyResult<()> {
        self.elastic().traits(&surface.inner).map(drop).map_err(IntoPyErr::into_py_err)
    }

    /// Arrays of a prepared skin: nodes, vertices, faces, and matrix or displacement and rotation.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let nodes = self.inner.nodes()?;
        let parts = PyDict::new(py);
        parts.set_item("nodes", nodes_out(py, nodes.list()))?;
        parts.set_item("vertices", vectors_out(py, nodes.vertices()))?;
        parts.set_item("faces", faces_out(py, nodes.faces()))?;
        match &self.inner {
            Elastic::PreparedKernel(skin) => {
                parts.set_item("matrix", matrix_out(py, skin.response_matrix()))?;
            }
            Elastic::Given(skin) => parts.set_item("matrix", matrix_out(py, skin.response_matrix()))?,
            Elastic::Body(skin) | Elastic::GivenBlocks(skin) => {
                let (compliance, thickness) = match skin.levels() {
                    Levels::Given(compliance) => (compliance, None),
                    Levels::One(one) => (&one.compliance, one.thickness.as_deref()),
                    Levels::Two(two) => (&two.remainder, two.thickness.as_deref()),
                };
                if let Some(thickness) = thickness {
                    parts.set_item("tissue_thickness", PyArray1::from_slice(py, thickness))?;
                }
                let (stored, rotation) = (compliance.parts(), compliance.rotation());
                if let Some(bone_pressure) = &stored.bone_pressure {
                    parts.set_item("bone_pressure", matrix_out(py, bone_pressure))?;
                }
                parts.set_item("displacement", matrix_out(py, &stored.displacement))?;
                parts.set_item("area_vectors", vectors_out(py, &stored.area_vectors))?;
                let rows: Vec<_> = (0..3).map(|row| rotation.row(row).transpose()).collect();
                parts.set_item("rotation", vectors_out(py, &rows))?;
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
}
