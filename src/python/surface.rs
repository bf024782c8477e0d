//! `quasirigid.Surface`.

use numpy::ndarray::Dimension;
use numpy::{Element, PyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::geometry::ray::first_hit;
use crate::geometry::rigid_motion;
use crate::mesh::check::check_elements;
use crate::python::arrays_out::{faces_out, nodes_out, read_only, vectors_out};
use crate::python::convert::{faces, integer, mask, mesh_arrays, nodes, rotation_and_translation, vectors};
use crate::python::errors::{IntoPyErr, SurfaceError};
use crate::python::forked::released;
use crate::surface::Surface;

/// The skin: a triangle mesh, checked once.
///
/// Parameters
/// ----------
/// vertices : (n, 3) array_like
///     Positions (m).
/// faces : (m, 3) array_like of int
///     Corners of each triangle, counter-clockwise seen from outside.
/// skin_mask : (n,) array_like of bool, optional
///     Vertices that may touch; None for all.
///
/// Raises
/// ------
/// SurfaceError
///     Naming the first element at fault, its value and how many there are: not finite, out of range, degenerate
///     (height under 1e-12 of the longest edge), duplicate, non-manifold, inconsistently turned, pinched, unused,
///     unwelded, nested or inside out. Nothing is mended in silence; `repair` is the remedy.
///
/// Notes
/// -----
/// Open surfaces are welcome; their volume is nan. Arrays are read-only and shared.
///
/// Examples
/// --------
/// >>> import quasirigid as qr
/// >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
/// >>> surface = qr.Surface(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
/// >>> surface.is_closed, round(surface.volume, 6)
/// (True, 0.166667)
#[pyclass(name = "Surface", module = "quasirigid", frozen, weakref)]
pub(super) struct PySurface {
    pub inner: Surface,
    vertices: PyOnceLock<Py<PyArray2<f64>>>,
    faces: PyOnceLock<Py<PyArray2<i64>>>,
    vertex_normals: PyOnceLock<Py<PyArray2<f64>>>,
    vertex_areas: PyOnceLock<Py<PyArray1<f64>>>,
    skin_mask: PyOnceLock<Py<PyArray1<bool>>>,
}

impl From<Surface> for PySurface {
    fn from(inner: Surface) -> Self {
        Self {
            inner,
            vertices: PyOnceLock::new(),
            faces: PyOnceLock::new(),
            vertex_normals: PyOnceLock::new(),
            vertex_areas: PyOnceLock::new(),
            skin_mask: PyOnceLock::new(),
        }
    }
}

/// The array made once, read-only since it is shared.
fn shared<'py, T: Element, D: Dimension>(
    known: &PyOnceLock<Py<PyArray<T, D>>>,
    py: Python<'py>,
    make: impl FnOnce() -> Bound<'py, PyArray<T, D>>,
) -> Bound<'py, PyArray<T, D>> {
    known.get_or_init(py, || read_only(make())).bind(py).clone()
}

