//! NumPy arrays out.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use numpy::ndarray::Dimension;
use numpy::{Element, PyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::python::forked::released;

/// Rows handled together where a matrix is turned from columns to rows, so that what is written stays in cache.
const ROWS_PER_TASK: usize = 32;

/// (n, 3) array of vectors.
pub(super) fn vectors_out<'py>(py: Python<'py>, vectors: &[Vector3<f64>]) -> Bound<'py, PyArray2<f64>> {
    let rows: Vec<[f64; 3]> = vectors.iter().map(|&vector| vector.into()).collect();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([vectors.len(), 3]).expect("three numbers a vector")
}

/// The array for all to share: nobody may write to it.
pub(super) fn read_only<T: Element, D: Dimension>(array: Bound<'_, PyArray<T, D>>) -> Py<PyArray<T, D>> {
    array.readwrite().make_nonwriteable();
    array.unbind()
}

/// (3,) array.
pub(super) fn vector_out<'py>(py: Python<'py>, vector: &Vector3<f64>) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, vector.as_slice())
}

/// (3, 3) array of a rotation matrix.
pub(super) fn rotation_out<'py>(py: Python<'py>, rotation: &Matrix3<f64>) -> Bound<'py, PyArray2<f64>> {
    let rows: Vec<_> = (0..3).map(|row| rotation.row(row).transpose()).collect();
    vectors_out(py, &rows)
}

/// (m, 3) int64 array of faces.
pub(super) fn faces_out<'py>(py: Python<'py>, faces: &[[u32; 3]]) -> Bound<'py, PyArray2<i64>> {
    let flat: Vec<i64> = faces.iter().flatten().map(|&index| i64::from(index)).collect();
    PyArray1::from_vec(py, flat).reshape([faces.len(), 3]).expect("three corners a face")
}

/// (k, 2) int64 array of vertex numbers.
pub(super) fn pairs_out<'py>(py: Python<'py>, pairs: &[[usize; 2]]) -> Bound<'py, PyArray2<i64>> {
    let flat: Vec<i64> = pairs.iter().flatten().map(|&vertex| vertex as i64).collect();
    PyArray1::from_vec(py, flat).reshape([pairs.len(), 2]).expect("two vertices each")
}

/// (k,) int64 array of vertex numbers.
pub(super) fn nodes_out<'py>(py: Python<'py>, nodes: &[usize]) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_vec(py, nodes.iter().map(|&node| node as i64).collect())
}

/// (n,) int64 array of vertex numbers, -1 for none.
pub(super) fn numbers_out<'py>(py: Python<'py>, numbers: &[Option<usize>]) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_iter(py, numbers.iter().map(|number| number.map_or(-1, |n| n as i64)))
}

/// (n, m) array, C order.
pub(super) fn matrix_out<'py>(py: Python<'py>, matrix: &Mat<f64>) -> Bound<'py, PyArray2<f64>> {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    let mut flat = vec![0.0; rows * columns];
    let fill = |(block, out): (usize, &mut [f64])| {
        let first = block * ROWS_PER_TASK;
        for j in 0..columns {
            let column = &matrix.col_as_slice(j)[first..];
            out.chunks_exact_mut(columns).zip(column).for_each(|(row, entry)| row[j] = *entry);
        }
    };
    if columns > 0 {
        released(py, || flat.par_chunks_mut(columns * ROWS_PER_TASK).enumerate().for_each(fill));
    }
    PyArray1::from_vec(py, flat).reshape([rows, columns]).expect("as many numbers as entries")
}
