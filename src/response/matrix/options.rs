//! Options of an assembly, and the checks that come before it.

use std::ops::RangeInclusive;

use nalgebra::Vector3;

use crate::geometry::direction::first_off_unit;
use crate::linalg::memory::free_memory;
use crate::response::error::ResponseError;

/// Tolerances of numerical integration that can be asked for.
pub(crate) const TOLERANCES: RangeInclusive<f64> = 0.0..=0.1;

/// Parameters of [`assemble`](crate::response::matrix::collocation::assemble).
#[derive(Clone, Copy)]
pub struct AssemblyOptions<'a> {
    /// Largest error of an entry from numerical integration (dimensionless, 0 ..= 0.1), relative to K/r, the
    /// half-space's entry. Entries of fading kernels are smaller, so their relative error is larger. 0 means as exact as
    /// double precision allows; in Galerkin form some 1e-8, and less beside poor triangles.
    pub tolerance: f64,
    /// Threads (>= 1), at most four for each processor; `None` means rayon's global pool. The result is equal to the bit
    /// for any number.
    pub num_threads: Option<usize>,
    /// Largest size of the matrix (bytes); `None` means what the system has free, where it says so.
    pub memory_limit: Option<usize>,
    /// Asked now and then on the calling thread; `true` ends the assembly with
    /// [`ResponseError::Interrupted`].
    pub interrupt: Option<&'a (dyn Fn() -> bool + Sync)>,
}

impl Default for AssemblyOptions<'_> {
    fn default() -> Self {
        Self { tolerance: 1e-6, num_threads: None, memory_limit: None, interrupt: None }
    }
}

impl AssemblyOptions<'_> {
    pub(crate) fn validate(&self) -> Result<(), ResponseError> {
        if !TOLERANCES.contains(&self.tolerance) {
            let (name, value, expected) = ("tolerance", self.tolerance, "from 0 to 0.1");
            return Err(ResponseError::Constant { name, value, expected });
        }
        if self.num_threads == Some(0) {
            return Err(ResponseError::Constant { name: "num_threads", value: 0.0, expected: "at least 1" });
        }
        Ok(())
    }
}

/// Checks that there is a unit vector for each of `nodes` nodes.
pub(crate) fn check_directions(directions: &[Vector3<f64>], nodes: usize) -> Result<(), ResponseError> {
    if directions.len() != nodes {
        return Err(ResponseError::DirectionCount { directions: directions.len(), nodes });
    }
    match first_off_unit(directions) {
        Some((index, length)) => Err(ResponseError::Direction { index, length }),
        None => Ok(()),
    }
}

/// Bytes up to which nobody asks what the system has free.
const FEW_BYTES: usize = 1 << 26;

/// Checks the size (bytes) of a matrix, without a limit against what the system has free; scratch memory is small beside
/// it.
pub(crate) fn check_memory(
    rows: usize,
    columns: usize,
    options: &AssemblyOptions,
) -> Result<(), ResponseError> {
    let bytes = rows.saturating_mul(columns).saturating_mul(size_of::<f64>());
    let free = || if bytes > FEW_BYTES { free_memory() } else { None };
    match options.memory_limit.or_else(free) {
        Some(limit) if bytes > limit => Err(ResponseError::TooLarge { nodes: rows, bytes, limit }),
        _ => Ok(()),
    }
}
