//! NumPy arrays, numbers and names in.

use faer::MatRef;
use nalgebra::{Isometry3, Matrix3, Matrix4, Vector3};
use numpy::{
    PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyReadonlyArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyFloat, PyType};

use crate::geometry::rigid_motion;

/// A check of the facade by its name.
fn check<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("quasirigid._check")?.getattr(name)
}

/// What the facade's `as_array` makes of a value, which says why it is no array.
fn as_array<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    check(value.py(), "as_array")?.call1((name, value))
}

/// `numpy.require(array, dtype)`, in C order and aligned.
fn in_order<'py>(array: &Bound<'py, PyAny>, dtype: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
    array.py().import("numpy")?.call_method1("require", (array, dtype, ["C", "A", "E"]))
}

/// An entry as it was given, also where 64 bits do not hold it.
fn entry<'py>(value: &Bound<'py, PyAny>, name: &str, place: usize) -> PyResult<Bound<'py, PyAny>> {
    as_array(value, name)?.call_method1("item", (place,))
}

pub(super) fn shape_message(name: &str, expected: &str, shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    // As Python writes tuples.
    let end = if sides.len() == 1 { "," } else { "" };
    format!("`{name}` has shape ({}{end}), expected {expected}", sides.join(", "))
}

fn shape_error(name: &str, expected: &str, shape: &[usize]) -> PyErr {
    PyValueError::new_err(shape_message(name, expected, shape))
}

fn float_array<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let array = as_array(value, name)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"fiu".contains(&kind) {
        return Err(PyTypeError::new_err(format!(
            "`{name}` has dtype {}, expected real numbers",
            array.getattr("dtype")?
        )));
    }
    Ok(in_order(&array, Some("float64"))?.cast_into::<PyArrayDyn<f64>>()?.readonly())
}

/// The value of a name; the exception that `refuse` makes lists the names.
pub(super) fn named<T: Copy>(
    option: &str,
    name: &str,
    all: &[(T, &str)],
    refuse: fn(String) -> PyErr,
) -> PyResult<T> {
    all.iter().find(|(_, known)| *known == name).map(|(value, _)| *value).ok_or_else(|| {
        let known: Vec<String> = all.iter().map(|(_, known)| format!("{known:?}")).collect();
        refuse(format!("{option} is {name:?}, expected one of {}", known.join(", ")))
    })
}

/// (n, 3) points or vectors.
pub(super) fn vectors(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Vector3<f64>>> {
    let array = float_array(value, name)?;
    match array.shape() {
        [_, 3] => Ok(array.as_slice()?.chunks_exact(3).map(Vector3::from_column_slice).collect()),
        shape => Err(shape_error(name, "(n, 3)", shape)),
    }
}

/// Vertices and faces of a mesh object, read by the facade's `mesh_arrays`.
pub(super) fn mesh_arrays<'py>(
    mesh: &Bound<'py, PyAny>,
    unit: &str,
    refusal: Bound<'py, PyType>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let keywords = [("unit", unit.into_pyobject(mesh.py())?.into_any()), ("refusal", refusal.into_any())];
    let read = mesh.py().import("quasirigid.io.mesh")?.getattr("mesh_arrays")?;
    read.call((mesh,), Some(&keywords.into_py_dict(mesh.py())?))?.extract()
}

/// A number; of what is no float the facade's `as_float` says whether it is one.
pub(super) fn number(value: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    match value.cast_exact::<PyFloat>() {
        Ok(number) => Ok(number.value()),
        Err(_) => check(value.py(), "as_float")?.call1((name, value))?.extract(),
    }
}

/// An integer >= 0; the facade's `as_integer` says what is wrong with what is none, out of range as a `refusal`.
pub(super) fn integer(value: &Bound<'_, PyAny>, name: &str, refusal: Bound<'_, PyType>) -> PyResult<usize> {
    check(value.py(), "as_integer")?.call1((name, value, refusal))?.extract()
}

/// A boolean; the facade's `as_boolean` refuses what is none.
pub(super) fn boolean(value: &Bound<'_, PyAny>, name: &str) -> PyResult<bool> {
    check(value.py(), "as_boolean")?.call1((name, value))?.extract()
}

