//! [`Obstacle`]: a shape at a rigid pose.

use std::sync::Arc;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

use crate::geometry::bounds::{Bounds, LARGEST_COORDINATE, is_within_range};
use crate::geometry::direction::unit;
use crate::geometry::rigid_motion::rigid_motion;
use crate::obstacle::error::ObstacleError;
use crate::obstacle::material::{Material, ProductResponse};
use crate::obstacle::mesh::{MeshObstacleOptions, MeshShape};
use crate::obstacle::nearest::Nearest;
use crate::obstacle::pose_matrix::PoseMatrix;
use crate::obstacle::primitive::Primitive;
use crate::response::error::ResponseError;
use crate::surface::checked::Surface;
use crate::surface::coarse::CoarsePlace;

/// The product: a closed mesh or a primitive, at a pose; rigid unless it has a material.
///
/// Clones and moved copies share the shape and the material, so they cost next to nothing.
#[derive(Debug, Clone)]
pub struct Obstacle {
    shape: Arc<Shape>,
    pose: Isometry3<f64>,
    material: Option<Arc<Material>>,
}

/// Vertices (m) and faces.
pub type Triangles = (Vec<Vector3<f64>>, Vec<[u32; 3]>);

/// Vertices (m) and faces, as they are stored.
#[cfg(feature = "python")]
type OwnTriangles<'a> = (&'a [Vector3<f64>], &'a [[u32; 3]]);

/// A shape in its own frame.
#[derive(Debug)]
pub(super) enum Shape {
    Mesh(Box<MeshShape>),
    Primitive(Primitive),
}

impl Obstacle {
    /// A closed mesh, in its own coordinates.
    ///
    /// It is checked as a skin is and must besides be closed, its components turned as their nesting asks (a
    /// cavity inward), and its faces must not cross. [`Obstacle::signed_distance`] needs all of that.
    ///
    /// * `vertices`: (n) points (m)
    /// * `faces`: (m) triangles, counter-clockwise seen from outside
    ///
    /// # Errors
    ///
    /// [`ObstacleError::Mesh`], [`ObstacleError::NotClosed`], [`ObstacleError::CrossingFaces`].
    pub fn mesh(
        vertices: Vec<Vector3<f64>>,
        faces: Vec<[u32; 3]>,
        options: &MeshObstacleOptions,
    ) -> Result<Obstacle, ObstacleError> {
        Ok(Obstacle::at_rest(Shape::Mesh(Box::new(MeshShape::new(vertices, faces, options)?))))
    }

