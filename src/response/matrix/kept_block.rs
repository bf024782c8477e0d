//! A block of a kernel on one mesh that grows with what is asked of it.
//!
//! A contact asks again and again about nearly the same vertices: for every group of nodes that grows and for every
//! linearization. Directions change in between, the kernel does not.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, MutexGuard};

use faer::Mat;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::linalg::columns::par_columns;
use crate::response::error::ResponseError;
use crate::response::matrix::displaced::{displaced, displaced_at};
use crate::response::matrix::missing::{Missing, missing};
use crate::response::matrix::options::{AssemblyOptions, check_memory};

/// Assembles columns (m/N): for some rows, of some vertices.
pub(crate) trait Assemble:
    Fn(&[usize], &[usize], &AssemblyOptions) -> Result<Vec<Vec<f64>>, ResponseError>
{
}

impl<F> Assemble for F where
    F: Fn(&[usize], &[usize], &AssemblyOptions) -> Result<Vec<Vec<f64>>, ResponseError>
{
}

/// Entries of a kernel on one mesh; clones share them.
#[derive(Debug, Clone, Default)]
pub(crate) struct KeptBlock(Arc<Mutex<KnownEntries>>);

#[derive(Debug, Default)]
struct KnownEntries {
    /// Relative quadrature tolerance of the entries; `None` without any.
    tolerance: Option<f64>,
    /// Place in the columns of every vertex that was asked for.
    places: HashMap<usize, usize>,
    /// Displacement at each place per newton at a vertex (m/N); NaN, or not there, where nobody asked.
    columns: HashMap<usize, Vec<f64>>,
    /// Lists of vertices that are expected to be asked of together, no vertex in two of them.
    expected: Vec<Vec<usize>>,
}

impl KeptBlock {
    /// Notes vertices that are expected to be asked of together, in lists: new columns are assembled for all of a list at
    /// once, as a load that is made ready serves them all.
    pub fn expect(&self, lists: Vec<Vec<usize>>) {
        self.lock().expected = lists;
    }

    /// Displacement of `rows` per newton at each of `columns` (rows × columns, m/N), no two vertices of either equal.
    ///
    /// An entry is right to the tolerance asked for, and not equal to the bit whatever it was assembled with. Where two
    /// copies would be too large, nothing is kept.
    ///
    /// * `assemble`: the columns of what is not known yet
    pub fn entries(
        &self,
        rows: &[usize],
        columns: &[usize],
        options: &AssemblyOptions,
        assemble: impl Assemble,
    ) -> Result<Mat<f64>, ResponseError> {
        let mut known = self.lock();
        known.tolerance = known.tolerance.filter(|&tolerance| tolerance <= options.tolerance);
        if known.tolerance.is_none() {
            known.forget();
            known.tolerance = Some(options.tolerance);
        }
        let is_new = |vertex: &usize| !known.columns.contains_key(vertex);
        let new: Vec<usize> = columns.iter().copied().filter(is_new).collect();
        let wanted = if new.is_empty() { rows.to_vec() } else { known.with_expected(rows) };
        let [all_rows, all_columns] =
            [known.places.len() + wanted.len() + rows.len(), known.columns.len() + columns.len()];
        if check_memory(all_rows, all_columns, options).is_err() {
            known.forget();
            let mut block = Mat::zeros(rows.len(), columns.len());
            // Each column goes once it is copied.
            for (column, entries) in assemble(rows, columns, options)?.into_iter().enumerate() {
                block.col_as_slice_mut(column).copy_from_slice(&entries);
            }
            return Ok(block);
        }
        let options = AssemblyOptions { tolerance: known.tolerance.unwrap_or(options.tolerance), ..*options };
        let is_first = known.places.is_empty();
        let places = known.places_of(&wanted);
        if !new.is_empty() {
            let found = assemble(&wanted, &new, &options)?;
            for (vertex, entries) in new.into_iter().zip(found) {
                // The first are in the order of their places.
                let kept = if is_first { entries } else { known.placed(&places, &entries) };
                known.columns.insert(vertex, kept);
            }
        }
        let places = &places[..rows.len()];
        let (mut block, open) = known.gathered(places, columns);
        for Missing { rows: missing, columns: of_columns } in missing(&block, open) {
            let pick = |numbers: &[usize], vertices: &[usize]| -> Vec<usize> {
                numbers.iter().map(|&number| vertices[number]).collect()
            };
            let found = assemble(&pick(&missing, rows), &pick(&of_columns, columns), &options)?;
            let count = known.places.len();
            for (column, own) in of_columns.into_iter().zip(found) {
                let kept = known.columns.entry(columns[column]).or_default();
                kept.resize(count, f64::NAN);
                let entries = block.col_as_slice_mut(column);
                for (&row, entry) in missing.iter().zip(own) {
                    (entries[row], kept[places[row]]) = (entry, entry);
                }
            }
        }
        Ok(block)
    }

