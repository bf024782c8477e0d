//! Blocks across a cutoff: a matrix of low rank, of which each row has the columns within the cutoff.

use super::cross::LowRank;

/// Rows and columns of such a block, at most; places in it fit a byte.
pub(super) const LARGEST: usize = 128;

/// A smooth matrix where the kernel has not ended, its cut entries by themselves, and zeros beyond.
///
/// The columns are sorted by their distance from the rows, so that those of a row's smooth entries come first but for a
/// few, and a product needs their sums up to each column alone.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Step {
    pub(super) smooth: LowRank,
    /// Columns, nearest to the rows first.
    pub(super) order: Vec<u8>,
    /// Per row, how many of these have the smooth entries.
    pub(super) inside: Vec<u8>,
    /// Where the other entries of each row begin, and where the last row's end.
    pub(super) starts: Vec<u16>,
    pub(super) columns: Vec<u8>,
    pub(super) values: Vec<f64>,
}

impl Step {
    fn rows(&self) -> usize {
        self.inside.len()
    }

    /// Number of stored values.
    pub(super) fn entries(&self) -> usize {
        self.smooth.left.len() + self.smooth.right.len() + self.values.len()
    }

    /// Memory beside that of the stored values (bytes).
    pub(super) fn other_bytes(&self) -> usize {
        let places = self.order.len() + self.inside.len() + self.columns.len();
        size_of::<Self>() + places + size_of::<u16>() * self.starts.len()
    }

    /// The entries of a row that are stored by themselves: columns and values.
    fn others(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        self.columns[range.clone()].iter().map(|&j| j as usize).zip(self.values[range].iter().copied())
    }

    /// Columns of which a row has entries other than 0, those with smooth ones first.
    pub(super) fn columns_of(&self, row: usize) -> impl Iterator<Item = usize> {
        let smooth = self.order[..self.inside[row] as usize].iter().map(|&j| j as usize);
        let others = self.others(row).filter(|&(_, value)| value != 0.0);
        smooth.chain(others.map(|(j, _)| j))
    }

    /// Entry (i, j).
    pub(super) fn at(&self, i: usize, j: usize) -> f64 {
        if self.order[..self.inside[i] as usize].contains(&(j as u8)) {
            return self.smooth.at(i, j, self.rows(), self.order.len());
        }
        self.others(i).find(|&(column, _)| column == j).map_or(0.0, |(_, value)| value)
    }

    /// The block times a vector.
    ///
    /// * `forces`: (columns,)
    pub(super) fn apply(&self, forces: &[f64]) -> Vec<f64> {
        let (m, n) = (self.rows(), self.order.len());
        let mut result: Vec<f64> =
            (0..m).map(|i| self.others(i).map(|(j, value)| value * forces[j]).sum()).collect();
        let mut sums = vec![0.0; n + 1];
        for (left, right) in self.smooth.left.chunks_exact(m).zip(self.smooth.right.chunks_exact(n)) {
            for (place, &j) in self.order.iter().enumerate() {
                sums[place + 1] = sums[place] + right[j as usize] * forces[j as usize];
            }
            for ((value, share), &count) in result.iter_mut().zip(left).zip(&self.inside) {
                *value += share * sums[count as usize];
            }
        }
        result
    }

    /// The transposed block times a vector.
    ///
    /// * `forces`: (rows,)
    pub(super) fn apply_transposed(&self, forces: &[f64]) -> Vec<f64> {
        let (m, n) = (self.rows(), self.order.len());
        let mut result = vec![0.0; n];
        for (i, &force) in forces.iter().enumerate() {
            self.others(i).for_each(|(j, value)| result[j] += value * force);
        }
        let mut sums = vec![0.0; n + 1];
        for (left, right) in self.smooth.left.chunks_exact(m).zip(self.smooth.right.chunks_exact(n)) {
            // of the rows that have exactly, then at least, so many smooth entries
            sums.fill(0.0);
            for ((share, force), &count) in left.iter().zip(forces).zip(&self.inside) {
                sums[count as usize] += share * force;
            }
            (0..n).rev().for_each(|count| sums[count] += sums[count + 1]);
            for (place, &j) in self.order.iter().enumerate() {
                result[j as usize] += right[j as usize] * sums[place + 1];
            }
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_entries() {
        let (m, n, rank) = (5, 7, 2);
        let number = |k: usize| (k as f64 * 0.7).sin();
        let mut step = Step {
            smooth: LowRank {
                rank,
                left: (0..m * rank).map(number).collect(),
                right: (0..n * rank).map(|k| number(k + 30)).collect(),
            },
            order: vec![3, 0, 6, 1, 2, 5, 4],
            starts: vec![0],
            ..Step::default()
        };
        for i in 0..m {
            // none, some, and all of the columns smooth; the one after the next by itself
            let inside = [0, 3, 7, 1, 5][i];
            step.inside.push(inside);
            if let Some(&column) = step.order.get(inside as usize + 1) {
                step.columns.push(column);
                step.values.push(number(i + 60));
            }
            step.starts.push(step.values.len() as u16);
        }
        assert_eq!(step.columns_of(0).collect::<Vec<_>>(), [0]);
        assert_eq!(step.columns_of(1).collect::<Vec<_>>(), [3, 0, 6, 2]);
        assert_eq!((step.at(1, 1), step.at(1, 2)), (0.0, number(61)));
        assert!(step.at(1, 6) == step.smooth.at(1, 6, m, n) && step.at(1, 6) != 0.0);
        // what a cutoff leaves nothing of couples nothing
        step.values[0] = 0.0;
        assert_eq!(step.columns_of(0).count(), 0);
        let (columns, rows): (Vec<f64>, Vec<f64>) =
            ((90..97).map(number).collect(), (80..85).map(number).collect());
        for (i, value) in step.apply(&columns).into_iter().enumerate() {
            let expected: f64 = (0..n).map(|j| step.at(i, j) * columns[j]).sum();
            assert!((value - expected).abs() < 1e-14);
        }
        for (j, value) in step.apply_transposed(&rows).into_iter().enumerate() {
            let expected: f64 = (0..m).map(|i| step.at(i, j) * rows[i]).sum();
            assert!((value - expected).abs() < 1e-14);
        }
    }
}
