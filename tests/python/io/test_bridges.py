"""Meshes and contacts of other libraries: stand-ins with their attributes, and the libraries themselves."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from quasirigid._extras import import_extra
from quasirigid.errors import MissingExtraError
from quasirigid.io import contact_dataframe, contact_pyvista, contact_trimesh, mesh_arrays
from shapes import tetrahedron

CORNERS, FACES = tetrahedron()


def cells(kind: str, rows: Any) -> SimpleNamespace:
    """A block of cells as meshio has it."""
    return SimpleNamespace(type=kind, data=np.asarray(rows))


def counted(faces: Any) -> Any:
    """Faces in one row, each after the number of its corners, as VTK has them."""
    return np.concatenate([[len(face), *face] for face in faces])


MESHES = {
    "trimesh": SimpleNamespace(vertices=CORNERS, faces=FACES),
    "open3d": SimpleNamespace(vertices=CORNERS.tolist(), triangles=FACES.astype(np.int32)),
    "meshio": SimpleNamespace(
        points=CORNERS,
        cells=[cells("triangle", FACES[:1]), cells("line", [[0, 1]]), cells("triangle", FACES[1:])],
    ),
    "pyvista": SimpleNamespace(points=CORNERS.astype(np.float32), faces=counted(FACES), n_strips=0),
    "ourselves": qr.Surface(CORNERS, FACES),
}


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES.keys())
def test_meshes_of_other_libraries_become_surfaces_and_obstacles(mesh: Any) -> None:
    surface = qr.Surface.from_mesh(mesh)
    assert np.array_equal(surface.vertices, CORNERS)
    assert np.array_equal(surface.faces, FACES)
    triangles = qr.Obstacle.from_mesh(mesh).triangles()
    assert triangles is not None
    assert np.array_equal(triangles[0], CORNERS)
    assert np.array_equal(triangles[1], FACES)


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES.keys())
def test_arrays_of_a_mesh_object_are_copies(mesh: Any) -> None:
    vertices, faces = mesh_arrays(mesh)
    vertices += 1.0
    faces += 1
    again, rows = mesh_arrays(mesh)
    assert np.array_equal(again, CORNERS)
    assert np.array_equal(rows, FACES)


def test_unit_and_mask_of_a_mesh_object_are_kept() -> None:
    mask = np.array([True, False, True, True])
    surface = qr.Surface.from_mesh(MESHES["trimesh"], unit="inch", skin_mask=mask)
    assert surface.vertices == pytest.approx(25.4e-3 * CORNERS, rel=1e-15)
    assert np.array_equal(surface.skin_mask, mask)
    box = qr.Obstacle.from_mesh(MESHES["meshio"], unit="mm", check_crossings=False).bounding_box
    assert box == pytest.approx(np.array([[0.0] * 3, [1e-3] * 3]), rel=1e-15)


REFUSED = {
    "quads of trimesh's kind": (
        SimpleNamespace(vertices=CORNERS, faces=[[0, 1, 2, 3]]),
        r"SimpleNamespace has faces of int64 and shape \(1, 4\), expected whole numbers \(m, 3\)",
    ),
    "faces that are no whole numbers": (
        SimpleNamespace(vertices=CORNERS, faces=FACES.astype(float)),
        "faces of float64",
    ),
    "quads of meshio": (
        SimpleNamespace(points=CORNERS, cells=[cells("triangle", FACES), cells("quad", [[0, 1, 2, 3]])]),
        "has 1 cells of type 'quad', expected triangles alone",
    ),
    "meshio without triangles": (
        SimpleNamespace(points=CORNERS, cells=[cells("line", [[0, 1]])]),
        "no cells of type 'triangle'",
    ),
    "quads of pyvista": (
        SimpleNamespace(points=CORNERS, faces=counted([(0, 2, 1), (0, 1, 2, 3), (1, 2, 3)])),
        "has a face 1 with 4 corners, expected triangles: call `triangulate",
    ),
    "strips of pyvista": (
        SimpleNamespace(points=CORNERS, faces=counted(FACES), n_strips=2),
        "2 triangle strips",
    ),
    "a defect of the mesh itself": (SimpleNamespace(vertices=CORNERS, faces=FACES + 1), "vertex 4"),
}


@pytest.mark.parametrize(("mesh", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_is_no_triangle_mesh_is_refused_with_what_it_has(mesh: Any, message: str) -> None:
    with pytest.raises(qr.SurfaceError, match=message):
        qr.Surface.from_mesh(mesh)
    with pytest.raises(qr.ObstacleError, match=message):
        qr.Obstacle.from_mesh(mesh)


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (object(), "object has neither vertices nor points, expected vertices and faces"),
        (SimpleNamespace(vertices=CORNERS), "SimpleNamespace has vertices alone, expected"),
        (SimpleNamespace(points=CORNERS, cells=np.arange(8)), "has cells and points alone, expected"),
        (qr.Obstacle.sphere([0, 0, 0], 1.0), "Obstacle has triangles alone, expected"),
    ],
)
def test_what_is_no_mesh_is_refused_with_its_type(mesh: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        qr.Surface.from_mesh(mesh)


def test_an_unknown_unit_of_a_mesh_object_is_refused() -> None:
    with pytest.raises(qr.SurfaceError, match="unit is 'km', expected 'm', 'cm', 'mm' or 'inch'"):
        qr.Surface.from_mesh(MESHES["trimesh"], unit="km")  # type: ignore[arg-type]


def test_objects_of_trimesh_are_read() -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=8.0)
    surface = qr.Surface.from_mesh(mesh, unit="mm")
    assert np.array_equal(surface.faces, mesh.faces)
    with pytest.raises(TypeError, match="Scene has"):
        qr.Surface.from_mesh(trimesh.Scene(mesh))


def test_objects_of_meshio_are_read() -> None:
    meshio = pytest.importorskip("meshio")
    mesh = meshio.Mesh(CORNERS, [("triangle", FACES)])
    assert np.array_equal(qr.Surface.from_mesh(mesh).faces, FACES)
    with pytest.raises(qr.SurfaceError, match="1 cells of type 'tetra'"):
        qr.Surface.from_mesh(meshio.Mesh(CORNERS, [("tetra", [[0, 1, 2, 3]])]))


def test_objects_of_pyvista_are_read() -> None:
    pyvista = pytest.importorskip("pyvista")
    ball = pyvista.Icosphere(radius=8.0, nsub=2)
    surface = qr.Surface.from_mesh(ball, unit="mm")
    assert surface.is_closed
    assert len(surface.faces) == ball.n_cells
    with pytest.raises(qr.ObstacleError, match="a face 0 with 4 corners"):
        qr.Obstacle.from_mesh(pyvista.Cube())
    assert qr.Obstacle.from_mesh(pyvista.Cube().triangulate().clean()).kind == "mesh"
    with pytest.raises(TypeError, match="UnstructuredGrid has cells and points alone"):
        qr.Surface.from_mesh(ball.cast_to_unstructured_grid())


def test_a_mesh_object_is_read_without_an_import_of_its_library() -> None:
    before = set(sys.modules)
    mesh_arrays(MESHES["trimesh"])
    assert set(sys.modules) == before


def test_a_data_frame_has_one_row_a_vertex_and_units_in_its_names(pressed: qr.Contact) -> None:
    pytest.importorskip("pandas")
    frame = pressed.to_dataframe()
    names = ["x (m)", "y (m)", "z (m)", "pressure (Pa)", "node_force (N)", "force_x (N)", "force_y (N)"]
    names += ["force_z (N)", "gap (m)", "displacement_x (m)", "displacement_y (m)", "displacement_z (m)"]
    assert list(frame.columns) == [*names, "candidate", "active"]
    assert frame.index.name == "vertex"
    assert np.array_equal(frame[["x (m)", "y (m)", "z (m)"]], pressed.deformed.vertices)
    assert np.array_equal(frame["pressure (Pa)"], pressed.pressure)
    assert np.array_equal(np.flatnonzero(frame["active"]), pressed.active)
    assert frame["node_force (N)"].sum() == pytest.approx(pressed.force[2])


def test_a_mesh_of_pyvista_carries_every_vertex_array(pressed: qr.Contact) -> None:
    pytest.importorskip("pyvista", reason="pyvista is not installed")
    mesh = pressed.to_pyvista()
    assert np.array_equal(mesh.points, pressed.deformed.vertices)
    assert np.array_equal(mesh.faces.reshape(-1, 4)[:, 1:], pressed.deformed.faces)
    assert np.array_equal(mesh.point_data["force"], pressed.force_vectors)
    assert mesh.active_scalars_name == "pressure"
    assert np.array_equal(qr.Surface.from_mesh(mesh).vertices, pressed.deformed.vertices)


def test_a_mesh_of_trimesh_carries_every_vertex_array(pressed: qr.Contact) -> None:
    pytest.importorskip("trimesh")
    mesh = pressed.to_trimesh()
    assert np.array_equal(mesh.vertices, pressed.deformed.vertices)
    assert np.array_equal(mesh.faces, pressed.deformed.faces)
    assert np.array_equal(mesh.vertex_attributes["pressure"], pressed.pressure)
    assert np.array_equal(qr.Surface.from_mesh(mesh).vertices, pressed.deformed.vertices)


class Recorder:
    """Stands in for a library's class: keeps what it is made with."""

    def __init__(self, *values: Any, **named: Any) -> None:
        self.values, self.named = values, named
        self.point_data: dict[str, Any] = {}

    def set_active_scalars(self, name: str) -> None:
        self.active = name

    def rename_axis(self, index: str) -> Recorder:
        self.index = index
        return self


