//! Computes a local matrix block by block.

use super::super::assemble::Columns;
use super::super::column::Scratch;
use super::super::corrected::Corrected;
use super::super::error::ResponseError;
use super::super::options::{AssemblyOptions, check_request};
use super::super::parallel::map_in_order;
use super::super::skin::{Response, Skin};
use super::clusters::ClusterTree;
use super::cross::{Allowance, cross_approximation};
use super::cut_load::CutLoads;
use super::far::FarField;
use super::matrix::{Block, LocalMatrix, Values};
use super::norm::norm_over_reach;
use super::options::LocalOptions;
use super::plan::{PANEL, Place, Plan};
use crate::surface::{SkinRegions, Surface};

/// Regions of the skin have this share of the reach as their radius.
const REGION: f64 = 1.0 / 6.0;
/// Loads that extend no farther around their nodes than this share of the cutoff are cut within its tolerance.
const CUT: f64 = 1.0 / 6.0;
/// Shares of the threshold that the far blocks may err by, of their own norm and of the whole matrix's.
const RELATIVE: f64 = 0.25;
const EACH: f64 = 0.25;
/// Share of the threshold that far entries may err by against K/r, as a few point forces stand for each load.
const POINTS: f64 = 0.5;
/// Far blocks in one piece of work.
const TOGETHER: usize = 32;