#[pymethods]
impl PySurface {
    #[new]
    #[pyo3(signature = (vertices, faces, skin_mask=None), text_signature = "(vertices, faces, skin_mask=None)")]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        skin_mask: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let vertices = vectors(vertices, "vertices")?;
        let faces = self::faces(faces, "faces", SurfaceError::new_err)?;
        let skin_mask = skin_mask.map(|value| mask(value, "skin_mask")).transpose()?;
        let surface = released(py, || {
            let surface = Surface::new(vertices, faces)?;
            match skin_mask {
                Some(skin_mask) => surface.with_skin_mask(skin_mask),
                None => Ok(surface),
            }
        });
        surface.map(Self::from).map_err(IntoPyErr::into_py_err)
    }

    /// Return the surface of a mesh object of another library.
    ///
    /// Parameters
    /// ----------
    /// mesh : object
    ///     Anything with `vertices` and `faces` (trimesh) or `triangles` (open3d), with `points` and `cells` (meshio), or
    ///     with `points` and `faces` (PolyData of pyvista); triangles alone.
    /// unit : {"m", "cm", "mm", "inch"}
    ///     Unit of its coordinates.
    /// skin_mask : (n,) array_like of bool, optional
    ///     Vertices that may touch; None for all.
    ///
    /// Returns
    /// -------
    /// Surface
    ///     Vertices and faces in the order of the mesh.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If it is no such object.
    /// SurfaceError
    ///     As `Surface`, and for faces that are no triangles.
    #[staticmethod]
    #[pyo3(signature = (mesh, *, unit="m", skin_mask=None), text_signature = "(mesh, *, unit='m', skin_mask=None)")]
    fn from_mesh(
        py: Python<'_>,
        mesh: &Bound<'_, PyAny>,
        unit: &str,
        skin_mask: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (vertices, faces) = mesh_arrays(mesh, unit, py.get_type::<SurfaceError>())?;
        Self::new(py, &vertices, &faces, skin_mask)
    }

    /// (n, 3) float64: positions (m).
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        shared(&self.vertices, py, || vectors_out(py, self.inner.vertices()))
    }

    /// (m, 3) int64: corners of each triangle.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i64>> {
        shared(&self.faces, py, || faces_out(py, self.inner.faces()))
    }

    /// (n, 3) float64: outward unit normals.
    #[getter]
    fn vertex_normals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        shared(&self.vertex_normals, py, || vectors_out(py, self.inner.vertex_normals()))
    }

    /// (n,) float64: a third of the area of the triangles around each vertex (m^2).
    #[getter]
    fn vertex_areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        shared(&self.vertex_areas, py, || PyArray1::from_slice(py, self.inner.vertex_areas()))
    }

    /// (n,) bool: vertices that may touch.
    #[getter]
    fn skin_mask<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        shared(&self.skin_mask, py, || PyArray1::from_slice(py, self.inner.skin_mask()))
    }

    /// Area (m^2).
    #[getter]
    fn area(&self) -> f64 {
        self.inner.area()
    }

    /// Enclosed volume (m^3); nan where the surface is open.
    #[getter]
    fn volume(&self) -> f64 {
        self.inner.volume()
    }

    /// Whether every edge has two faces.
    #[getter]
    fn is_closed(&self) -> bool {
        self.inner.is_closed()
    }

    /// Mean length of the edges (m).
    #[getter]
    fn mean_edge_length(&self) -> f64 {
        self.inner.mean_edge_length()
    }

    /// Return the same surface with another skin mask.
    ///
    /// Parameters
    /// ----------
    /// skin_mask : (n,) array_like of bool
    ///     Vertices that may touch.
    ///
    /// Raises
    /// ------
    /// SurfaceError
    ///     If it has another length than the surface has vertices.
    #[pyo3(signature = (skin_mask), text_signature = "(self, skin_mask)")]
    fn with_skin_mask(&self, skin_mask: &Bound<'_, PyAny>) -> PyResult<Self> {
        let skin_mask = mask(skin_mask, "skin_mask")?;
        self.inner.clone().with_skin_mask(skin_mask).map(Self::from).map_err(IntoPyErr::into_py_err)
    }

    /// Return the surface after a rigid motion: a point at x comes to ``rotation @ x + translation``.
    ///
    /// Parameters
    /// ----------
    /// rotation : (3, 3) or (4, 4) array_like, optional
    ///     Proper rotation, orthonormal to 1e-9; a (4, 4) matrix holds the shift too.
    /// translation : (3,) array_like, optional
    ///     Shift (m).
    ///
    /// Raises
    /// ------
    /// SurfaceError
    ///     If the rotation is none.
    #[pyo3(signature = (rotation=None, translation=None), text_signature = "(self, rotation=None, translation=None)")]
    fn moved(
        &self,
        py: Python<'_>,
        rotation: Option<&Bound<'_, PyAny>>,
        translation: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (rotation, translation) = rotation_and_translation(rotation, translation)?;
        let motion = rigid_motion(&rotation, &translation);
        let motion = motion.map_err(|error| SurfaceError::new_err(error.to_string()))?;
        Ok(released(py, || self.inner.moved(&motion)).into())
    }

    /// Return the vertices within some rings of neighbours, the nodes among them.
    ///
    /// Parameters
    /// ----------
    /// nodes : (k,) array_like of int
    ///     Vertices to start from.
    /// rings : int
    ///     How many rings, >= 0.
    ///
    /// Returns
    /// -------
    /// (j,) int64
    ///     Vertices, ascending.
    ///
    /// Raises
    /// ------
    /// SurfaceError
    ///     If there is no such vertex, or `rings` is negative.
    #[pyo3(signature = (nodes, rings), text_signature = "(self, nodes, rings)")]
    fn k_ring<'py>(
        &self,
        py: Python<'py>,
        nodes: &Bound<'py, PyAny>,
        rings: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let nodes = self::nodes(nodes, "nodes", self.inner.vertices().len(), SurfaceError::new_err)?;
        let rings = integer(rings, "rings", py.get_type::<SurfaceError>())?;
        Ok(nodes_out(py, &self.inner.k_ring(&nodes, rings)))
    }

    /// Return the connected components of a set of vertices.
    ///
    /// Parameters
    /// ----------
    /// nodes : (k,) array_like of int
    ///     Vertices.
    ///
    /// Returns
    /// -------
    /// list of (j,) int64
    ///     The components, each ascending.
    ///
    /// Raises
    /// ------
    /// SurfaceError
    ///     If there is no such vertex.
    #[pyo3(text_signature = "(self, nodes)")]
    fn patches<'py>(
        &self,
        py: Python<'py>,
        nodes: &Bound<'py, PyAny>,
    ) -> PyResult<Vec<Bound<'py, PyArray1<i64>>>> {
        let nodes = self::nodes(nodes, "nodes", self.inner.vertices().len(), SurfaceError::new_err)?;
        Ok(self.inner.patches(&nodes).iter().map(|patch| nodes_out(py, patch)).collect())
    }

    fn __repr__(&self) -> String {
        format!(
            "Surface({} vertices, {} faces, {}, area {:.6e} m²)",
            self.inner.vertices().len(),
            self.inner.faces().len(),
            if self.inner.is_closed() { "closed" } else { "open" },
            self.inner.area()
        )
    }

    /// What makes the same surface again: pickling, copying.
    #[expect(clippy::type_complexity, reason = "the tuple that pickle asks for")]
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(
        Bound<'py, PyAny>,
        (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>, Bound<'py, PyArray1<bool>>),
    )> {
        let restore = py.import("quasirigid._core")?.getattr("restore_surface")?;
        Ok((restore, (self.vertices(py), self.faces(py), self.skin_mask(py))))
    }
}

