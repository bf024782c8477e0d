//! Nodes in a binary tree of clusters that are compact in space.

use crate::surface::{SkinRegions, Surface};
use nalgebra::Vector3;
use std::ops::Range;

/// Nodes that lie together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cluster {
    /// Places in the order of the tree.
    pub(super) nodes: Range<usize>,
    /// Places in [`ClusterTree::regions`].
    pub(super) regions: Range<usize>,
    /// Cluster of which this is a part; the root is its own.
    pub(super) parent: usize,
    /// The two parts, unless this is a leaf.
    pub(super) children: Option<[usize; 2]>,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Cluster {
    /// Diagonal of the box around the nodes (m).
    pub(super) fn diameter(&self) -> f64 {
        (self.high - self.low).norm()
    }

    /// Middle of that box (m).
    pub(super) fn center(&self) -> Vector3<f64> {
        0.5 * (self.low + self.high)
    }

    /// Distance of the boxes of two clusters (m).
    pub(super) fn gap_to(&self, other: &Self) -> f64 {
        (self.low - other.high).sup(&(other.low - self.high)).sup(&Vector3::zeros()).norm()
    }

    /// Largest distance of points in the two boxes (m).
    pub(super) fn span_with(&self, other: &Self) -> f64 {
        (self.high - other.low).sup(&(other.high - self.low)).norm()
    }
}

/// A binary tree over nodes: regions of the skin are bisected first and stay whole down to single ones, then the nodes
/// of a region.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct ClusterTree {
    /// The root first, parents before their parts.
    pub(super) clusters: Vec<Cluster>,
    /// Node at each place.
    pub(super) order: Vec<u32>,
    /// Regions of the skin in the order of the tree.
    pub(super) regions: Vec<u32>,
    /// Leaves in the order of their nodes.
    pub(super) leaves: Vec<usize>,
}

/// The nodes of one region.
struct Piece {
    region: u32,
    seed: Vector3<f64>,
    nodes: Vec<u32>,
}

impl ClusterTree {
    /// * `nodes`: (k,) vertices, k > 0
    /// * `largest_leaf`: most nodes of a leaf
    pub(super) fn new(
        surface: &Surface,
        nodes: &[usize],
        regions: &SkinRegions,
        largest_leaf: usize,
    ) -> Self {
        let points: Vec<Vector3<f64>> = nodes.iter().map(|&v| surface.vertices()[v]).collect();
        let mut members = vec![Vec::new(); regions.count()];
        for (node, &vertex) in nodes.iter().enumerate() {
            members[regions.of(vertex)].push(node as u32);
        }
        let seed = |region: usize| surface.vertices()[regions.seed(region)];
        let filled = members.into_iter().enumerate().filter(|(_, nodes)| !nodes.is_empty());
        let mut pieces: Vec<Piece> = filled
            .map(|(region, nodes)| Piece { region: region as u32, seed: seed(region), nodes })
            .collect();
        let mut tree = Self::default();
        tree.bisect_pieces(&mut pieces, &points, largest_leaf, 0);
        tree
    }

    fn bisect_pieces(
        &mut self,
        pieces: &mut [Piece],
        points: &[Vector3<f64>],
        leaf: usize,
        parent: usize,
    ) -> usize {
        let count: usize = pieces.iter().map(|piece| piece.nodes.len()).sum();
        if let [piece] = pieces {
            let first = self.regions.len();
            self.regions.push(piece.region);
            return self.bisect_nodes(&mut piece.nodes, points, leaf, parent, first..first + 1);
        }
        if count <= leaf {
            let first = self.regions.len();
            self.regions.extend(pieces.iter().map(|piece| piece.region));
            let mut nodes: Vec<u32> = pieces.iter().flat_map(|piece| piece.nodes.iter().copied()).collect();
            let last = self.regions.len();
            return self.bisect_nodes(&mut nodes, points, leaf, parent, first..last);
        }
        let (low, high) = bounds(pieces.iter().map(|piece| piece.seed));
        let axis = (high - low).imax();
        pieces.sort_unstable_by(|a, b| a.seed[axis].total_cmp(&b.seed[axis]).then(a.region.cmp(&b.region)));
        // where half of the nodes are on each side
        let (mut cut, mut before) = (0, 0);
        while cut + 1 < pieces.len() && (cut == 0 || 2 * before + pieces[cut].nodes.len() <= count) {
            before += pieces[cut].nodes.len();
            cut += 1;
        }
        let me = self.clusters.len();
        self.clusters.push(Cluster {
            nodes: self.order.len()..self.order.len() + count,
            regions: self.regions.len()..self.regions.len() + pieces.len(),
            parent,
            children: None,
            low,
            high,
        });
        let (left, right) = pieces.split_at_mut(cut);
        let children = [left, right].map(|part| self.bisect_pieces(part, points, leaf, me));
        self.join(me, children);
        me
    }

