//! Checks of the stored parts of a body, so that damage is named where they are read.

use faer::Mat;

use crate::response::body::error::BodyError;

/// Rounding of weights that add up to 1.
const SUM_ERROR: f64 = 1e-9;

/// Where the numbers of a part lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Range {
    Finite,
    NotNegative,
    Positive,
    One,
}

impl Range {
    fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::NotNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::One => (value - 1.0).abs() < SUM_ERROR,
            }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Finite => "finite numbers",
            Self::NotNegative => "finite numbers from 0 on",
            Self::Positive => "finite numbers above 0",
            Self::One => "1",
        }
    }
}

/// Checks that parts belong together.
///
/// * `counts`: what is counted, how many were found, and how many are expected
///
/// # Errors
/// [`BodyError::Parts`].
pub(crate) fn check_counts(counts: &[(&'static str, usize, usize)]) -> Result<(), BodyError> {
    match counts.iter().find(|(_, found, expected)| found != expected) {
        Some(&(what, found, expected)) => Err(BodyError::Parts { what, found, expected }),
        None => Ok(()),
    }
}

/// Checks the numbers of a part, each with its row.
///
/// # Errors
/// [`BodyError::PartNumber`].
pub(crate) fn check_numbers(
    what: &'static str,
    range: Range,
    numbers: impl IntoIterator<Item = (usize, f64)>,
) -> Result<(), BodyError> {
    match numbers.into_iter().find(|&(_, value)| !range.holds(value)) {
        Some((row, value)) => Err(BodyError::PartNumber { what, row, value, expected: range.words() }),
        None => Ok(()),
    }
}

/// Checks that nodes stand where they are expected.
///
/// # Errors
/// [`BodyError::Parts`], [`BodyError::NodeMisplaced`].
pub(crate) fn check_order(nodes: &[usize], expected: &[usize]) -> Result<(), BodyError> {
    check_counts(&[("nodes", nodes.len(), expected.len())])?;
    match nodes.iter().zip(expected).enumerate().find(|(_, (vertex, expected))| vertex != expected) {
        Some((position, (&vertex, &expected))) => {
            Err(BodyError::NodeMisplaced { position, vertex, expected })
        }
        None => Ok(()),
    }
}

/// Entries of a matrix with their rows, column by column.
pub(crate) fn entries(matrix: &Mat<f64>) -> impl Iterator<Item = (usize, f64)> + '_ {
    (0..matrix.ncols()).flat_map(|column| matrix.col_as_slice(column).iter().copied().enumerate())
}

/// Components of vectors with the row of each vector.
pub(crate) fn components<'a, V>(vectors: &'a [V]) -> impl Iterator<Item = (usize, f64)> + 'a
where
    &'a V: IntoIterator<Item = &'a f64>,
{
    vectors.iter().enumerate().flat_map(|(row, vector)| vector.into_iter().map(move |&value| (row, value)))
}
