//! The kinds of skin behind `quasirigid._core.Skin`.

use nalgebra::Isometry3;
use pyo3::prelude::*;

use crate::python::convert::named;
use crate::python::errors::{IntoPyErr, ResponseError};
use crate::response::{
    CombinedSkin, Discretization, ElasticSkin, GivenBlocks, GivenMatrix, Kernel, KernelSkin, PreparedBody,
    PreparedKernel, PreparedNodes, PressureBasis,
};

/// A skin that answers contact forces, by who answers.
pub(super) enum Elastic {
    Kernel(KernelSkin),
    PreparedKernel(PreparedKernel),
    Body(PreparedBody),
    /// 3 × 3 blocks that somebody else computed or measured.
    GivenBlocks(GivenBlocks),
    Given(GivenMatrix),
    Combined(CombinedSkin),
}

impl Elastic {
    /// A kernel with its pressure basis and discretization by name.
    pub(super) fn of_kernel(
        shear_modulus: f64,
        poisson_ratio: f64,
        kernel: Kernel,
        pressure: &str,
        discretization: Option<&str>,
    ) -> PyResult<Self> {
        let bases = [(PressureBasis::Linear, "linear"), (PressureBasis::OneRing, "one_ring")];
        let basis = named("pressure", pressure, &bases, ResponseError::new_err)?;
        let discretization = discretization_of(discretization)?;
        let skin = KernelSkin::new(shear_modulus, poisson_ratio, kernel)
            .and_then(|skin| skin.with_basis(basis).with_discretization(discretization));
        Ok(Self::Kernel(skin.map_err(IntoPyErr::into_py_err)?))
    }

    pub(super) fn as_skin(&self) -> &dyn ElasticSkin {
        match self {
            Self::Kernel(skin) => skin,
            Self::PreparedKernel(skin) => skin,
            Self::Body(skin) => skin,
            Self::GivenBlocks(skin) => skin,
            Self::Given(skin) => skin,
            Self::Combined(skin) => skin,
        }
    }

    pub(super) fn kernel(&self) -> PyResult<&KernelSkin> {
        match self {
            Self::Kernel(skin) => Ok(skin),
            _ => Err(ResponseError::new_err("this skin is prepared already")),
        }
    }

    /// The solved body of a part.
    pub(super) fn body_part(&self, part: &str) -> PyResult<&PreparedBody> {
        match self {
            Self::Body(body) => Ok(body),
            _ => Err(ResponseError::new_err(format!(
                "part {part:?} does not fit the whole skin: its response is not that of a body"
            ))),
        }
    }

    pub(super) fn nodes(&self) -> PyResult<&PreparedNodes> {
        match self {
            Self::PreparedKernel(skin) => Ok(skin.nodes()),
            Self::Body(skin) => Ok(skin.nodes()),
            Self::GivenBlocks(skin) => Ok(skin.nodes()),
            Self::Given(skin) => Ok(skin.nodes()),
            Self::Kernel(_) | Self::Combined(_) => Err(not_prepared()),
        }
    }

    /// The same after a rigid motion of its surface.
    pub(super) fn moved(&self, motion: &Isometry3<f64>) -> PyResult<Self> {
        let moved = match self {
            Self::Kernel(_) => return Err(not_prepared()),
            Self::PreparedKernel(skin) => Ok(Self::PreparedKernel(skin.moved(motion))),
            Self::Given(skin) => Ok(Self::Given(skin.moved(motion))),
            Self::Body(skin) => skin.moved(motion).map(Self::Body),
            Self::GivenBlocks(skin) => skin.moved(motion).map(Self::GivenBlocks),
            Self::Combined(skin) => skin.moved(motion).map(Self::Combined),
        };
        moved.map_err(IntoPyErr::into_py_err)
    }
}

/// The discretization of a name.
pub(super) fn discretization_of(name: Option<&str>) -> PyResult<Discretization> {
    let all = [Discretization::Collocation, Discretization::Galerkin].map(|one| (one, one.as_str()));
    let named = |name| named("discretization", name, &all, ResponseError::new_err);
    name.map_or(Ok(Discretization::default()), named)
}

fn not_prepared() -> PyErr {
    ResponseError::new_err("this skin is not prepared for one surface")
}
