//! Options of an assembly, and the checks that come before it.

use nalgebra::Vector3;

use crate::response::error::ResponseError;
use crate::surface::checked::Surface;

/// Parameters of [`assemble`](crate::response::matrix::collocation::assemble).
#[derive(Clone, Copy)]
pub struct AssemblyOptions<'a> {
    /// Largest error of an entry from numerical integration (dimensionless, 0 ..= 0.1), relative to the half-space's
    /// entry, some K/r: of a layer's or a Gaussian's entry, a difference that can be far smaller, it is a larger share. 0 means as exact as double precision allows.
    pub tolerance: f64,
    /// Threads (>= 1); `None` means rayon's global pool. The result is equal to the bit for any number.
    pub num_threads: Option<usize>,
    /// Largest size of the matrix (bytes); `None` means no limit.
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

impl std::fmt::Debug for AssemblyOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AssemblyOptions")
            .field("tolerance", &self.tolerance)
            .field("num_threads", &self.num_threads)
            .field("memory_limit", &self.memory_limit)
            .field("interrupt", &self.interrupt.is_some())
            .finish()
    }
}

impl AssemblyOptions<'_> {
    pub(crate) fn validate(&self) -> Result<(), ResponseError> {
        if !(0.0..=0.1).contains(&self.tolerance) {
            let (name, value, expected) = ("tolerance", self.tolerance, "from 0 to 0.1");
            return Err(ResponseError::Constant { name, value, expected });
        }
        if self.num_threads == Some(0) {
            return Err(ResponseError::Constant { name: "num_threads", value: 0.0, expected: "at least 1" });
        }
        Ok(())
    }
}

/// Checks nodes, directions and the memory of a matrix with `others` entries a node before anything is computed.
pub(crate) fn check_request(
    surface: &Surface,
    nodes: &[usize],
    others: usize,
    directions: Option<&[Vector3<f64>]>,
    options: &AssemblyOptions,
) -> Result<(), ResponseError> {
    options.validate()?;
    let vertex_count = surface.vertices().len();
    let mut seen = vec![usize::MAX; vertex_count];
    for (index, &vertex) in nodes.iter().enumerate() {
        let first = *seen.get(vertex).ok_or(ResponseError::NodeOutOfRange { index, vertex, vertex_count })?;
        if first != usize::MAX {
            return Err(ResponseError::RepeatedNode { vertex, first, second: index });
        }
        seen[vertex] = index;
    }
    if let Some(directions) = directions {
        if directions.len() != nodes.len() {
            return Err(ResponseError::DirectionCount { directions: directions.len(), nodes: nodes.len() });
        }
        for (index, d) in directions.iter().enumerate() {
            let length = d.norm();
            if !(length.is_finite() && length > 0.0) {
                return Err(ResponseError::Direction { index, value: [d.x, d.y, d.z] });
            }
        }
    }
    // scratch memory is small beside the dense block
    let bytes = nodes.len().saturating_mul(others).saturating_mul(size_of::<f64>());
    match options.memory_limit {
        Some(limit) if bytes > limit => Err(ResponseError::TooLarge { nodes: nodes.len(), bytes, limit }),
        _ => Ok(()),
    }
}
