//! Response matrices of kernels that fade: only pairs within reach are computed and stored.

use super::assemble::Columns;
use super::column::Scratch;
use super::error::ResponseError;
use super::options::{AssemblyOptions, check_request};
use super::parallel::map_in_order;
use super::skin::Skin;
use crate::surface::Surface;
use faer::Mat;
use std::collections::BTreeMap;

/// A response matrix of which only the entries within reach are stored, column by column.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalMatrix {
    order: usize,
    /// Where each column starts in `rows` and `values`, and the end.
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

/// Index of a column, with its entries: row and value.
type Column = (u32, Vec<(u32, f64)>);

/// [`assemble`](super::assemble) for kernels that fade: the layer and the Gaussian with a cutoff.
///
/// Nodes are sorted into cubes of the kernel's reach ([`Skin::assembled_reach`]); each column looks only at the
/// cubes around its own, so the cost is proportional to the number of stored entries. Left out are entries
/// that are 0, which a layer's are where its kernel stays below 0.01 `tolerance` K/h.
///
/// * `nodes`: (k,) vertices of the mesh, no two equal
/// * `options`: as for `assemble`; `memory_limit` counts what is stored
///
/// # Errors
/// [`ResponseError::NotLocal`] for a kernel that is felt everywhere, and those of `assemble`.
pub fn assemble_local(
    surface: &Surface,
    skin: &Skin,
    nodes: &[usize],
    options: &AssemblyOptions,
) -> Result<LocalMatrix, ResponseError> {
    skin.validate()?;
    skin.check_against(surface)?;
    check_request(surface, nodes, 0, None, options)?;
    let reach = skin.assembled_reach(options.tolerance).ok_or(ResponseError::NotLocal {
        kernel: if skin.has_negative_entries() { "Gaussian-corrected" } else { "half-space" },
    })?;
    let points = surface.vertices();
    let edge = |&v: &usize| {
        let ring = surface.neighbours(v).iter();
        ring.map(|&w| (points[w as usize] - points[v]).norm()).fold(0.0, f64::max)
    };
    // A load reaches one ring beyond its node.
    let side = reach + 2.0 * nodes.iter().map(edge).fold(0.0, f64::max);
    let cell = |v: usize| points[v].map(|c| (c / side).floor() as i64);
    let mut cells: BTreeMap<[i64; 3], Vec<u32>> = BTreeMap::new();
    for (index, &v) in nodes.iter().enumerate() {
        cells.entry(cell(v).into()).or_default().push(index as u32);
    }
    // Columns of one cube share the rows of the cubes around it.
    let cubes: Vec<(&[i64; 3], &Vec<u32>)> = cells.iter().collect();
    let cube = |c: usize| -> Result<Vec<Column>, ResponseError> {
        let (place, members) = cubes[c];
        let mut around = Vec::new();
        for step in 0..27 {
            let shift = [step / 9 - 1, step / 3 % 3 - 1, step % 3 - 1];
            let key = std::array::from_fn::<i64, 3, _>(|k| place[k] + shift[k]);
            around.extend(cells.get(&key).into_iter().flatten().copied());
        }
        around.sort_unstable();
        let rows: Vec<usize> = around.iter().map(|&i| nodes[i as usize]).collect();
        let kernel = Columns::new(surface, skin, &rows, options)?;
        let mut scratch = Scratch::new(&kernel.targets);
        let column = |&j: &u32| {
            kernel.fill(&mut scratch, nodes[j as usize]);
            let values = kernel.targets.rows.iter().zip(&scratch.values).filter(|(_, value)| **value != 0.0);
            let mut entries: Vec<_> = values.map(|(&row, &value)| (around[row as usize], value)).collect();
            entries.sort_unstable_by_key(|entry| entry.0);
            (j, entries)
        };
        Ok(members.iter().map(column).collect())
    };
    let mut columns: Vec<Vec<(u32, f64)>> = vec![Vec::new(); nodes.len()];
    let mut entries = 0;
    map_in_order(cubes.len(), options, cube, |found| {
        for (j, column) in found {
            entries += column.len();
            columns[j as usize] = column;
        }
        let bytes = stored_bytes(nodes.len(), entries);
        match options.memory_limit {
            Some(limit) if bytes > limit => Err(ResponseError::TooLarge { nodes: nodes.len(), bytes, limit }),
            _ => Ok(()),
        }
    })?;
    let mut matrix = LocalMatrix {
        order: nodes.len(),
        starts: Vec::with_capacity(nodes.len() + 1),
        rows: Vec::with_capacity(entries),
        values: Vec::with_capacity(entries),
    };
    matrix.starts.push(0);
    for column in columns {
        matrix.rows.extend(column.iter().map(|entry| entry.0));
        matrix.values.extend(column.iter().map(|entry| entry.1));
        matrix.starts.push(matrix.rows.len());
    }
    Ok(matrix)
}

fn stored_bytes(order: usize, entries: usize) -> usize {
    entries * (size_of::<u32>() + size_of::<f64>()) + (order + 1) * size_of::<usize>()
}

impl LocalMatrix {
    /// Number of nodes k.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// Memory that the matrix takes (bytes).
    pub fn bytes(&self) -> usize {
        stored_bytes(self.order, self.entries())
    }

    /// Rows and values (m/N) of a column, rows rising.
    pub fn column(&self, node: usize) -> (&[u32], &[f64]) {
        let range = self.starts[node]..self.starts[node + 1];
        (&self.rows[range.clone()], &self.values[range])
    }

    /// R f (m).
    ///
    /// * `forces`: (k,) f (N)
    pub fn apply(&self, forces: &[f64]) -> Vec<f64> {
        let mut displacement = vec![0.0; self.order];
        for (j, force) in forces.iter().enumerate() {
            let (rows, values) = self.column(j);
            for (&i, value) in rows.iter().zip(values) {
                displacement[i as usize] += value * force;
            }
        }
        displacement
    }

    /// The dense matrix, with zeros where nothing is stored.
    pub fn to_dense(&self) -> Mat<f64> {
        let mut dense = Mat::zeros(self.order, self.order);
        for j in 0..self.order {
            let (rows, values) = self.column(j);
            for (&i, &value) in rows.iter().zip(values) {
                dense[(i as usize, j)] = value;
            }
        }
        dense
    }

    /// Groups of nodes between which no entry is stored, each sorted: separate contact problems.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let mut parent: Vec<usize> = (0..self.order).collect();
        fn root(parent: &mut [usize], mut v: usize) -> usize {
            while parent[v] != v {
                parent[v] = parent[parent[v]];
                v = parent[v];
            }
            v
        }
        for j in 0..self.order {
            for &i in self.column(j).0 {
                let (a, b) = (root(&mut parent, i as usize), root(&mut parent, j));
                parent[a.max(b)] = a.min(b);
            }
        }
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for v in 0..self.order {
            groups.entry(root(&mut parent, v)).or_default().push(v);
        }
        groups.into_values().collect()
    }
}