    /// Displacement (m) of `rows` by the same entries, under forces (N) at vertices.
    pub fn displaced(
        &self,
        rows: &[usize],
        (vertices, forces): (&[usize], &[Vector3<f64>]),
        options: &AssemblyOptions,
        assemble: impl Assemble,
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        let known = self.lock().displaced(rows, vertices, forces, options.tolerance);
        if let Some(moved) = known {
            return Ok(moved);
        }
        let block = self.entries(rows, vertices, options, assemble)?;
        Ok(displaced(&block, forces))
    }

    fn lock(&self) -> MutexGuard<'_, KnownEntries> {
        self.0.lock().expect("no thread panics while it holds the lock")
    }
}

impl KnownEntries {
    /// Empty again, but for what is expected.
    fn forget(&mut self) {
        *self = Self { expected: std::mem::take(&mut self.expected), ..Self::default() };
    }

    /// Some rows, then those expected together with any of them.
    fn with_expected(&self, rows: &[usize]) -> Vec<usize> {
        let asked: HashSet<usize> = rows.iter().copied().collect();
        let lists = self.expected.iter().filter(|list| list.iter().any(|vertex| asked.contains(vertex)));
        let others = lists.flatten().copied().filter(|vertex| !asked.contains(vertex));
        rows.iter().copied().chain(others).collect()
    }

    /// A column out of entries at some places.
    fn placed(&self, places: &[usize], entries: &[f64]) -> Vec<f64> {
        let mut column = vec![f64::NAN; self.places.len()];
        places.iter().zip(entries).for_each(|(&place, &entry)| column[place] = entry);
        column
    }

    /// The place of every row.
    fn places_of(&mut self, rows: &[usize]) -> Vec<usize> {
        let mut place = |&row: &usize| {
            let next = self.places.len();
            *self.places.entry(row).or_insert(next)
        };
        rows.iter().map(&mut place).collect()
    }

    /// Displacement (m) of rows under forces (N) at columns; `None` where some entry is not known.
    fn displaced(
        &self,
        rows: &[usize],
        columns: &[usize],
        forces: &[Vector3<f64>],
        tolerance: f64,
    ) -> Option<Vec<Vector3<f64>>> {
        self.tolerance.filter(|&known| known <= tolerance)?;
        let places: Vec<usize> =
            rows.iter().map(|row| self.places.get(row).copied()).collect::<Option<_>>()?;
        let count = places.iter().max().map_or(0, |last| last + 1);
        let entries = |vertex: &usize| self.columns.get(vertex)?.get(..count);
        let entries: Vec<&[f64]> = columns.iter().map(entries).collect::<Option<_>>()?;
        let moved = displaced_at(&places, |column| entries[column], forces);
        moved.iter().all(|vector| !vector.sum().is_nan()).then_some(moved)
    }