/// A response matrix of a kernel that fades (the layer, the Gaussian with a cutoff), in blocks.
///
/// Nodes are sorted into a tree of clusters. Blocks beyond the kernel's reach are left out; blocks whose clusters are
/// far from each other against their size are stored as sums of a few products of vectors; the others entry by entry.
/// Cost and memory grow in proportion to the nodes, but for a logarithm, where the mesh is refined. The Gaussian jumps
/// at its cutoff: what it cuts is stored entry by entry, some `4 π L h / S` for each node (cutoff L, edges h, vertex
/// areas S). That grows with the 1.5th power, but is less than a fifth of the cost at 200,000 nodes. Where a layer's
/// thickness jumps by more than a factor of 2 from node to node all over the skin, all entries within the reach of the
/// thickest node are; this reach, of the largest thickness, is also that of the regions by which fingers are told apart.
///
/// Nodes on different fingers are not coupled, whatever the straight-line distance between them: see
/// [`shares_tissue`](crate::surface::shares_tissue), asked of regions a sixth of the reach wide. Dense
/// [`assemble`](super::super::assemble) does not look at this.
///
/// * `surface`: the skin's mesh
/// * `skin`: material and kernel
/// * `nodes`: (k,) vertices of the mesh, no two equal
/// * `options`: threshold, threads, memory
///
/// # Errors
/// [`ResponseError::NotLocal`] for a kernel that is felt everywhere, and those of `assemble`.
pub fn assemble_local(
    surface: &Surface,
    skin: &Skin,
    nodes: &[usize],
    options: &LocalOptions,
) -> Result<LocalMatrix, ResponseError> {
    skin.validate()?;
    skin.check_against(surface)?;
    let entries = options.of_entries()?;
    check_request(surface, nodes, 0, None, &entries)?;
    let not_local = || ResponseError::NotLocal {
        kernel: if skin.has_negative_entries() { "Gaussian-corrected" } else { "half-space" },
    };
    let reach = skin.assembled_reach(options.threshold).ok_or_else(not_local)?;
    let mut matrix = LocalMatrix::empty(skin.clone(), nodes.len(), options.threshold);
    if nodes.is_empty() {
        return Ok(matrix);
    }
    let load_radius: Vec<f64> = nodes.iter().map(|&vertex| longest_edge(surface, vertex)).collect();
    let points = POINTS * options.threshold;
    let cut_loads = cut_loads_of(skin, &load_radius, options.tolerance.unwrap_or(points).min(points));
    let regions = SkinRegions::new(surface, REGION * reach);
    let pairs = regions.pairs_within(surface, reach + load_radius.iter().copied().fold(0.0, f64::max));
    let density = norm_over_reach(skin, reach);
    let jump = match skin.response {
        Response::GaussianCorrected { cutoff, .. } => Some(cutoff),
        _ => None,
    };
    let tree = ClusterTree::new(surface, nodes, &regions, PANEL);
    let of_node: Vec<f64> = match &skin.response {
        Response::Layer { thickness, .. } => {
            nodes.iter().map(|&vertex| reach * thickness.at(vertex) / thickness.largest()).collect()
        }
        _ => vec![reach; nodes.len()],
    };
    let (reach, least_reach) = (tree.largest(&of_node), tree.smallest(&of_node));
    let radius_at: Vec<f64> = tree.order.iter().map(|&node| load_radius[node as usize]).collect();
    let load_radius = tree.largest(&load_radius);
    let largest_cut = cut_loads.as_ref().map_or(0.0, |cut_loads| cut_loads.largest_load());
    let is_whole = tree.whole(&pairs.sharing);
    let plan =
        Plan { tree: &tree, pairs: &pairs, is_whole, reach, least_reach, load_radius, jump, largest_cut };
    let blocks = plan.blocks();
    let vertices: Vec<usize> = tree.order.iter().map(|&node| nodes[node as usize]).collect();
    let region: Vec<u32> = vertices.iter().map(|&vertex| regions.of(vertex) as u32).collect();
    let far = FarField::new(surface, skin, vertices, points)?;
    let work = Work {
        plan: &plan,
        far: &far,
        surface,
        skin,
        region: &region,
        load_radius: &radius_at,
        entries: &entries,
        threshold: options.threshold,
        density,
        median_reach: median(of_node),
    };
    // Blocks with entries by themselves are computed together over the same columns, as they share the loads.
    let (mut dense, mut across) = (blocks.dense, blocks.across);
    let by_columns =
        |places: &mut Vec<Place>| places.sort_unstable_by_key(|place| (place.columns, place.rows));
    by_columns(&mut dense);
    by_columns(&mut across);
    let panels = dense.chunk_by(|a, b| a.columns == b.columns).map(Piece::Dense);
    let steps = across.chunk_by(|a, b| a.columns == b.columns).map(Piece::Across);
    let strips = blocks.far.chunks(TOGETHER).map(Piece::Far);
    let pieces: Vec<Piece> = panels.chain(steps).chain(strips).collect();
    let compute = |i: usize| match pieces[i] {
        Piece::Dense(places) => work.dense(places),
        Piece::Across(places) => {
            Ok(cut_loads.iter().flat_map(|cut_loads| work.across(cut_loads, places)).collect())
        }
        Piece::Far(places) => Ok(places.iter().filter_map(|&place| work.far(place)).collect()),
    };
    map_in_order(pieces.len(), &entries, compute, |found| {
        matrix.extend(found);
        let bytes = matrix.bytes();
        match options.memory_limit {
            Some(limit) if bytes > limit => Err(ResponseError::TooLarge { nodes: nodes.len(), bytes, limit }),
            _ => Ok(()),
        }
    })?;
    matrix.finish(tree);
    Ok(matrix)
}

