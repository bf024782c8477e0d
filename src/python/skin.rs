//! `quasirigid.Skin`, prepared skins and combinations of them, as the core keeps them.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::geometry::rigid_motion;
use crate::python::arrays_out::nodes_out;
use crate::python::convert::{
    MatrixArgument, mask, matrix3, nodes, number, rotation_and_translation, scalars, vectors,
};
use crate::python::elastic::{Elastic, discretization_of};
use crate::python::errors::{IntoPyErr, ResponseError};
use crate::python::forked::released;
use crate::python::interrupt::{detached, detached_on_thread};
use crate::python::surface::PySurface;
use crate::response::body::{Body, BodyOptions, BodyProgress};
use crate::response::{
    self, AssemblyOptions, CombinedSkin, ElasticSkin, GivenBlocks, GivenMatrix, Kernel, KernelSkin, Part,
    PreparedBody, PreparedKernel, Thickness,
};

/// Material and response, checked; computed as it is needed, or once.
#[pyclass(name = "Skin", module = "quasirigid._core", frozen)]
pub(super) struct PySkin {
    inner: Elastic,
}

/// Name, prepared body, vertex of the part for each of the whole (-1 for none), and the part's fixed vertices.
type PartArgument<'py> = (String, Bound<'py, PySkin>, Vec<i64>, Bound<'py, PyAny>);

impl From<Elastic> for PySkin {
    fn from(inner: Elastic) -> Self {
        Self { inner }
    }
}

impl PySkin {
    /// The skin by who answers.
    pub(super) fn inner(&self) -> &Elastic {
        &self.inner
    }

    pub(super) fn elastic(&self) -> &dyn ElasticSkin {
        self.inner.as_skin()
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
        Elastic::of_kernel(shear_modulus, poisson_ratio, Kernel::HalfSpace, pressure, discretization)
            .map(Self::from)
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
        Elastic::of_kernel(shear_modulus, poisson_ratio, kernel, pressure, None).map(Self::from)
    }

    #[staticmethod]
    fn layer(
        shear_modulus: f64,
        poisson_ratio: f64,
        thickness: &Bound<'_, PyAny>,
        pressure: &str,
        discretization: Option<&str>,
    ) -> PyResult<Self> {
        let thickness = match thickness.len() {
            Ok(_) => Thickness::PerVertex(scalars(thickness, "thickness")?.into()),
            Err(_) => Thickness::Uniform(number(thickness, "thickness")?),
        };
        let kernel = Kernel::Layer { thickness };
        Elastic::of_kernel(shear_modulus, poisson_ratio, kernel, pressure, discretization).map(Self::from)
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
        let skin = self.inner.kernel()?;
        let volume = detached(py, |interrupt| {
            let options =
                AssemblyOptions { tolerance: 1e-9, interrupt: Some(interrupt), ..AssemblyOptions::default() };
            response::net_volume(&surface.inner, skin, node, &options)
        })?;
        volume.map(|volume| (volume.net, volume.gross)).map_err(IntoPyErr::into_py_err)
    }

    /// The kernel's matrix over `nodes`, computed once.
    #[pyo3(signature = (surface, nodes, *, num_threads))]
    fn prepare(
        &self,
        py: Python<'_>,
        surface: &PySurface,
        nodes: &Bound<'_, PyAny>,
        num_threads: Option<usize>,
    ) -> PyResult<Self> {
        let skin = self.inner.kernel()?;
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
        let prepared = detached(py, |interrupt| {
            let options =
                AssemblyOptions { num_threads, interrupt: Some(interrupt), ..AssemblyOptions::default() };
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

    /// Blocks (3 k, 3 k) of somebody else, turned by `rotation` since.
    #[staticmethod]
    fn given_blocks(
        surface: &PySurface,
        shear_modulus: f64,
        poisson_ratio: f64,
        nodes: &Bound<'_, PyAny>,
        blocks: &Bound<'_, PyAny>,
        rotation: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let py = nodes.py();
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
        let blocks = MatrixArgument::new(blocks, "compliance", ResponseError::new_err)?.view().to_owned();
        let (rotation, material) = (matrix3(rotation, "rotation")?, [shear_modulus, poisson_ratio]);
        let given = released(py, || GivenBlocks::new(&surface.inner, &nodes, blocks, rotation, material));
        Ok(Elastic::GivenBlocks(given.map_err(IntoPyErr::into_py_err)?).into())
    }

    /// A body solved for unit forces at `nodes`; `progress` hears memory and operations first, and what it raises ends the
    /// work and is raised here.
    #[staticmethod]
    #[pyo3(signature = (surface, shear_modulus, poisson_ratio, bone, fixed, nodes, *, coarse_edge_length, discretization, bone_pressure, num_threads, memory_limit, progress))]
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
        discretization: Option<&str>,
        bone_pressure: bool,
        num_threads: Option<usize>,
        memory_limit: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let fixed = fixed.map(|value| mask(value, "fixed")).transpose()?;
        let nodes = self::nodes(nodes, "nodes", surface.inner.vertices().len(), ResponseError::new_err)?;
        let discretization = discretization_of(discretization)?;
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
        let turn = Mutex::new(());
        let report = |step: BodyProgress| {
            // One thread after the other, so that nothing is told after a failure: that ends the work and is raised then.
            let _turn = turn.lock().unwrap_or_else(PoisonError::into_inner);
            if let (Some(progress), None) = (&progress, failure.get())
                && let Err(error) = tell(progress, step)
            {
                failure.set(error).expect("nothing is told after a failure");
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
            None => {
                let body = done.map_err(IntoPyErr::into_py_err)?;
                Ok(Elastic::Body(body.with_discretization(discretization)).into())
            }
        }
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
        let Elastic::Body(body) = &self.inner else {
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

    /// The same: nothing of it changes.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    /// The same, as for `__copy__`.
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// Whether the surface is the one that this skin fits.
    fn check_surface(&self, surface: &PySurface) -> PyResult<()> {
        self.elastic().traits(&surface.inner).map(drop).map_err(IntoPyErr::into_py_err)
    }
}
