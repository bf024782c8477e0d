//! A table by edges, whichever way they are run.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Values by [`edge`].
pub(super) type EdgeMap<T> = HashMap<u64, T, BuildHasherDefault<EdgeHasher>>;

/// An edge, whichever way it is run.
pub(super) fn edge(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

/// Spreads edges, which are unlike enough, over a table.
#[derive(Debug, Clone, Default)]
pub(super) struct EdgeHasher(u64);

impl Hasher for EdgeHasher {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }

    fn write_u64(&mut self, value: u64) {
        // The golden ratio (Knuth 1998, volume 3, section 6.4).
        let product = (self.0 ^ value).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = product ^ product >> 32;
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