    /// Everything behind a plane.
    ///
    /// * `point`: a point of the plane (m)
    /// * `normal`: its outward normal, of any length but 0
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NotFinite`] and [`ObstacleError::ZeroNormal`].
    pub fn half_space(point: Vector3<f64>, normal: Vector3<f64>) -> Result<Obstacle, ObstacleError> {
        check_finite("half-space", "the point", &point)?;
        check_finite("half-space", "the normal", &normal)?;
        let normal = unit(&normal).ok_or(ObstacleError::ZeroNormal)?;
        Ok(Obstacle::of_primitive(Primitive::HalfSpace { point, normal }))
    }

    /// A ball.
    ///
    /// * `center`: its center (m)
    /// * `radius`: > 0 (m)
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NotFinite`] and [`ObstacleError::NotPositive`].
    pub fn sphere(center: Vector3<f64>, radius: f64) -> Result<Obstacle, ObstacleError> {
        check_finite("sphere", "the center", &center)?;
        check_positive("sphere", "the radius", radius)?;
        Ok(Obstacle::of_primitive(Primitive::Sphere { center, radius }))
    }

    /// A box around the origin, its edges along the axes.
    ///
    /// * `half_extents`: half the edge lengths, > 0 (m)
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NotPositive`].
    pub fn cuboid(half_extents: Vector3<f64>) -> Result<Obstacle, ObstacleError> {
        for extent in half_extents.iter() {
            check_positive("box", "every half extent", *extent)?;
        }
        Ok(Obstacle::of_primitive(Primitive::Cuboid { half_extents }))
    }

    /// All points within `radius` of a segment.
    ///
    /// * `a`, `b`: the ends of the segment, not the same point (m)
    /// * `radius`: > 0 (m)
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NotFinite`], [`ObstacleError::NotPositive`] and [`ObstacleError::CoincidentEnds`].
    pub fn capsule(a: Vector3<f64>, b: Vector3<f64>, radius: f64) -> Result<Obstacle, ObstacleError> {
        check_finite("capsule", "end a", &a)?;
        check_finite("capsule", "end b", &b)?;
        check_positive("capsule", "the radius", radius)?;
        if (b - a).norm_squared() == 0.0 {
            return Err(ObstacleError::CoincidentEnds { end: a.into() });
        }
        Ok(Obstacle::of_primitive(Primitive::Capsule { a, b, radius }))
    }

    /// A cylinder with flat caps around the z axis, centered on the origin.
    ///
    /// * `half_height`: half its length along z, > 0 (m)
    /// * `radius`: > 0 (m)
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NotPositive`].
    pub fn cylinder(half_height: f64, radius: f64) -> Result<Obstacle, ObstacleError> {
        check_positive("cylinder", "the half height", half_height)?;
        check_positive("cylinder", "the radius", radius)?;
        Ok(Obstacle::of_primitive(Primitive::Cylinder { half_height, radius }))
    }

    fn at_rest(shape: Shape) -> Obstacle {
        Obstacle { shape: Arc::new(shape), pose: Isometry3::identity(), material: None }
    }

    /// A copy turned about the origin, then shifted: a point at `x` comes to `rotation x + translation`.
    ///
    /// * `rotation`: a proper rotation, orthonormal to 1e-9
    /// * `translation`: (m)
    ///
    /// # Errors
    ///
    /// [`ObstacleError::Motion`].
    pub fn moved(
        &self,
        rotation: &Matrix3<f64>,
        translation: &Vector3<f64>,
    ) -> Result<Obstacle, ObstacleError> {
        let motion = rigid_motion(rotation, translation)?;
        let mut pose = motion * self.pose;
        pose.rotation.renormalize();
        Ok(self.at(pose))
    }

    /// A copy shifted by `translation` (m).
    pub fn translated(&self, translation: &Vector3<f64>) -> Obstacle {
        let mut pose = self.pose;
        pose.translation.vector += translation;
        self.at(pose)
    }

    /// A copy that gives way under the contact's forces.
    ///
    /// At the contact's nodes `g = g0 + (R_H + R_P) f`, R_H the skin's response and R_P the product's, both along the
    /// obstacle's normals: the pressure is the same on both sides (Johnson 1985, §4.1).
    ///
    /// * `shear_modulus`: G (Pa), finite, > 0
    /// * `poisson_ratio`: ν, 0 ..= 0.5
    /// * `response`: how it answers a force
    ///
    /// # Errors
    /// [`ResponseError::Constant`] names the constant that is out of range; [`ResponseError::Product`] for a response that
    /// no product has; of a matrix also [`ResponseError::Nodes`],
    /// [`ResponseError::MatrixShape`] and [`ResponseError::MatrixEntry`].
    pub fn with_material(
        &self,
        shear_modulus: f64,
        poisson_ratio: f64,
        response: ProductResponse,
    ) -> Result<Obstacle, ResponseError> {
        let material = Material::new([shear_modulus, poisson_ratio], response, || self.surface())?;
        Ok(Obstacle { material: Some(Arc::new(material)), ..self.clone() })
    }

    /// What it is made of; `None` of a rigid one.
    pub fn material(&self) -> Option<&Material> {
        self.material.as_deref()
    }

    /// A copy turned about a point (m).
    pub(crate) fn turned(&self, rotation: &UnitQuaternion<f64>, center: &Vector3<f64>) -> Obstacle {
        let center = Translation3::from(*center);
        let mut pose = center * rotation * center.inverse() * self.pose;
        pose.rotation.renormalize();
        self.at(pose)
    }

    /// Where the obstacle's own frame stands in the world.
    pub fn pose(&self) -> &Isometry3<f64> {
        &self.pose
    }

    /// `"mesh"`, `"half_space"`, `"sphere"`, `"box"`, `"capsule"` or `"cylinder"`.
    pub fn kind(&self) -> &'static str {
        match &*self.shape {
            Shape::Mesh(_) => "mesh",
            Shape::Primitive(Primitive::HalfSpace { .. }) => "half_space",
            Shape::Primitive(Primitive::Sphere { .. }) => "sphere",
            Shape::Primitive(Primitive::Cuboid { .. }) => "box",
            Shape::Primitive(Primitive::Capsule { .. }) => "capsule",
            Shape::Primitive(Primitive::Cylinder { .. }) => "cylinder",
        }
    }

    /// Whether it is a half-space, in which no point between others is deeper than the deepest of these.
    pub(crate) fn is_half_space(&self) -> bool {
        matches!(&*self.shape, Shape::Primitive(Primitive::HalfSpace { .. }))
    }

    /// The box around the obstacle in the world; `None` for the half-space.
    pub fn bounding_box(&self) -> Option<Bounds> {
        let pose = self.pose_matrix();
        match &*self.shape {
            Shape::Mesh(mesh) => {
                let along = |axis: usize| pose.rotation.row(axis).transpose();
                let low = Vector3::from_fn(|axis, _| -mesh.farthest_along(&-along(axis)));
                let high = Vector3::from_fn(|axis, _| mesh.farthest_along(&along(axis)));
                Some(Bounds { low, high }.translated(&pose.translation))
            }
            Shape::Primitive(primitive) => {
                Some(primitive.bounding_box(&pose.rotation)?.translated(&pose.translation))
            }
        }
    }

    /// Vertices in the world (m) and faces of a mesh; `None` for a primitive.
    pub fn triangles(&self) -> Option<Triangles> {
        let (mesh, pose) = (self.as_mesh()?, self.pose_matrix());
        Some((mesh.vertices().iter().map(|v| pose.to_world(v)).collect(), mesh.faces().to_vec()))
    }

    /// A mesh in the world with its areas and normals; `None` for a primitive.
    pub(crate) fn surface(&self) -> Option<Surface> {
        let (vertices, faces) = self.triangles()?;
        let mask = vec![true; vertices.len()];
        Some(Surface::from_sound_mesh(vertices, faces, mask))
    }

    /// The triangle of a mesh closest to a point (m), and where on it; `None` for a primitive.
    pub(crate) fn closest_triangle(&self, point: &Vector3<f64>) -> Option<CoarsePlace> {
        self.as_mesh().map(|mesh| mesh.closest_triangle(&self.pose_matrix().to_local(point)))
    }

    /// Vertices (m) and faces of a mesh in its own frame.
    #[cfg(feature = "python")]
    pub(crate) fn own_triangles(&self) -> Option<OwnTriangles<'_>> {
        self.as_mesh().map(|mesh| (mesh.vertices(), mesh.faces()))
    }

    /// The primitive in its own frame.
    #[cfg(feature = "python")]
    pub(crate) fn primitive(&self) -> Option<&Primitive> {
        match &*self.shape {
            Shape::Mesh(_) => None,
            Shape::Primitive(primitive) => Some(primitive),
        }
    }

    /// A primitive that was checked before, in its own frame.
    pub(crate) fn of_primitive(primitive: Primitive) -> Obstacle {
        Obstacle::at_rest(Shape::Primitive(primitive))
    }

    /// The same shape at another pose.
    pub(crate) fn at(&self, pose: Isometry3<f64>) -> Obstacle {
        Obstacle { pose, ..self.clone() }
    }

    pub(super) fn shape(&self) -> &Shape {
        &self.shape
    }

    pub(super) fn as_mesh(&self) -> Option<&MeshShape> {
        match &*self.shape {
            Shape::Mesh(mesh) => Some(mesh),
            Shape::Primitive(_) => None,
        }
    }

    pub(super) fn pose_matrix(&self) -> PoseMatrix {
        PoseMatrix::of(&self.pose)
    }
}

impl Shape {
    /// Nearest point of the surface, in its frame; `None` if it is surely farther than `reach` (m).
    pub fn nearest(&self, p: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        match self {
            Shape::Mesh(mesh) => mesh.nearest(p, reach),
            Shape::Primitive(primitive) => Some(primitive.nearest(p)),
        }
    }
}

fn check_finite(kind: &'static str, what: &'static str, value: &Vector3<f64>) -> Result<(), ObstacleError> {
    if is_within_range(value) {
        return Ok(());
    }
    Err(ObstacleError::NotFinite { kind, what, value: (*value).into() })
}

fn check_positive(kind: &'static str, what: &'static str, value: f64) -> Result<(), ObstacleError> {
    if value > 0.0 && value <= LARGEST_COORDINATE {
        return Ok(());
    }
    Err(ObstacleError::NotPositive { kind, what, value })
}