def test_the_libraries_are_called_with_plain_arrays(
    pressed: qr.Contact, monkeypatch: pytest.MonkeyPatch
) -> None:
    stand_ins = {"pandas": "DataFrame", "pyvista": "PolyData", "trimesh": "Trimesh"}
    for library, name in stand_ins.items():
        monkeypatch.setitem(sys.modules, library, SimpleNamespace(**{name: Recorder}))
    frame, grid, mesh = pressed.to_dataframe(), pressed.to_pyvista(), pressed.to_trimesh()
    assert frame.values[0]["z (m)"].shape == (len(pressed.pressure),)
    assert frame.values[0]["active"].dtype == bool
    assert np.array_equal(grid.values[1][:4], [3, *pressed.deformed.faces[0]])
    assert grid.point_data.keys() == mesh.named["vertex_attributes"].keys() >= {"pressure", "force", "gap"}
    assert (grid.active, mesh.named["process"]) == ("pressure", False)


@pytest.mark.parametrize(
    ("library", "make"),
    [("pandas", contact_dataframe), ("pyvista", contact_pyvista), ("trimesh", contact_trimesh)],
)
def test_a_missing_library_is_named_with_its_remedy(
    library: str, make: Any, pressed: qr.Contact, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(MissingExtraError, match=f"need {library}: pip install {library}"):
        make(pressed)


@pytest.mark.parametrize("fault", ["import lacking_one", "raise ValueError('wrong version')"])
def test_a_library_that_cannot_be_imported_is_named_with_the_reason(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "broken_one.py").write_text(fault)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(
        MissingExtraError, match=r"^pictures need broken_one, .*: .*(lacking_one|wrong version)"
    ):
        import_extra("broken_one", "pictures", "it")