    /// The entries at some places of columns, NaN where they are not known; and the columns that have such, by their
    /// numbers.
    fn gathered(&self, places: &[usize], columns: &[usize]) -> (Mat<f64>, Vec<usize>) {
        let mut block = Mat::zeros(places.len(), columns.len());
        let is_prefix = places.iter().enumerate().all(|(row, &place)| row == place);
        let gather = |(number, (entries, vertex)): (usize, (&mut [f64], &usize))| {
            let kept = self.columns.get(vertex).map_or(&[][..], |kept| kept);
            match kept.get(..places.len()).filter(|_| is_prefix) {
                Some(first) => entries.copy_from_slice(first),
                None => entries.iter_mut().zip(places).for_each(|(entry, &place)| {
                    *entry = kept.get(place).copied().unwrap_or(f64::NAN);
                }),
            }
            // The whole column, without a branch an entry.
            let is_open = entries.iter().fold(false, |is_open, entry| is_open | entry.is_nan());
            is_open.then_some(number)
        };
        let open = par_columns(&mut block).zip(columns).enumerate().filter_map(gather).collect();
        (block, open)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    #[test]
    fn every_entry_is_assembled_once_and_found_again() {
        let kept = KeptBlock::default();
        let asked = RefCell::new(Vec::new());
        let entry = |row: usize, column: usize| (100 * row + column) as f64;
        let ask = |rows: &[usize], columns: &[usize], tolerance: f64, limit: Option<usize>| {
            let options = AssemblyOptions { tolerance, memory_limit: limit, ..AssemblyOptions::default() };
            let assemble = |rows: &[usize], columns: &[usize], options: &AssemblyOptions| {
                asked.borrow_mut().push((rows.to_vec(), columns.to_vec(), options.tolerance));
                Ok(columns.iter().map(|&j| rows.iter().map(|&i| entry(i, j)).collect()).collect())
            };
            let found = kept.entries(rows, columns, &options, assemble).expect("nothing is refused");
            assert_eq!(found, Mat::from_fn(rows.len(), columns.len(), |i, j| entry(rows[i], columns[j])));
            asked.take()
        };
        assert_eq!(ask(&[3, 1], &[1, 3], 1e-4, None), [(vec![3, 1], vec![1, 3], 1e-4)]);
        assert_eq!(ask(&[1, 3], &[3], 1e-4, None), []);
        // A coarser question is answered, and what it lacks is assembled, to the finer tolerance.
        assert_eq!(ask(&[2, 1, 5], &[3], 1e-2, None), [(vec![2, 5], vec![3], 1e-4)]);
        // All rows in a new column, and a new row in those that know the others alike.
        assert_eq!(
            ask(&[1, 2, 3], &[1, 2, 3], 1e-4, None),
            [(vec![1, 2, 3], vec![2], 1e-4), (vec![2], vec![1], 1e-4)]
        );
        assert_eq!(ask(&[3], &[3], 1e-5, None), [(vec![3], vec![3], 1e-5)]);
        // A row that is known and three new ones twice, times three columns: 168 bytes.
        assert_eq!(ask(&[3, 4, 6], &[3, 4], 1e-5, Some(167)), [(vec![3, 4, 6], vec![3, 4], 1e-5)]);
        assert_eq!(ask(&[3], &[3], 1e-5, None), [(vec![3], vec![3], 1e-5)]);
    }

    #[test]
    fn rows_that_were_asked_for_without_a_column_keep_their_places() {
        let kept = KeptBlock::default();
        let assemble = |rows: &[usize], columns: &[usize], _: &AssemblyOptions| {
            Ok(columns.iter().map(|&j| rows.iter().map(|&i| (100 * i + j) as f64).collect()).collect())
        };
        for (rows, columns) in [(&[1, 2][..], &[][..]), (&[5], &[7]), (&[1], &[7]), (&[5, 2], &[7])] {
            let found = kept.entries(rows, columns, &AssemblyOptions::default(), assemble);
            let expected =
                Mat::from_fn(rows.len(), columns.len(), |i, j| (100 * rows[i] + columns[j]) as f64);
            assert_eq!(found.expect("nothing is refused"), expected);
        }
    }

    #[test]
    fn new_columns_are_assembled_for_all_that_is_expected_with_their_rows() {
        let kept = KeptBlock::default();
        let asked = RefCell::new(Vec::new());
        let assemble = |rows: &[usize], columns: &[usize], _: &AssemblyOptions| {
            asked.borrow_mut().push((rows.to_vec(), columns.to_vec()));
            Ok(columns.iter().map(|&j| rows.iter().map(|&i| (100 * i + j) as f64).collect()).collect())
        };
        kept.expect(vec![vec![1, 2, 3, 4], vec![7, 8]]);
        for (rows, columns) in [(&[3, 1][..], &[1, 3][..]), (&[4, 2], &[3]), (&[8], &[8]), (&[1, 9], &[2, 3])]
        {
            let found = kept.entries(rows, columns, &AssemblyOptions::default(), assemble);
            let expected =
                Mat::from_fn(rows.len(), columns.len(), |i, j| (100 * rows[i] + columns[j]) as f64);
            assert_eq!(found.expect("nothing is refused"), expected);
        }
        let expected = [
            (vec![3, 1, 2, 4], vec![1, 3]),
            (vec![8, 7], vec![8]),
            (vec![1, 9, 2, 3, 4], vec![2]),
            (vec![9], vec![3]),
        ];
        assert_eq!(asked.take(), expected);
    }

    #[test]
    fn displacements_are_those_of_the_entries_known_or_not() {
        let kept = KeptBlock::default();
        let count = RefCell::new(0);
        let entry = |row: usize, column: usize| (100 * row + column) as f64;
        let assemble = |rows: &[usize], columns: &[usize], _: &AssemblyOptions| {
            *count.borrow_mut() += 1;
            Ok(columns.iter().map(|&j| rows.iter().map(|&i| entry(i, j)).collect()).collect())
        };
        let forces = [Vector3::new(1.0, 0.0, 2.0), Vector3::new(0.0, 3.0, -1.0)];
        // New, known, known in another order, a row more, a row that another column knows.
        let asked = [(&[4, 1][..], [1, 4], 1), (&[1], [4, 1], 1), (&[4, 1], [4, 1], 1), (&[7, 1], [1, 4], 2)];
        let asked = asked.into_iter().chain([(&[4][..], [7, 1], 3), (&[7], [7, 1], 4)]);
        for (rows, columns, assembled) in asked {
            let moved = kept.displaced(rows, (&columns, &forces), &AssemblyOptions::default(), assemble);
            let of_row =
                |&row: &usize| columns.iter().zip(forces).map(|(&j, force)| entry(row, j) * force).sum();
            let expected: Vec<Vector3<f64>> = rows.iter().map(of_row).collect();
            assert_eq!(moved.expect("nothing is refused"), expected, "{rows:?} under {columns:?}");
            assert_eq!(*count.borrow(), assembled, "{rows:?} under {columns:?}");
        }
    }

    #[test]
    fn many_small_blocks_are_joined() {
        let kept = KeptBlock::default();
        let count = RefCell::new(0);
        let assemble = |rows: &[usize], columns: &[usize], _: &AssemblyOptions| {
            *count.borrow_mut() += 1;
            Ok(columns.iter().map(|&j| rows.iter().map(|&i| (i * j) as f64).collect()).collect())
        };
        let options = AssemblyOptions::default();
        let vertices: Vec<usize> = (1..20).collect();
        for vertex in &vertices {
            kept.entries(&[*vertex], &[*vertex], &options, assemble).expect("nothing is refused");
        }
        let all = kept.entries(&vertices, &vertices, &options, assemble).expect("nothing is refused");
        assert_eq!(*count.borrow(), 20);
        assert_eq!(all, Mat::from_fn(19, 19, |i, j| (vertices[i] * vertices[j]) as f64));
    }
}
