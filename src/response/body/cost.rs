//! Memory and operations of a body response, known before it is solved.

use crate::response::body::equations::element::Element;

/// What [`Body::prepare`](crate::response::body::Body::prepare) costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyCost {
    /// Vertices of the skin that is solved, of its bones, and those that are loaded.
    pub counts: [usize; 3],
    /// Unknowns: three per skin and bone vertex.
    pub unknowns: usize,
    /// Right-hand sides: three per loaded node.
    pub right_hand_sides: usize,
    /// Peak memory (bytes).
    pub peak_bytes: usize,
    /// Memory of the result (bytes).
    pub kept_bytes: usize,
    /// Floating-point operations of factorization and solution, without the pressure on the bone.
    pub flops: f64,
}

/// Right-hand sides solved together at the most: each block reads the whole factor.
const LARGEST_BLOCK: usize = 256;
/// Blocks come in groups of so many, to keep as many threads busy to the end; the width hangs on no thread, so that the
/// answer does not either.
const BLOCKS_AT_ONCE: usize = 4;

/// Right-hand sides solved between two looks at the interrupt.
pub(crate) fn solve_width(right_hand_sides: usize) -> usize {
    let groups = right_hand_sides.div_ceil(BLOCKS_AT_ONCE * LARGEST_BLOCK);
    right_hand_sides.div_ceil(BLOCKS_AT_ONCE * groups.max(1)).max(1)
}

impl BodyCost {
    /// The cost for a skin and bones of so many vertices and so many loaded nodes.
    pub fn estimate(skin_count: usize, bone_count: usize, node_count: usize) -> BodyCost {
        Self::estimate_in::<f64>(skin_count, bone_count, node_count)
    }

    /// The same with equations in a precision.
    pub(crate) fn estimate_in<T>(skin_count: usize, bone_count: usize, node_count: usize) -> BodyCost {
        let unknowns = 3 * (skin_count + bone_count);
        let right_hand_sides = 3 * node_count;
        let (n, skin, k) = (unknowns as f64, 3.0 * skin_count as f64, right_hand_sides as f64);
        let kept = 8 * 3 * skin_count * right_hand_sides;
        // matrix, right-hand sides, the blocks of them at work, result, faces with their geometry
        let at_work = BLOCKS_AT_ONCE * solve_width(right_hand_sides);
        let working = size_of::<T>() * unknowns * (unknowns + right_hand_sides + at_work);
        let faces = 2 * (skin_count + bone_count) * size_of::<Element>();
        BodyCost {
            counts: [skin_count, bone_count, node_count],
            unknowns,
            right_hand_sides,
            peak_bytes: working + kept + faces,
            kept_bytes: kept,
            flops: 2.0 / 3.0 * n.powi(3) + (n * n + skin * skin) * k,
        }
    }

    /// Skin and bone vertices possible within `limit` bytes for `node_count` loaded nodes, about.
    pub(crate) fn affordable_vertices<T>(limit: usize, node_count: usize) -> usize {
        // (3 n)² + (3 n) (2 · 3 k) = limit in numbers
        let (k, words) = (3.0 * node_count as f64, limit as f64 / size_of::<T>() as f64);
        (((k * k + words).sqrt() - k) / 3.0) as usize
    }
}

impl std::fmt::Display for BodyCost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [skin, bone, nodes] = self.counts;
        let (gigabytes, operations) = (self.peak_bytes as f64 / 1e9, self.flops);
        write!(f, "body of {skin} skin and {bone} bone vertices, {nodes} of them loaded: ")?;
        write!(f, "{gigabytes:.2} GB, {operations:.1e} operations")
    }
}
