//! `quasirigid.Obstacle`.

use nalgebra::Matrix3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::contact::touching;
use crate::obstacle::{MeshObstacleOptions, Obstacle};
use crate::python::arrays_out::{faces_out, rotation_out, vector_out, vectors_out};
use crate::python::convert::{
    boolean, faces, matrix3, mesh_arrays, motion, number, rotation_and_translation, vector, vectors,
};
use crate::python::described::described;
use crate::python::errors::{IntoPyErr, ObstacleError};
use crate::python::forked::released;
use crate::python::interrupt::detached_with;
use crate::python::material::{made_of, material_out};
use crate::python::pickle::{Pose, Reduced, reduced, restored};
use crate::python::surface::PySurface;

/// The product: a closed mesh or a primitive at a pose, rigid unless it has a material.
///
/// Make one by `mesh`, `half_space`, `sphere`, `box`, `capsule` or `cylinder`, place it by `moved`, and say what it is made
/// of by `with_material`.
///
/// Examples
/// --------
/// >>> import quasirigid as qr
/// >>> ball = qr.Obstacle.sphere([0, 0, 0], 0.02)
/// >>> distance, closest, normal = ball.signed_distance([[0.03, 0, 0]])
/// >>> round(float(distance[0]), 6), normal[0].tolist()
/// (0.01, [1.0, 0.0, 0.0])
#[pyclass(name = "Obstacle", module = "quasirigid", frozen, weakref)]
pub(super) struct PyObstacle {
    pub inner: Obstacle,
}

fn made(obstacle: Result<Obstacle, crate::obstacle::ObstacleError>) -> PyResult<PyObstacle> {
    obstacle.map(PyObstacle::from).map_err(IntoPyErr::into_py_err)
}

fn check_crossings(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    boolean(value, "check_crossings")
}

impl From<Obstacle> for PyObstacle {
    fn from(inner: Obstacle) -> Self {
        Self { inner }
    }
}

type TriangleArrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>);
type Distances<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl PyObstacle {
    /// Return a closed triangle mesh as obstacle.
    ///
    /// Parameters
    /// ----------
    /// vertices : (n, 3) array_like
    ///     Positions (m).
    /// faces : (m, 3) array_like of int
    ///     Corners of each triangle, counter-clockwise seen from outside.
    /// check_crossings : bool
    ///     Look for faces that cross, where inside and outside are not defined.
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     As `Surface`, and for a mesh that is open, nested or crosses itself.
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, *, check_crossings=true), text_signature = "(vertices, faces, *, check_crossings=True)")]
    fn mesh(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = check_crossings)] check_crossings: bool,
    ) -> PyResult<Self> {
        let vertices = vectors(vertices, "vertices")?;
        let faces = self::faces(faces, "faces", ObstacleError::new_err)?;
        made(released(py, || Obstacle::mesh(vertices, faces, &MeshObstacleOptions { check_crossings })))
    }

    /// Return a closed mesh object of another library as obstacle.
    ///
    /// Parameters
    /// ----------
    /// mesh : object
    ///     Of trimesh, open3d, meshio or pyvista, as for `Surface.from_mesh`.
    /// unit : {"m", "cm", "mm", "inch"}
    ///     Unit of its coordinates.
    /// check_crossings : bool
    ///     As for `mesh`.
    ///
    /// Returns
    /// -------
    /// Obstacle
    ///     The product, checked.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If it is no such object.
    /// ObstacleError
    ///     As `mesh`, and for faces that are no triangles.
    #[staticmethod]
    #[pyo3(signature = (mesh, *, unit="m", check_crossings=true), text_signature = "(mesh, *, unit='m', check_crossings=True)")]
    fn from_mesh(
        py: Python<'_>,
        mesh: &Bound<'_, PyAny>,
        unit: &str,
        #[pyo3(from_py_with = check_crossings)] check_crossings: bool,
    ) -> PyResult<Self> {
        let (vertices, faces) = mesh_arrays(mesh, unit, py.get_type::<ObstacleError>())?;
        Self::mesh(py, &vertices, &faces, check_crossings)
    }

    /// Return the half-space behind a plane, against its normal.
    ///
    /// Parameters
    /// ----------
    /// point : (3,) array_like
    ///     A point of the plane (m).
    /// normal : (3,) array_like
    ///     Its outward normal; normalised here.
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     If a number is not finite, or the normal is 0.
    #[staticmethod]
    #[pyo3(text_signature = "(point, normal)")]
    fn half_space(point: &Bound<'_, PyAny>, normal: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Obstacle::half_space(vector(point, "point")?, vector(normal, "normal")?))
    }

    /// Return a sphere.
    ///
    /// Parameters
    /// ----------
    /// center : (3,) array_like
    ///     Center (m).
    /// radius : float
    ///     Radius (m), > 0.
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     If a number is out of range.
    #[staticmethod]
    #[pyo3(text_signature = "(center, radius)")]
    fn sphere(center: &Bound<'_, PyAny>, radius: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Obstacle::sphere(vector(center, "center")?, number(radius, "radius")?))
    }

    /// Return a box about the origin, its edges along the axes.
    ///
    /// Parameters
    /// ----------
    /// half_extents : (3,) array_like
    ///     Half its edges (m), > 0.
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     If an edge is out of range.
    #[staticmethod]
    #[pyo3(name = "box", text_signature = "(half_extents)")]
    fn cuboid(half_extents: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Obstacle::cuboid(vector(half_extents, "half_extents")?))
    }

    /// Return the capsule of all points within a distance of a segment.
    ///
    /// Parameters
    /// ----------
    /// a, b : (3,) array_like
    ///     Ends of the segment (m).
    /// radius : float
    ///     Radius (m), > 0.
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     If a number is out of range.
    #[staticmethod]
    #[pyo3(text_signature = "(a, b, radius)")]
    fn capsule(a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>, radius: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Obstacle::capsule(vector(a, "a")?, vector(b, "b")?, number(radius, "radius")?))
    }

    /// Return a cylinder about the origin, its axis along z.
    ///
    /// Parameters
    /// ----------
    /// half_height : float
    ///     Half its height (m), > 0.
    /// radius : float
    ///     Radius (m), > 0.
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     If a number is out of range.
    #[staticmethod]
    #[pyo3(text_signature = "(half_height, radius)")]
    fn cylinder(half_height: &Bound<'_, PyAny>, radius: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Obstacle::cylinder(number(half_height, "half_height")?, number(radius, "radius")?))
    }

    /// Return a copy turned about the origin, then shifted: a point at x comes to ``rotation @ x + translation``.
    ///
    /// Parameters
    /// ----------
    /// rotation : (3, 3) or (4, 4) array_like, optional
    ///     Proper rotation, orthonormal to 1e-9; a (4, 4) matrix holds the shift too.
    /// translation : (3,) array_like, optional
    ///     Shift (m).
    ///
    /// Returns
    /// -------
    /// Obstacle
    ///     The copy; it shares the shape, so it costs next to nothing.
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     If the rotation is none.
    #[pyo3(signature = (rotation=None, translation=None), text_signature = "(self, rotation=None, translation=None)")]
    fn moved(
        &self,
        rotation: Option<&Bound<'_, PyAny>>,
        translation: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (rotation, translation) = rotation_and_translation(rotation, translation)?;
        made(self.inner.moved(&rotation, &translation))
    }

    /// Return a copy that gives way under the contact's forces.
    ///
    /// At the contact's nodes ``g = g0 + (R_H + R_P) f``, R_H the skin's response and R_P the product's, both along the
    /// obstacle's normals; the pressure is the same on both sides.
    ///
    /// Parameters
    /// ----------
    /// shear_modulus : float
    ///     G (Pa), > 0.
    /// poisson_ratio : float
    ///     nu, in [0, 0.5].
    /// response : HalfSpace, GaussianCorrected, Layer or GivenMatrix, optional
    ///     Displacement of the surface per unit force; None for ``HalfSpace()``, which knows neither how thick the
    ///     product is nor how it bends. A kernel is taken at the contact's nodes, with pressure and discretization of the
    ///     skin, and a `Layer` has one thickness. A `GivenMatrix` knows vertices of the product's mesh, all that the skin
    ///     may touch, with a compliance (k, k) along the force; it is linear over the triangles in between, whose size
    ///     `accuracy.body_error` and the other estimates know.
    ///
    /// Returns
    /// -------
    /// Obstacle
    ///     The copy; it shares the shape, and moved copies keep the material.
    ///
    /// Raises
    /// ------
    /// ResponseError
    ///     If a constant is out of range, or no product has such a response.
    ///
    /// Warns
    /// -----
    /// ResponseRangeWarning
    ///     If the response is not well posed.
    ///
    /// References
    /// ----------
    /// Johnson 1985, "Contact Mechanics", section 4.1.
    ///
    /// Examples
    /// --------
    /// >>> import quasirigid as qr
    /// >>> tip = qr.models.fingertip()
    /// >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    /// >>> plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
    /// >>> foam = plate.with_material(shear_modulus=60e3, poisson_ratio=0.5)
    /// >>> contact = qr.press(tip, foam, skin, [0, 0, 1], depth=1e-3)
    /// >>> round(contact.obstacle_share, 6)
    /// 0.5
    #[pyo3(signature = (*, shear_modulus, poisson_ratio, response=None), text_signature = "(self, *, shear_modulus, poisson_ratio, response=None)")]
    fn with_material(
        &self,
        py: Python<'_>,
        shear_modulus: &Bound<'_, PyAny>,
        poisson_ratio: &Bound<'_, PyAny>,
        response: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let constants = (number(shear_modulus, "shear_modulus")?, number(poisson_ratio, "poisson_ratio")?);
        Ok(made_of(py, &self.inner, constants, response, true)?.into())
    }

    /// What it is made of, or None of a rigid one.
    #[getter]
    fn material<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        material_out(py, &self.inner)
    }

    /// Return signed distance, closest point and outward normal of points.
    ///
    /// Parameters
    /// ----------
    /// points : (n, 3) array_like
    ///     Points (m).
    /// max_distance : float, optional
    ///     Search no farther (m): beyond it the distance is inf, the others nan.
    ///
    /// Returns
    /// -------
    /// distance : (n,) float64
    ///     Signed distance (m), positive outside.
    /// closest : (n, 3) float64
    ///     Closest point of the surface (m).
    /// normal : (n, 3) float64
    ///     Outward unit normal there.
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     If a point is not finite, or `max_distance` is negative.
    #[pyo3(signature = (points, max_distance=None), text_signature = "(self, points, max_distance=None)")]
    fn signed_distance<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        max_distance: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Distances<'py>> {
        let points = vectors(points, "points")?;
        let max_distance = max_distance.map(|value| number(value, "max_distance")).transpose()?;
        let found = detached_with(py, None, |interrupt| {
            self.inner.signed_distance_until(&points, max_distance, interrupt)
        })?;
        let answer = found.map_err(IntoPyErr::into_py_err)?;
        Ok((
            PyArray1::from_vec(py, answer.distance),
            vectors_out(py, &answer.closest),
            vectors_out(py, &answer.normal),
        ))
    }

    /// "mesh", "half_space", "sphere", "box", "capsule" or "cylinder".
    #[getter]
    fn kind(&self) -> &'static str {
        self.inner.kind()
    }

    /// Lowest and highest corner in the world (2, 3), or None for a half-space.
    #[getter]
    fn bounding_box<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.inner.bounding_box().map(|bounds| vectors_out(py, &[bounds.low, bounds.high]))
    }

    /// (3,) float64: center of mass of the obstacle filled evenly (m), or None for a half-space.
    #[getter]
    fn center_of_mass<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.inner.center_of_mass().map(|center| vector_out(py, &center))
    }

    /// Return a copy laid into a frame, such as `PosedHand.palm`.
    ///
    /// Its longest principal axis lies along x of the frame, the shortest along z, its center of mass over the
    /// origin. Of the four turns that do so it takes the smallest.
    ///
    /// Parameters
    /// ----------
    /// frame : (4, 4) array_like
    ///     Rigid motion from the frame to the world (m).
    /// surface : Surface, optional
    ///     Skin that it touches, coming from +z; for the frame of a palm, the palm's when left out. Without a
    ///     skin its lowest point is at z = 0.
    /// rotation : (3, 3) array_like, optional
    ///     Turn of the obstacle as it lies so, in the frame, about its center of mass, before it comes down.
    ///
    /// Returns
    /// -------
    /// Obstacle
    ///
    /// Raises
    /// ------
    /// ObstacleError
    ///     The frame or the turn is no rigid motion, or the obstacle is a half-space.
    /// ContactError
    ///     It meets no skin that may touch.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np
    /// >>> import quasirigid as qr
    /// >>> handle = qr.Obstacle.cylinder(half_height=0.06, radius=0.015)
    /// >>> handle.placed(np.eye(4)).bounding_box.round(3).tolist()
    /// [[-0.06, -0.015, 0.0], [0.06, 0.015, 0.03]]
    #[pyo3(signature = (frame, surface=None, *, rotation=None), text_signature = "(self, frame, surface=None, *, rotation=None)")]
    fn placed(
        &self,
        py: Python<'_>,
        frame: &Bound<'_, PyAny>,
        surface: Option<&PySurface>,
        rotation: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (axes, origin) = motion(frame, "frame", "(4, 4)")?;
        let turn = rotation.map_or(Ok(Matrix3::identity()), |rotation| matrix3(rotation, "rotation"))?;
        let known = frame.getattr_opt("surface")?.filter(|known| !known.is_none());
        let known = known.as_ref().map(|known| known.cast::<PySurface>()).transpose()?;
        let skin = surface.or(known.map(|known| known.get())).map(|surface| &surface.inner);
        let inwards = -axes.column(2).normalize();
        let laid = released(py, || {
            let placed = self.inner.placed(&axes, &origin.unwrap_or_default(), &turn)?;
            skin.map_or(Ok(placed.clone()), |skin| touching(skin, &placed, &inwards))
        });
        laid.map(Self::from).map_err(IntoPyErr::into_py_err)
    }

    /// Return vertices and faces of a mesh obstacle in the world, or None for a primitive.
    fn triangles<'py>(&self, py: Python<'py>) -> Option<TriangleArrays<'py>> {
        self.inner.triangles().map(|(vertices, faces)| (vectors_out(py, &vertices), faces_out(py, &faces)))
    }

    /// (3, 3) float64: rotation of the pose.
    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        rotation_out(py, self.inner.pose().rotation.to_rotation_matrix().matrix())
    }

    /// (3,) float64: translation of the pose (m).
    #[getter]
    fn translation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector_out(py, &self.inner.pose().translation.vector)
    }

    /// Arguments that make the same obstacle again, to the bit: pickling, copying.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, &self.inner)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shape = described(&self.inner);
        Ok(match self.material(py)? {
            None => format!("Obstacle({shape})"),
            Some(material) => format!("Obstacle({shape}, {})", material.repr()?),
        })
    }
}

/// Return the obstacle of a pickle: kind, mesh or numbers of the primitive, pose, and material or None.
#[pyfunction]
#[pyo3(signature = (kind, shape, pose, material=None, /), text_signature = "(kind, shape, pose, material=None, /)")]
pub(super) fn restore_obstacle(
    py: Python<'_>,
    kind: &str,
    shape: &Bound<'_, PyAny>,
    pose: Pose,
    material: Option<(f64, f64, Bound<'_, PyAny>)>,
) -> PyResult<PyObstacle> {
    let rigid = restored(kind, shape, pose)?;
    let obstacle = match material {
        None => rigid,
        Some((shear_modulus, poisson_ratio, response)) => {
            made_of(py, &rigid, (shear_modulus, poisson_ratio), Some(&response), false)?
        }
    };
    Ok(obstacle.into())
}