    fn bisect_nodes(
        &mut self,
        nodes: &mut [u32],
        points: &[Vector3<f64>],
        leaf: usize,
        parent: usize,
        regions: Range<usize>,
    ) -> usize {
        let (low, high) = bounds(nodes.iter().map(|&node| points[node as usize]));
        let me = self.clusters.len();
        let range = self.order.len()..self.order.len() + nodes.len();
        let cluster = Cluster { nodes: range, regions: regions.clone(), parent, children: None, low, high };
        self.clusters.push(cluster);
        if nodes.len() <= leaf {
            self.order.extend(&*nodes);
            self.leaves.push(me);
            return me;
        }
        let axis = (high - low).imax();
        nodes.sort_unstable_by(|&a, &b| {
            points[a as usize][axis].total_cmp(&points[b as usize][axis]).then(a.cmp(&b))
        });
        let (left, right) = nodes.split_at_mut(nodes.len() / 2);
        let children = [left, right].map(|part| self.bisect_nodes(part, points, leaf, me, regions.clone()));
        self.join(me, children);
        me
    }

    fn join(&mut self, me: usize, children: [usize; 2]) {
        let [a, b] = children.map(|child| (self.clusters[child].low, self.clusters[child].high));
        let cluster = &mut self.clusters[me];
        cluster.children = Some(children);
        (cluster.low, cluster.high) = (a.0.inf(&b.0), a.1.sup(&b.1));
    }

    /// Per cluster, whether its regions hang together by pairs within it.
    ///
    /// * `partners`: per region the others that it hangs together with, in both directions
    pub(super) fn whole(&self, partners: &[Vec<u32>]) -> Vec<bool> {
        let mut place = vec![usize::MAX; partners.len()];
        self.regions.iter().enumerate().for_each(|(at, &region)| place[region as usize] = at);
        let is_whole = |cluster: &Cluster| {
            let range = cluster.regions.clone();
            let mut is_found = vec![false; range.len()];
            let mut found = vec![range.start];
            is_found[0] = true;
            let mut next = 0;
            while next < found.len() {
                for &other in &partners[self.regions[found[next]] as usize] {
                    let at = place[other as usize];
                    if range.contains(&at) && !std::mem::replace(&mut is_found[at - range.start], true) {
                        found.push(at);
                    }
                }
                next += 1;
            }
            found.len() == range.len()
        };
        self.clusters.iter().map(is_whole).collect()
    }

    /// Largest value of the nodes of each cluster.
    ///
    /// * `of_node`: (k,) per node
    pub(super) fn largest(&self, of_node: &[f64]) -> Vec<f64> {
        self.folded(of_node, f64::max)
    }

    /// Smallest value of the nodes of each cluster.
    ///
    /// * `of_node`: (k,) per node
    pub(super) fn smallest(&self, of_node: &[f64]) -> Vec<f64> {
        self.folded(of_node, f64::min)
    }

    fn folded(&self, of_node: &[f64], choose: fn(f64, f64) -> f64) -> Vec<f64> {
        let of_place: Vec<f64> = self.order.iter().map(|&node| of_node[node as usize]).collect();
        let fold = |cluster: &Cluster| of_place[cluster.nodes.clone()].iter().copied().reduce(choose);
        self.clusters.iter().map(|cluster| fold(cluster).expect("a cluster has nodes")).collect()
    }
}

fn bounds(points: impl Iterator<Item = Vector3<f64>>) -> (Vector3<f64>, Vector3<f64>) {
    let nothing = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    points.fold(nothing, |(low, high), point| (low.inf(&point), high.sup(&point)))
}
