//! An obstacle laid into a frame, such as that of a palm, by what it weighs where.

use nalgebra::{Isometry3, Matrix3, Rotation3, SymmetricEigen, Translation3, UnitQuaternion, Vector3};

use crate::geometry::bounds::Bounds;
use crate::geometry::rigid_motion::rigid_motion;
use crate::obstacle::error::ObstacleError;
use crate::obstacle::posed::{Obstacle, Shape};
use crate::obstacle::primitive::Primitive;

/// A shape filled evenly.
struct Mass {
    /// Center of mass (m).
    center: Vector3<f64>,
    /// Second moment about it, up to a factor.
    spread: Matrix3<f64>,
}

impl Obstacle {
    /// The center of mass of the obstacle filled evenly, in the world (m); `None` for the half-space.
    pub fn center_of_mass(&self) -> Option<Vector3<f64>> {
        Some(self.pose_matrix().to_world(&self.mass()?.center))
    }

    /// A copy in a frame: its longest principal axis along x, the shortest along z, its center of mass over the
    /// origin, and its lowest point at z = 0.
    ///
    /// Of the four turns that lay the axes so, the one that turns it least.
    ///
    /// * `rotation`, `translation`: from the frame to the world (m)
    /// * `turn`: of the obstacle as it lies, in the frame, about its center of mass
    ///
    /// # Errors
    ///
    /// [`ObstacleError::Motion`], [`ObstacleError::Endless`] for the half-space.
    pub fn placed(
        &self,
        rotation: &Matrix3<f64>,
        translation: &Vector3<f64>,
        turn: &Matrix3<f64>,
    ) -> Result<Obstacle, ObstacleError> {
        let frame = rigid_motion(rotation, translation)?;
        let mass = self.mass().ok_or(ObstacleError::Endless)?;
        let laid = rigid_motion(turn, &Vector3::zeros())?
            * self.turn_into(&frame, &mass.spread)
            * Translation3::from(-mass.center);
        let lowest = self.at(laid).bounding_box().map_or(0.0, |bounds| bounds.low.z);
        Ok(self.at(frame * Translation3::new(0.0, 0.0, -lowest) * laid))
    }

    /// The rotation that lays the principal axes along those of a frame, from the obstacle's own frame into it.
    fn turn_into(&self, frame: &Isometry3<f64>, spread: &Matrix3<f64>) -> UnitQuaternion<f64> {
        let axes = principal_axes(spread).transpose();
        let standing = frame.rotation.inverse() * self.pose().rotation;
        let turns = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| {
            let signs = Matrix3::from_diagonal(&Vector3::new(x, y, x * y));
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(signs * axes))
        });
        turns[1..].iter().fold(turns[0], |least, turn| {
            if turn.angle_to(&standing) < least.angle_to(&standing) { *turn } else { least }
        })
    }

    fn mass(&self) -> Option<Mass> {
        match self.shape() {
            Shape::Mesh(mesh) => Some(mass_of_mesh(mesh.vertices(), mesh.faces())),
            Shape::Primitive(primitive) => mass_of_primitive(primitive),
        }
    }
}

/// From the tetrahedra between the faces and the middle of the box around them.
fn mass_of_mesh(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Mass {
    let origin = Bounds::around(vertices).center();
    let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for face in faces {
        let [a, b, c] = face.map(|at| vertices[at as usize] - origin);
        let share = a.dot(&b.cross(&c));
        let sum = a + b + c;
        volume += share;
        first += share * sum;
        let squares = [a, b, c, sum].iter().map(|p| p * p.transpose()).sum::<Matrix3<f64>>();
        second += share * squares;
    }
    // The fourth corner is the origin: means over a tetrahedron.
    let middle = first / (4.0 * volume);
    Mass { center: origin + middle, spread: second / (20.0 * volume) - middle * middle.transpose() }
}

fn mass_of_primitive(primitive: &Primitive) -> Option<Mass> {
    let along_axes = |squares: Vector3<f64>| Matrix3::from_diagonal(&squares);
    let (center, spread) = match primitive {
        Primitive::HalfSpace { .. } => return None,
        Primitive::Sphere { center, .. } => (*center, Matrix3::identity()),
        Primitive::Cuboid { half_extents } => {
            (Vector3::zeros(), along_axes(half_extents.component_mul(half_extents)))
        }
        Primitive::Capsule { a, b, .. } => (0.5 * (a + b), (b - a) * (b - a).transpose()),
        Primitive::Cylinder { half_height, radius } => {
            let across = 0.25 * radius * radius;
            (Vector3::zeros(), along_axes(Vector3::new(across, across, half_height * half_height / 3.0)))
        }
    };
    Some(Mass { center, spread })
}

/// The axes in columns, the longest first, right-handed.
fn principal_axes(spread: &Matrix3<f64>) -> Matrix3<f64> {
    let found = SymmetricEigen::new(*spread);
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| found.eigenvalues[*b].total_cmp(&found.eigenvalues[*a]));
    let [first, second] = [0, 1].map(|at| found.eigenvectors.column(order[at]).into_owned());
    Matrix3::from_columns(&[first, second, first.cross(&second)])
}
