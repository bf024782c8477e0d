//! A local matrix and what can be read off its blocks.

use super::super::skin::Skin;
use super::clusters::{Cluster, ClusterTree};
use super::cross::LowRank;
use super::plan::Place;
use super::step::Step;
use faer::Mat;
use std::collections::BTreeMap;

/// A response matrix of a kernel that fades, in blocks: [`assemble_local`](super::assemble_local).
#[derive(Debug, Clone, PartialEq)]
pub struct LocalMatrix {
    pub(super) skin: Skin,
    pub(super) order: usize,
    pub(super) threshold: f64,
    pub(super) tree: ClusterTree,
    pub(super) blocks: Vec<Block>,
    /// Blocks by their clusters of rows, and of columns.
    pub(super) by_rows: Index,
    pub(super) by_columns: Index,
    entries: usize,
    /// Memory of the values and their places (bytes).
    value_bytes: usize,
}

/// Entries between two clusters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block {
    pub(super) place: Place,
    pub(super) values: Values,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    /// Column by column.
    Dense(Vec<f64>),
    LowRank(LowRank),
    /// Across a cutoff.
    Step(Box<Step>),
}

impl Values {
    fn entries(&self) -> usize {
        match self {
            Self::Dense(values) => values.len(),
            Self::LowRank(product) => product.left.len() + product.right.len(),
            Self::Step(step) => step.entries(),
        }
    }

    /// Memory beside that of the stored values (bytes).
    fn other_bytes(&self) -> usize {
        match self {
            Self::Step(step) => step.other_bytes(),
            _ => 0,
        }
    }

    /// Entry (i, j) of a block of m rows and n columns.
    pub(super) fn at(&self, i: usize, j: usize, m: usize, n: usize) -> f64 {
        match self {
            Self::Dense(values) => values[j * m + i],
            Self::LowRank(product) => product.at(i, j, m, n),
            Self::Step(step) => step.at(i, j),
        }
    }
}

/// Blocks of each cluster.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Index {
    starts: Vec<u32>,
    blocks: Vec<u32>,
}

impl Index {
    fn new(clusters: usize, blocks: &[Block], cluster: impl Fn(&Block) -> usize) -> Self {
        let mut order: Vec<u32> = (0..blocks.len() as u32).collect();
        order.sort_by_key(|&block| cluster(&blocks[block as usize]));
        let start = |c: usize| order.partition_point(|&block| cluster(&blocks[block as usize]) < c) as u32;
        Self { starts: (0..=clusters).map(start).collect(), blocks: order }
    }

    /// Blocks of one cluster, in the order of the matrix.
    pub(super) fn of(&self, cluster: usize) -> &[u32] {
        &self.blocks[self.starts[cluster] as usize..self.starts[cluster + 1] as usize]
    }

    fn bytes(&self) -> usize {
        size_of::<u32>() * (self.starts.len() + self.blocks.len())
    }
}

impl LocalMatrix {
    /// No blocks yet.
    pub(super) fn empty(skin: Skin, order: usize, threshold: f64) -> Self {
        let (by_rows, by_columns) = (Index::default(), Index::default());
        let (tree, blocks) = (ClusterTree::default(), Vec::new());
        Self { skin, order, threshold, tree, blocks, by_rows, by_columns, entries: 0, value_bytes: 0 }
    }

    pub(super) fn extend(&mut self, blocks: Vec<Block>) {
        let entries: usize = blocks.iter().map(|block| block.values.entries()).sum();
        let others: usize = blocks.iter().map(|block| block.values.other_bytes()).sum();
        self.entries += entries;
        self.value_bytes += size_of::<f64>() * entries + others;
        self.blocks.extend(blocks);
    }

    /// Takes the tree once all blocks are there.
    pub(super) fn finish(&mut self, tree: ClusterTree) {
        self.by_rows = Index::new(tree.clusters.len(), &self.blocks, |block| block.place.rows);
        self.by_columns = Index::new(tree.clusters.len(), &self.blocks, |block| block.place.columns);
        self.tree = tree;
    }

    /// Number of nodes k.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The threshold that it was assembled with.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The skin that it was assembled for.
    pub fn skin(&self) -> &Skin {
        &self.skin
    }

    /// Number of stored values.
    pub fn entries(&self) -> usize {
        self.entries
    }

    /// Memory that the matrix takes (bytes).
    pub fn bytes(&self) -> usize {
        let tree = size_of::<Cluster>() * self.tree.clusters.len() + size_of::<u32>() * self.order;
        let index = self.by_rows.bytes() + self.by_columns.bytes();
        self.value_bytes + size_of::<Block>() * self.blocks.len() + tree + index
    }

    /// Nodes of the rows and of the columns of a block.
    fn nodes_of(&self, block: &Block) -> [&[u32]; 2] {
        [block.place.rows, block.place.columns]
            .map(|cluster| &self.tree.order[self.tree.clusters[cluster].nodes.clone()])
    }

    /// The dense matrix (k × k, m/N), with zeros where nothing is stored.
    pub fn to_dense(&self) -> Mat<f64> {
        let mut dense = Mat::zeros(self.order, self.order);
        for block in &self.blocks {
            let [rows, columns] = self.nodes_of(block);
            for (j, &column) in columns.iter().enumerate() {
                for (i, &row) in rows.iter().enumerate() {
                    dense[(row as usize, column as usize)] = block.values.at(i, j, rows.len(), columns.len());
                }
            }
        }
        dense
    }

    /// Diagonal entries (m/N), per node.
    pub fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.order];
        for block in self.blocks.iter().filter(|block| block.place.rows == block.place.columns) {
            let [nodes, _] = self.nodes_of(block);
            if let Values::Dense(values) = &block.values {
                for (i, &node) in nodes.iter().enumerate() {
                    diagonal[node as usize] = values[i * (nodes.len() + 1)];
                }
            }
        }
        diagonal
    }

    /// Groups of nodes between which nothing but zeros is stored, each ascending, by their first node: separate
    /// contact problems.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let mut parent: Vec<u32> = (0..self.order as u32).collect();
        fn root(parent: &mut [u32], mut v: u32) -> u32 {
            while parent[v as usize] != v {
                parent[v as usize] = parent[parent[v as usize] as usize];
                v = parent[v as usize];
            }
            v
        }
        let mut join = |a: u32, b: u32| {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b) as usize] = a.min(b);
        };
        for block in &self.blocks {
            let [rows, columns] = self.nodes_of(block);
            match &block.values {
                Values::Dense(values) => {
                    for (&column, entries) in columns.iter().zip(values.chunks_exact(rows.len())) {
                        let coupled = rows.iter().zip(entries).filter(|(_, entry)| **entry != 0.0);
                        coupled.for_each(|(&row, _)| join(row, column));
                    }
                }
                Values::Step(step) => {
                    for (i, &row) in rows.iter().enumerate() {
                        step.columns_of(i).for_each(|j| join(row, columns[j]));
                    }
                }
                Values::LowRank(_) => rows.iter().chain(columns).for_each(|&node| join(node, columns[0])),
            }
        }
        let mut groups: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for node in 0..self.order as u32 {
            groups.entry(root(&mut parent, node)).or_default().push(node as usize);
        }
        groups.into_values().collect()
    }
}
