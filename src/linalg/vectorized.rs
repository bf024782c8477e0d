//! Loops compiled for what the processor at hand has.

use pulp::{Simd, WithSimd};

/// Runs `work`, an `#[inline(always)]` closure, compiled for the widest vectors of this processor.
///
/// `pulp` alone calls a closure as `FnOnce`: through a shim that is compiled for the baseline where it is not inlined.
#[inline(always)]
pub(crate) fn vectorized<Answer, Work: FnMut() -> Answer>(work: Work) -> Answer {
    pulp::Arch::new().dispatch(Vectorized(work))
}

struct Vectorized<Work>(Work);

impl<Answer, Work: FnMut() -> Answer> WithSimd for Vectorized<Work> {
    type Output = Answer;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> Answer {
        (self.0)()
    }
}
