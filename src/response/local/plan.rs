//! Which blocks of a local matrix are zero, of low rank, or dense.

use super::clusters::ClusterTree;
use super::step;
use crate::surface::RegionPairs;

/// Blocks of at most this many rows and columns are dense where no low rank is to be expected.
pub(super) const PANEL: usize = 32;
/// A block may have low rank where the smaller of its two boxes is no larger than this times their distance.
const SEPARATION: f64 = 3.0;
/// A block may have low rank where the thicknesses that occur in both its clusters differ by no more than this factor.
const EVEN: f64 = 2.0;

/// What decides on the blocks.
pub(super) struct Plan<'a> {
    pub(super) tree: &'a ClusterTree,
    /// Regions of the skin that are within reach of each other.
    pub(super) pairs: &'a RegionPairs,
    /// Per cluster, whether its regions hang together by shared tissue within it.
    pub(super) is_whole: Vec<bool>,
    /// Per cluster, how far a load reaches from a node (m), at most and at least.
    pub(super) reach: Vec<f64>,
    pub(super) least_reach: Vec<f64>,
    /// Per cluster, how far a load extends around a node (m).
    pub(super) load_radius: Vec<f64>,
    /// Distance at which the kernel jumps (m), if it does.
    pub(super) jump: Option<f64>,
    /// Loads that extend no farther around their nodes (m) are cut there within blocks of their own kind.
    pub(super) largest_cut: f64,
}

/// A block by its clusters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// The blocks that are not zero.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    pub(super) dense: Vec<Place>,
    pub(super) far: Vec<Place>,
    /// Across the distance at which the kernel jumps.
    pub(super) across: Vec<Place>,
}

/// How much of a block joins nodes that share tissue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shared {
    All,
    Part,
    Nothing,
}

impl Plan<'_> {
    /// Divides the whole matrix.
    pub(super) fn blocks(&self) -> Blocks {
        let mut blocks = Blocks::default();
        self.divide(Place { rows: 0, columns: 0 }, &mut blocks);
        blocks
    }

    /// Distance between the nodes of the rows and the loads of the columns (m), at least.
    pub(super) fn clearance(&self, place: Place) -> f64 {
        let clusters = &self.tree.clusters;
        clusters[place.rows].gap_to(&clusters[place.columns]) - self.load_radius[place.columns]
    }

    /// How far the kernel reaches in a block (m): between two nodes the thinner layer counts.
    pub(super) fn reach_in(&self, place: Place) -> f64 {
        self.reach[place.rows].min(self.reach[place.columns])
    }

    /// Whether the kernel is smooth in a block as far as the thickness goes: the smaller one of each pair may change
    /// from row to row or from column to column, but hardly be now the row's, now the column's.
    fn is_even(&self, place: Place) -> bool {
        let both = self.least_reach[place.rows].max(self.least_reach[place.columns]);
        self.reach_in(place) <= EVEN * both
    }

    /// Whether two regions are within reach and share tissue.
    pub(super) fn shares(&self, a: u32, b: u32) -> bool {
        self.pairs.sharing[a as usize].binary_search(&b).is_ok()
    }

    fn divide(&self, place: Place, blocks: &mut Blocks) {
        let [rows, columns] = [place.rows, place.columns].map(|cluster| &self.tree.clusters[cluster]);
        let clearance = self.clearance(place);
        if clearance >= self.reach_in(place) {
            return;
        }
        let is_far = clearance >= self.load_radius[place.columns]
            && rows.diameter().min(columns.diameter()) <= SEPARATION * clearance
            && self.is_even(place);
        let jumps =
            self.jump.is_some_and(|at| rows.span_with(columns) + self.load_radius[place.columns] > at);
        // A jump has no low rank: there blocks are small.
        let is_across = is_far
            && jumps
            && self.load_radius[place.columns] <= self.largest_cut
            && rows.nodes.len().max(columns.nodes.len()) <= step::LARGEST;
        let parts = [rows, columns].map(|cluster| cluster.children);
        let is_last = parts == [None, None];
        if is_last || is_across || (is_far && !jumps) {
            match self.shared(place) {
                Shared::Nothing => return,
                Shared::All if is_across => return blocks.across.push(place),
                Shared::All if is_far && !jumps => return blocks.far.push(place),
                _ if is_last => return blocks.dense.push(place),
                _ => {}
            }
        }
        let either = |part: Option<[usize; 2]>, whole: usize| match part {
            Some(two) => two.to_vec(),
            None => vec![whole],
        };
        for row in either(parts[0], place.rows) {
            for column in either(parts[1], place.columns) {
                self.divide(Place { rows: row, columns: column }, blocks);
            }
        }
    }

    /// Regions beyond reach of each other count for neither side: what little the kernel has there may stay.
    fn shared(&self, place: Place) -> Shared {
        let [rows, columns] = [place.rows, place.columns]
            .map(|cluster| &self.tree.regions[self.tree.clusters[cluster].regions.clone()]);
        let any = |lists: &[Vec<u32>]| {
            let has = |a: &u32| columns.iter().any(|b| lists[*a as usize].binary_search(b).is_ok());
            rows.iter().any(has)
        };
        if !any(&self.pairs.sharing) {
            Shared::Nothing
        } else if self.is_whole[place.rows] && self.is_whole[place.columns] && !any(&self.pairs.apart) {
            Shared::All
        } else {
            Shared::Part
        }
    }
}
