//! Computes the blocks across a cutoff.

use super::super::column::Scratch;
use super::super::source::loaded_faces;
use super::super::targets::Targets;
use super::assemble::Work;
use super::cut_load::CutLoads;
use super::matrix::{Block, Values};
use super::plan::Place;
use super::step::Step;
use nalgebra::Vector3;

/// A cut entry: its block, place among the values there, and row.
struct Cut {
    block: usize,
    slot: usize,
    row: usize,
}

impl Work<'_> {
    /// Blocks across the cutoff over the same columns.
    pub(super) fn across(&self, cut_loads: &CutLoads, places: &[Place]) -> Vec<Block> {
        let columns = self.plan.tree.clusters[places[0].columns].nodes.clone();
        let mut cuts: Vec<Vec<Cut>> = columns.clone().map(|_| Vec::new()).collect();
        let mut found: Vec<(Place, Step)> = Vec::with_capacity(places.len());
        for &place in places {
            if let Some(step) = self.uncut(cut_loads, place, found.len(), &mut cuts) {
                found.push((place, step));
            }
        }
        let (mut scratch, mut points) = (Scratch::new(&Targets::default()), Vec::new());
        for (cuts, column) in cuts.iter().zip(columns).filter(|(cuts, _)| !cuts.is_empty()) {
            scratch.faces.clear();
            loaded_faces(self.surface, self.far.vertex(column), self.skin.pressure(), &mut scratch.faces);
            points.clear();
            points.extend(cuts.iter().map(|cut| self.far.point(cut.row)));
            for (cut, value) in cuts.iter().zip(cut_loads.values(&mut scratch, &points)) {
                found[cut.block].1.values[cut.slot] = value;
            }
        }
        let block = |(place, step)| Block { place, values: Values::Step(Box::new(step)) };
        found.into_iter().map(block).collect()
    }

    /// A block but for its cut entries, which are noted under the number of the block; `None` where it is below the
    /// threshold.
    fn uncut(&self, cut_loads: &CutLoads, place: Place, block: usize, cuts: &mut [Vec<Cut>]) -> Option<Step> {
        let [rows, columns] = [place.rows, place.columns].map(|c| self.plan.tree.clusters[c].nodes.clone());
        let smooth = self.smooth(place)?;
        let center = self.plan.tree.clusters[place.rows].center();
        let away = |column: usize| (self.far.point(column) - center).norm_squared();
        let mut near_first: Vec<(f64, u8)> = columns.clone().map(away).zip(0..).collect();
        near_first.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let order: Vec<u8> = near_first.into_iter().map(|(_, column)| column).collect();
        let loads = Loads::new(
            order.iter().map(|&j| {
                let column = columns.start + j as usize;
                (self.far.point(column), self.load_radius[column])
            }),
            cut_loads.cutoff(),
        );
        let mut step = Step { order, starts: vec![0], ..Step::default() };
        let mut away = vec![0.0; columns.len()];
        for (i, row) in rows.clone().enumerate() {
            pulp::Arch::new().dispatch(|| loads.squared_distances(&self.far.point(row), &mut away));
            // entries without a low rank are all kept by themselves
            let inside = match smooth {
                Values::LowRank(_) => (0..away.len()).take_while(|&k| away[k] <= loads.within[k]).count(),
                _ => 0,
            };
            for k in (inside..away.len()).filter(|&k| away[k] < loads.beyond[k]) {
                let column = step.order[k] as usize;
                if away[k] <= loads.within[k] {
                    step.values.push(smooth.at(i, column, rows.len(), columns.len()));
                } else {
                    cuts[column].push(Cut { block, slot: step.values.len(), row });
                    step.values.push(0.0);
                }
                step.columns.push(column as u8);
            }
            step.inside.push(inside as u8);
            step.starts.push(step.values.len() as u16);
        }
        if let Values::LowRank(smooth) = smooth
            && step.inside.iter().any(|&count| count > 0)
        {
            step.smooth = smooth;
        }
        Some(step)
    }
}

/// The loads of a block's columns, in the order of a step.
struct Loads {
    at: [Vec<f64>; 3],
    /// Squared distances (m²) of a node up to which it has a load within the cutoff, and from which on beyond.
    within: Vec<f64>,
    beyond: Vec<f64>,
}

impl Loads {
    /// * `loads`: place and radius (m) of each
    fn new(loads: impl Iterator<Item = (Vector3<f64>, f64)>, cutoff: f64) -> Self {
        let mut made = Self { at: Default::default(), within: Vec::new(), beyond: Vec::new() };
        for (point, radius) in loads {
            (0..3).for_each(|axis| made.at[axis].push(point[axis]));
            made.within.push((cutoff - radius).max(0.0).powi(2));
            made.beyond.push((cutoff + radius).powi(2));
        }
        made
    }

    #[inline(always)]
    fn squared_distances(&self, node: &Vector3<f64>, squared: &mut [f64]) {
        let [x, y, z] = &self.at;
        for (((squared, x), y), z) in squared.iter_mut().zip(x).zip(y).zip(z) {
            let (dx, dy, dz) = (x - node.x, y - node.y, z - node.z);
            *squared = dx * dx + dy * dy + dz * dz;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::assemble::assemble;
    use super::super::super::options::AssemblyOptions;
    use super::super::super::skin::{Pressure, Response, Skin};
    use super::super::{LocalOptions, assemble_local};
    use super::*;
    use crate::surface::Surface;

    #[test]
    fn a_fine_mesh_is_cut_in_steps_that_keep_the_threshold() {
        let cells = 40;
        let corner = |i: usize, j: usize| {
            let (x, y) = (0.5e-3 * i as f64 + 0.1e-3 * (j % 3) as f64, 0.5e-3 * j as f64);
            Vector3::new(x, y, 8.0 * (x - 0.01).powi(2))
        };
        let vertices = (0..=cells).flat_map(|i| (0..=cells).map(move |j| corner(i, j))).collect();
        let at = |i: usize, j: usize| (i * (cells + 1) + j) as u32;
        let square = |i: usize, j: usize| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        };
        let faces = (0..cells).flat_map(|i| (0..cells).flat_map(move |j| square(i, j))).collect();
        let surface = Surface::new(vertices, faces).expect("a grid");
        let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
        for pressure in [Pressure::Linear, Pressure::OneRing] {
            let response = Response::GaussianCorrected { height: 3e-4, width: 4e-3, cutoff: 7e-3, pressure };
            let skin = Skin::new(60e3, 0.5, response).expect("valid constants");
            let options = AssemblyOptions { tolerance: 1e-8, ..Default::default() };
            let exact = assemble(&surface, &skin, &nodes, None, &options).expect("valid");
            for threshold in [1e-2, 1e-3, 1e-4] {
                let options = LocalOptions { threshold, ..Default::default() };
                let matrix = assemble_local(&surface, &skin, &nodes, &options).expect("local");
                let stored = |block: &Block| match &block.values {
                    Values::Step(step) => step.entries(),
                    _ => 0,
                };
                let in_steps: usize = matrix.blocks.iter().map(stored).sum();
                assert!(5 * in_steps > matrix.entries(), "{in_steps} of {}", matrix.entries());
                let error = (&exact - matrix.to_dense()).norm_l2();
                // what an even load is multiplied by is below the spectral norm
                let even = faer::Mat::<f64>::full(nodes.len(), 1, 1.0);
                let scale = (&exact * &even).norm_l2() / even.norm_l2();
                assert!(error <= threshold * scale, "{threshold}: {:e}", error / scale);
            }
        }
    }
}
