//! Products with a local matrix.

use super::cross::LowRank;
use super::matrix::{Block, Index, LocalMatrix, Values};
use rayon::prelude::*;
use std::ops::Range;

/// Below this many stored values a product is not worth several threads.
const ALONE: usize = 100_000;

impl LocalMatrix {
    /// R f (m).
    ///
    /// Equal to the bit for any number of threads (rayon's): every entry of the result is summed in one order.
    ///
    /// * `forces`: (k,) f (N)
    ///
    /// # Panics
    /// If there are not as many forces as nodes.
    pub fn apply(&self, forces: &[f64]) -> Vec<f64> {
        self.product(forces, Side { index: &self.by_rows, transposed: false })
    }

    /// R' f (m).
    ///
    /// * `forces`: (k,) f (N)
    ///
    /// # Panics
    /// If there are not as many forces as nodes.
    pub fn apply_transposed(&self, forces: &[f64]) -> Vec<f64> {
        self.product(forces, Side { index: &self.by_columns, transposed: true })
    }

    fn product(&self, forces: &[f64], side: Side) -> Vec<f64> {
        assert_eq!(forces.len(), self.order, "one force per node");
        let tree = &self.tree;
        let forces: Vec<f64> = tree.order.iter().map(|&node| forces[node as usize]).collect();
        // The inner products of blocks of low rank and the products of those across a cutoff first, then each leaf
        // gathers what reaches it.
        let inner = |block: &Block| match &block.values {
            Values::LowRank(product) => {
                let (_, right, _, columns) = side.of(self, block, product);
                right.chunks_exact(columns.len()).map(|v| dot(v, &forces[columns.clone()])).collect()
            }
            Values::Step(step) => {
                let [rows, columns] = self.ranges(block);
                match side.transposed {
                    true => step.apply_transposed(&forces[rows]),
                    false => step.apply(&forces[columns]),
                }
            }
            Values::Dense(_) => Vec::new(),
        };
        let is_alone = self.entries() < ALONE;
        let inner: Vec<Vec<f64>> = if is_alone {
            self.blocks.iter().map(inner).collect()
        } else {
            self.blocks.par_iter().with_min_len(64).map(inner).collect()
        };
        let gather = |&leaf: &usize| {
            let range = tree.clusters[leaf].nodes.clone();
            let mut sum = vec![0.0; range.len()];
            let mut cluster = leaf;
            loop {
                for &number in side.index.of(cluster) {
                    let inner = &inner[number as usize];
                    self.add(&self.blocks[number as usize], side, &forces, inner, range.clone(), &mut sum);
                }
                if tree.clusters[cluster].parent == cluster {
                    return sum;
                }
                cluster = tree.clusters[cluster].parent;
            }
        };
        let parts: Vec<Vec<f64>> = if is_alone {
            tree.leaves.iter().map(gather).collect()
        } else {
            tree.leaves.par_iter().map(gather).collect()
        };
        let mut result = vec![0.0; self.order];
        for (value, &node) in parts.into_iter().flatten().zip(&tree.order) {
            result[node as usize] = value;
        }
        result
    }

    /// Places of the rows and of the columns of a block.
    fn ranges(&self, block: &Block) -> [Range<usize>; 2] {
        [block.place.rows, block.place.columns].map(|cluster| self.tree.clusters[cluster].nodes.clone())
    }

    /// Adds one block's share at the places `range` of a leaf.
    fn add(
        &self,
        block: &Block,
        side: Side,
        forces: &[f64],
        inner: &[f64],
        range: Range<usize>,
        sum: &mut [f64],
    ) {
        let [rows, columns] = self.ranges(block);
        match &block.values {
            Values::Step(_) => {
                let from = range.start - if side.transposed { columns.start } else { rows.start };
                add_multiple(sum, &inner[from..from + range.len()], 1.0);
            }
            Values::LowRank(product) => {
                let (left, _, rows, _) = side.of(self, block, product);
                let from = range.start - rows.start;
                for (column, &share) in left.chunks_exact(rows.len()).zip(inner) {
                    add_multiple(sum, &column[from..from + range.len()], share);
                }
            }
            Values::Dense(values) if side.transposed => {
                let mine = range.start - columns.start..range.end - columns.start;
                for (value, j) in sum.iter_mut().zip(mine) {
                    *value += dot(&values[j * rows.len()..][..rows.len()], &forces[rows.clone()]);
                }
            }
            Values::Dense(values) => {
                let from = range.start - rows.start;
                for (column, &force) in values.chunks_exact(rows.len()).zip(&forces[columns]) {
                    add_multiple(sum, &column[from..from + range.len()], force);
                }
            }
        }
    }
}

/// Which way round a product goes.
#[derive(Clone, Copy)]
struct Side<'a> {
    /// Blocks that reach a cluster of the result.
    index: &'a Index,
    transposed: bool,
}

impl Side<'_> {
    /// Factors and ranges of a block, those of the result and those of the forces.
    fn of<'b>(
        &self,
        matrix: &LocalMatrix,
        block: &Block,
        product: &'b LowRank,
    ) -> (&'b [f64], &'b [f64], Range<usize>, Range<usize>) {
        let [rows, columns] = matrix.ranges(block);
        if self.transposed {
            (&product.right, &product.left, columns, rows)
        } else {
            (&product.left, &product.right, rows, columns)
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    // four sums, so that the additions need not wait for each other
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

fn add_multiple(sum: &mut [f64], values: &[f64], share: f64) {
    sum.iter_mut().zip(values).for_each(|(s, v)| *s += share * v);
}
