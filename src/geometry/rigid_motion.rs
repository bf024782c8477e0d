//! Rigid motions from a matrix and a vector, checked.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::geometry::bounds::is_within_range;

/// Largest entry of `|RᵀR − I|` of a matrix that is taken for a rotation.
const ROTATION_TOLERANCE: f64 = 1e-9;
/// That of a rotation in single precision.
const SINGLE_PRECISION: f64 = 1e-5;

/// Why a matrix and a vector are no rigid motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigidMotionError {
    /// An entry of the matrix is no finite number.
    #[error("the rotation must be finite, but entry ({row}, {column}) is {value}")]
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// Its value.
        value: f64,
    },
    /// The matrix is no rotation.
    #[error(
        "the rotation must be orthonormal to {tolerance:e}, but |RᵀR - I| reaches {deviation:e}; \
         {}",
        if *deviation < SINGLE_PRECISION {
            "make it orthonormal in double precision"
        } else {
            "scale or shear the mesh itself instead"
        }
    )]
    NotOrthonormal {
        /// Largest entry of `|RᵀR - I|`.
        deviation: f64,
        /// The largest that is accepted.
        tolerance: f64,
    },
    /// The matrix mirrors.
    #[error(
        "the rotation is a reflection (determinant {determinant}); mirror the mesh and turn its faces instead"
    )]
    Reflection {
        /// Determinant, near -1.
        determinant: f64,
    },
    /// The translation is not finite or too large.
    #[error("the translation must be finite and at most 1e60, found {translation:?} (m)")]
    Translation {
        /// Its value (m).
        translation: [f64; 3],
    },
}

/// The motion `x ↦ rotation x + translation`.
///
/// * `rotation`: a proper rotation, orthonormal to 1e-9
/// * `translation`: (m), finite
///
/// # Errors
/// [`RigidMotionError`] by variant.
pub fn rigid_motion(
    rotation: &Matrix3<f64>,
    translation: &Vector3<f64>,
) -> Result<Isometry3<f64>, RigidMotionError> {
    check_rotation(rotation)?;
    if !is_within_range(translation) {
        return Err(RigidMotionError::Translation { translation: (*translation).into() });
    }
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation));
    Ok(Isometry3::from_parts(Translation3::from(*translation), turn))
}

/// Checks that a matrix is a proper rotation, orthonormal to 1e-9.
pub(crate) fn check_rotation(rotation: &Matrix3<f64>) -> Result<(), RigidMotionError> {
    if let Some(at) = rotation.iter().position(|x| !x.is_finite()) {
        let (row, column) = (at % 3, at / 3);
        return Err(RigidMotionError::NotFinite { row, column, value: rotation[at] });
    }
    let excess = rotation.transpose() * rotation - Matrix3::identity();
    let is_finite = excess.iter().all(|x| x.is_finite());
    let deviation = if is_finite { excess.amax() } else { f64::INFINITY };
    if deviation > ROTATION_TOLERANCE {
        return Err(RigidMotionError::NotOrthonormal { deviation, tolerance: ROTATION_TOLERANCE });
    }
    let determinant = rotation.determinant();
    if determinant < 0.0 { Err(RigidMotionError::Reflection { determinant }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_and_a_translation_move_a_point() {
        let quarter = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let motion = rigid_motion(&quarter, &Vector3::new(0.0, 0.0, 5.0)).unwrap();
        let moved = motion.rotation * Vector3::x() + motion.translation.vector;
        assert!((moved - Vector3::new(0.0, 1.0, 5.0)).norm() < 1e-15);
    }

    #[test]
    fn whatever_is_no_rigid_motion_is_refused_with_its_numbers() {
        let none = Vector3::zeros();
        let scaled = rigid_motion(&(2.0 * Matrix3::identity()), &none);
        assert!(
            matches!(scaled, Err(RigidMotionError::NotOrthonormal { deviation, .. }) if deviation == 3.0)
        );
        let mut unknown = Matrix3::identity();
        unknown[(0, 1)] = f64::NAN;
        assert!(matches!(
            rigid_motion(&unknown, &none),
            Err(RigidMotionError::NotFinite { row: 0, column: 1, value }) if value.is_nan()
        ));
        let vast = rigid_motion(&(f64::MAX * Matrix3::identity()), &none);
        assert!(
            matches!(vast, Err(RigidMotionError::NotOrthonormal { deviation, .. }) if deviation == f64::INFINITY)
        );
        let mirrored = rigid_motion(&-Matrix3::identity(), &none);
        assert!(matches!(mirrored, Err(RigidMotionError::Reflection { determinant }) if determinant == -1.0));
        let nowhere = rigid_motion(&Matrix3::identity(), &Vector3::new(0.0, f64::INFINITY, 0.0));
        assert!(matches!(nowhere, Err(RigidMotionError::Translation { .. })));
    }
}
