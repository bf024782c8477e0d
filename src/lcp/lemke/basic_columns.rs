//! Columns of M that have entered the basis, copied side by side as they first do.

use crate::lcp::reduced::{Reduced, power_of_two};

const NOWHERE: usize = usize::MAX;
/// Numbers in one piece of memory.
const BLOCK: usize = 1 << 13;

/// Columns scaled to magnitude one by powers of two, so that every tolerance of the path is dimensionless.
pub(crate) struct Entered {
    height: usize,
    /// Place of each column of M among those copied.
    place: Vec<usize>,
    scale: Vec<f64>,
    /// Copies, `per_block` to a piece of memory.
    blocks: Vec<Vec<f64>>,
    per_block: usize,
    count: usize,
}

impl Entered {
    pub(crate) fn new(height: usize) -> Self {
        let per_block = (BLOCK / height.max(1)).clamp(1, height.max(1));
        Self {
            height,
            place: vec![NOWHERE; height],
            scale: vec![1.0; height],
            blocks: Vec::new(),
            per_block,
            count: 0,
        }
    }

    /// Copies column `j` unless that has been done.
    pub(crate) fn fetch(&mut self, source: &Reduced, j: usize) {
        if self.place[j] != NOWHERE {
            return;
        }
        let within = self.count % self.per_block;
        if within == 0 {
            self.blocks.push(vec![0.0; self.height * self.per_block]);
        }
        let block = self.blocks.last_mut().expect("one was just pushed if there was none");
        let column = &mut block[within * self.height..][..self.height];
        source.read_column(j, column);
        let largest = column.iter().fold(0.0, |a: f64, m| a.max(m.abs()));
        if largest > 0.0 {
            let scale = 1.0 / power_of_two(largest);
            column.iter_mut().for_each(|entry| *entry *= scale);
            self.scale[j] = scale;
        }
        self.place[j] = self.count;
        self.count += 1;
    }

    /// A column that was fetched.
    pub(crate) fn column(&self, j: usize) -> &[f64] {
        let place = self.place[j];
        &self.blocks[place / self.per_block][place % self.per_block * self.height..][..self.height]
    }

    /// What column `j` was multiplied by.
    pub(crate) fn scale(&self, j: usize) -> f64 {
        self.scale[j]
    }
}