/// (3,) vector.
pub(super) fn vector(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vector3<f64>> {
    let array = float_array(value, name)?;
    match array.shape() {
        [3] => Ok(Vector3::from_column_slice(array.as_slice()?)),
        shape => Err(shape_error(name, "(3,)", shape)),
    }
}

/// (3, 3) matrix.
pub(super) fn matrix3(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Matrix3<f64>> {
    let array = float_array(value, name)?;
    match array.shape() {
        [3, 3] => Ok(Matrix3::from_row_slice(array.as_slice()?)),
        shape => Err(shape_error(name, "(3, 3)", shape)),
    }
}

/// Rotation and translation of `moved`: either, both, or a (4, 4) matrix in the place of the first.
pub(super) fn rotation_and_translation(
    rotation: Option<&Bound<'_, PyAny>>,
    translation: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Matrix3<f64>, Vector3<f64>)> {
    let shift = translation.map(|translation| vector(translation, "translation")).transpose()?;
    let Some(rotation) = rotation else {
        return Ok((Matrix3::identity(), shift.unwrap_or_default()));
    };
    let expected = "(3, 3), or (4, 4) with the translation; a translation alone is `translation=`";
    match (motion(rotation, "rotation", expected)?, shift) {
        ((_, Some(_)), Some(_)) => Err(PyTypeError::new_err(
            "`rotation` has shape (4, 4) and holds a translation: leave out `translation`",
        )),
        ((turn, held), shift) => Ok((turn, held.or(shift).unwrap_or_default())),
    }
}

/// Rotation of a (3, 3) matrix, and the translation too of a (4, 4) one.
pub(super) fn motion(
    value: &Bound<'_, PyAny>,
    name: &str,
    expected: &str,
) -> PyResult<(Matrix3<f64>, Option<Vector3<f64>>)> {
    let array = float_array(value, name)?;
    let numbers = array.as_slice()?;
    match array.shape() {
        [3, 3] => Ok((Matrix3::from_row_slice(numbers), None)),
        [4, 4] if numbers[12..] != [0.0, 0.0, 0.0, 1.0] => Err(PyValueError::new_err(format!(
            "`{name}` is a (4, 4) matrix with last row {:?}, expected [0, 0, 0, 1]: rotation and translation in its \
             columns",
            &numbers[12..]
        ))),
        [4, 4] => {
            let row = |row: usize| &numbers[4 * row..4 * row + 4];
            let turn = Matrix3::from_fn(|i, j| row(i)[j]);
            Ok((turn, Some(Vector3::from_fn(|i, _| row(i)[3]))))
        }
        shape => Err(shape_error(name, expected, shape)),
    }
}

/// (n,) numbers.
pub(super) fn scalars(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    // What needs no conversion need not ask NumPy for one.
    let value = as_array(value, name)?;
    if let Ok(array) = value.cast::<PyArray1<f64>>()
        && let Ok(numbers) = array.readonly().as_slice()
    {
        return Ok(numbers.to_vec());
    }
    let array = float_array(&value, name)?;
    match array.shape() {
        [_] => Ok(array.as_slice()?.to_vec()),
        shape => Err(shape_error(name, "(n,)", shape)),
    }
}

/// (n, k) numbers row by row, and k.
pub(super) fn number_rows(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<f64>, usize)> {
    let array = float_array(value, name)?;
    match array.shape() {
        [_, per_row] => Ok((array.as_slice()?.to_vec(), *per_row)),
        shape => Err(shape_error(name, "(n, k)", shape)),
    }
}

/// (n, k) indices row by row, and k; a negative one is none that exists.
pub(super) fn index_rows(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<usize>, usize)> {
    let array = integer_array(value, name)?;
    match array.shape() {
        [_, per_row] => {
            let index = |&index: &i64| usize::try_from(index).unwrap_or(usize::MAX);
            Ok((array.as_slice()?.iter().map(index).collect(), *per_row))
        }
        shape => Err(shape_error(name, "(n, k)", shape)),
    }
}

/// (k, 4, 4) rigid motions.
pub(super) fn motions(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Isometry3<f64>>> {
    let array = float_array(value, name)?;
    let [_, 4, 4] = array.shape() else {
        return Err(shape_error(name, "(k, 4, 4)", array.shape()));
    };
    let motion = |(row, entries): (usize, &[f64])| {
        let matrix = Matrix4::from_row_slice(entries);
        let (rotation, translation) =
            (matrix.fixed_view::<3, 3>(0, 0).into_owned(), matrix.fixed_view::<3, 1>(0, 3).into_owned());
        rigid_motion(&rotation, &translation)
            .map_err(|error| PyValueError::new_err(format!("`{name}[{row}]`: {error}")))
    };
    array.as_slice()?.chunks_exact(16).enumerate().map(motion).collect()
}

/// (n,) booleans.
pub(super) fn mask(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<bool>> {
    let array = in_order(&as_array(value, name)?, None)?;
    let Ok(flags) = array.cast::<PyArrayDyn<bool>>() else {
        let dtype = array.getattr("dtype")?;
        return Err(PyTypeError::new_err(format!(
            "`{name}` has dtype {dtype}, expected booleans; from vertices take np.isin(np.arange(n), vertices)"
        )));
    };
    match flags.shape() {
        [_] => Ok(flags.readonly().as_slice()?.to_vec()),
        shape => Err(shape_error(name, "(n,) booleans", shape)),
    }
}

fn integer_array<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let array = as_array(value, name)?;
    let dtype = array.getattr("dtype")?;
    let kind: String = dtype.getattr("kind")?.extract()?;
    let empty = array.getattr("size")?.extract::<usize>()? == 0;
    if !"iu".contains(&kind) && !empty {
        let hint = if kind == "b" { ": of a mask take np.flatnonzero(mask)" } else { "" };
        return Err(PyTypeError::new_err(format!("`{name}` has dtype {dtype}, expected integers{hint}")));
    }
    Ok(in_order(&array, Some("int64"))?.cast_into::<PyArrayDyn<i64>>()?.readonly())
}

/// (m, 3) vertex indices; a negative one names no vertex, and is refused here with the face that has it, by the
/// exception that `refuse` makes.
pub(super) fn faces(
    value: &Bound<'_, PyAny>,
    name: &str,
    refuse: fn(String) -> PyErr,
) -> PyResult<Vec<[u32; 3]>> {
    let array = integer_array(value, name)?;
    let [_, 3] = array.shape() else {
        return Err(shape_error(name, "(m, 3)", array.shape()));
    };
    let flat = array.as_slice()?;
    let unusable = |index: &&i64| u32::try_from(**index).is_err();
    if let Some(first) = flat.iter().position(|index| unusable(&index)) {
        let count = flat.iter().filter(unusable).count();
        return Err(refuse(format!(
            "face {} refers to vertex {}, which cannot exist ({count} such references): indices count from 0",
            first / 3,
            entry(value, name, first)?
        )));
    }
    Ok(flat
        .chunks_exact(3)
        .map(|corners| [corners[0] as u32, corners[1] as u32, corners[2] as u32])
        .collect())
}

/// (k,) node numbers below `count`; others are refused by the exception that `refuse` makes.
pub(super) fn nodes(
    value: &Bound<'_, PyAny>,
    name: &str,
    count: usize,
    refuse: fn(String) -> PyErr,
) -> PyResult<Vec<usize>> {
    let array = integer_array(value, name)?;
    let [_] = array.shape() else {
        return Err(refuse(shape_message(name, "(k,)", array.shape())));
    };
    array
        .as_slice()?
        .iter()
        .enumerate()
        .map(|(row, &index)| match usize::try_from(index) {
            Ok(index) if index < count => Ok(index),
            _ => {
                let given = entry(value, name, row)?;
                Err(refuse(format!("`{name}[{row}]` is {given}, but there are {count} vertices")))
            }
        })
        .collect()
}

/// A matrix of float64 in C or Fortran order, aligned; anything else is copied to C order first. What has not two
/// dimensions is refused by the exception that `refuse` makes.
pub(super) struct MatrixArgument<'py>(PyReadonlyArray2<'py, f64>);

impl<'py> MatrixArgument<'py> {
    pub fn new(value: &Bound<'py, PyAny>, name: &str, refuse: fn(String) -> PyErr) -> PyResult<Self> {
        let value = as_array(value, name)?;
        let fits = value.cast::<PyArray2<f64>>().is_ok_and(|array| array.readonly().as_slice().is_ok());
        let array = if fits { value } else { float_array(&value, name)?.as_any().clone() };
        let shape = array.cast::<PyArrayDyn<f64>>()?.shape().to_vec();
        match array.cast_into::<PyArray2<f64>>() {
            Ok(array) => Ok(Self(array.readonly())),
            Err(_) => Err(refuse(shape_message(name, "(n, n)", &shape))),
        }
    }

    /// As faer sees it, without a copy.
    pub fn view(&self) -> MatRef<'_, f64> {
        let (rows, columns) = (self.0.shape()[0], self.0.shape()[1]);
        let numbers = self.0.as_slice().expect("aligned, and contiguous in one of the two orders");
        if self.0.is_c_contiguous() {
            MatRef::from_row_major_slice(numbers, rows, columns)
        } else {
            MatRef::from_column_major_slice(numbers, rows, columns)
        }
    }
}