/// Blocks that are computed in one go.
enum Piece<'a> {
    Dense(&'a [Place]),
    Across(&'a [Place]),
    Far(&'a [Place]),
}

/// The cut loads of a kernel with a cutoff, unless they are large or the kernel is steep.
fn cut_loads_of(skin: &Skin, load_radius: &[f64], tolerance: f64) -> Option<CutLoads> {
    let Response::GaussianCorrected { height, width, cutoff, .. } = skin.response else { return None };
    let kernel = Corrected { constant: skin.kernel_constant(), height, width, cutoff };
    let fitting = load_radius.iter().copied().filter(|radius| *radius <= CUT * cutoff);
    CutLoads::new(kernel, fitting.fold(0.0, f64::max), tolerance)
}

/// What the blocks of one matrix share.
pub(super) struct Work<'a> {
    pub(super) plan: &'a Plan<'a>,
    pub(super) far: &'a FarField<'a>,
    pub(super) surface: &'a Surface,
    pub(super) skin: &'a Skin,
    /// Region of the skin at each place.
    region: &'a [u32],
    /// How far the load extends around the node at each place (m).
    pub(super) load_radius: &'a [f64],
    entries: &'a AssemblyOptions<'a>,
    threshold: f64,
    /// See [`norm_over_reach`].
    density: f64,
    /// Half of the nodes reach as far (m).
    median_reach: f64,
}

impl Work<'_> {
    /// A block of low rank, or of all its entries where that is smaller; `None` where it is below the threshold.
    fn far(&self, place: Place) -> Option<Block> {
        self.smooth(place).map(|values| Block { place, values })
    }

    /// The entries of a block of the kernel without its cutoff.
    pub(super) fn smooth(&self, place: Place) -> Option<Values> {
        let [rows, columns] = [place.rows, place.columns].map(|cluster| &self.plan.tree.clusters[cluster]);
        let clearance = self.plan.clearance(place);
        let load_radius = self.plan.load_radius[place.columns];
        let mut entries = self.far.block(rows.nodes.clone(), columns.nodes.clone(), clearance, load_radius);
        let reach = self.plan.reach_in(place);
        // As many entries as there are nodes within reach may err by this and add up to a share of the norm; of layers
        // thicker than at half of the nodes there may be too little to answer as a wide surface does.
        let share = (self.median_reach / reach).min(1.0);
        let each = EACH * self.threshold * self.density * share / (std::f64::consts::PI * reach);
        let allowance = Allowance { relative: RELATIVE * self.threshold, each };
        let looks = self.far.looks(rows.nodes.clone(), &columns.center());
        let shape = (rows.nodes.len(), columns.nodes.len());
        match cross_approximation(&mut entries, shape, &looks, allowance) {
            Some(low_rank) if low_rank.rank == 0 => None,
            Some(low_rank) => Some(Values::LowRank(low_rank)),
            None => Some(Values::Dense(entries.dense())),
        }
    }

    /// Dense blocks over the same columns.
    fn dense(&self, places: &[Place]) -> Result<Vec<Block>, ResponseError> {
        let tree = self.plan.tree;
        let vertex = |at: usize| self.far.vertex(at);
        let rows: Vec<usize> =
            places.iter().flat_map(|place| tree.clusters[place.rows].nodes.clone()).map(vertex).collect();
        let columns = tree.clusters[places[0].columns].nodes.clone();
        let kernel = Columns::new(self.surface, self.skin, &rows, self.entries)?;
        let mut scratch = Scratch::new(&kernel.targets);
        let mut blocks: Vec<Vec<f64>> = places
            .iter()
            .map(|place| Vec::with_capacity(tree.clusters[place.rows].nodes.len() * columns.len()))
            .collect();
        let mut column = vec![0.0; rows.len()];
        for at in columns.clone() {
            kernel.fill(&mut scratch, vertex(at));
            kernel.targets.scatter(&scratch.values, &mut column);
            let mut rest = &mut column[..];
            for (place, block) in places.iter().zip(&mut blocks) {
                let nodes = tree.clusters[place.rows].nodes.clone();
                let (mine, others) = rest.split_at_mut(nodes.len());
                for (value, row) in mine.iter_mut().zip(nodes) {
                    if !self.plan.shares(self.region[row], self.region[at]) {
                        *value = 0.0;
                    }
                }
                block.extend(&*mine);
                rest = others;
            }
        }
        let block = |(&place, values): (&Place, Vec<f64>)| Block { place, values: Values::Dense(values) };
        Ok(places.iter().zip(blocks).map(block).collect())
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// How far a load extends around its node (m).
fn longest_edge(surface: &Surface, vertex: usize) -> f64 {
    let point = surface.vertices()[vertex];
    let ring = surface.neighbours(vertex).iter();
    ring.map(|&other| (surface.vertices()[other as usize] - point).norm()).fold(0.0, f64::max)
}