/// What `Surface.__reduce__` returned; a skin that was deformed may have faces that no new surface may have.
#[pyfunction]
#[pyo3(signature = (vertices, faces, skin_mask))]
pub(super) fn restore_surface(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    skin_mask: &Bound<'_, PyAny>,
) -> PyResult<PySurface> {
    let vertices = vectors(vertices, "vertices")?;
    let faces = self::faces(faces, "faces", SurfaceError::new_err)?;
    let skin_mask = mask(skin_mask, "skin_mask")?;
    let surface = released(py, || {
        check_elements(&vertices, &faces)?;
        let all = vec![true; vertices.len()];
        Surface::from_sound_mesh(vertices, faces, all).with_skin_mask(skin_mask)
    });
    surface.map(PySurface::from).map_err(IntoPyErr::into_py_err)
}

/// The vertices that are skin (n); the facade documents it.
#[pyfunction]
#[pyo3(text_signature = "(surface)")]
pub(super) fn skin_without_caps<'py>(py: Python<'py>, surface: &PySurface) -> Bound<'py, PyArray1<bool>> {
    PyArray1::from_vec(py, released(py, || surface.inner.skin_without_caps()))
}

/// How far it is from a point along a unit direction to the skin (m); 0 where there is none.
#[pyfunction]
#[pyo3(text_signature = "(surface, point, direction)")]
pub(super) fn way_out(surface: &PySurface, point: [f64; 3], direction: [f64; 3]) -> f64 {
    let surface = &surface.inner;
    let corners = |face: &[u32; 3]| face.map(|corner| surface.vertices()[corner as usize]);
    first_hit(&point.into(), &direction.into(), surface.faces().iter().map(corners)).unwrap_or(0.0)
}
