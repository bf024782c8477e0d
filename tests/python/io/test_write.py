"""Mesh files that are written: read back the same, or not written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from mesh_files import FACES, POINTS
from quasirigid.errors import MeshFileError
from quasirigid.io import UNITS, LengthUnit, write_mesh

FAR = [[0, 1, 2], [0, 1, 9], [-1, 0, 1]]


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (
            np.full((4, 3), np.nan),
            FACES,
            r"mesh\.stl: vertex 0 is at \(nan, nan, nan\), 4 such vertices in all",
        ),
        (POINTS, FAR, r"mesh\.stl: face 1 refers to vertex 9, but there are 4 vertices, 2 such faces"),
        (POINTS, [[0.0, 1.0, 2.0]], r"has faces of float64 and shape \(1, 3\), expected whole numbers"),
        (POINTS, [0, 1, 2], r"has faces of int64 and shape \(3,\), expected whole numbers \(m, 3\)"),
        (POINTS, [], "has faces of float64"),
        (POINTS, np.empty((0, 3), dtype=int), "has 4 vertices but no faces"),
        (np.zeros((4, 2)), FACES, r"vertices is an array of shape \(4, 2\), expected numbers \(n, 3\)"),
        ("mesh.ply", POINTS, r"vertices is 'mesh\.ply', expected .*: write_mesh\(vertices, faces, path, "),
    ],
)
def test_what_could_not_be_read_again_is_not_written(
    tmp_path: Path, vertices: Any, faces: Any, message: str
) -> None:
    with pytest.raises(MeshFileError, match=message):
        write_mesh(vertices, faces, tmp_path / "mesh.stl", unit="mm")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("ending", [".ply", ".stl"])
def test_what_is_written_is_read_back(tmp_path: Path, ending: str, unit: LengthUnit) -> None:
    finger = qr.models.fingertip(edge_length=2e-3)
    vertices, faces = finger.vertices, finger.faces
    path = tmp_path / f"finger{ending}"
    write_mesh(vertices, faces, path, unit=unit)
    read_vertices, read_faces = qr.read_mesh(path, unit=unit)
    assert len(read_vertices) == len(vertices)
    # STL stores float32: at most half a unit in the last place of 30 mm; PLY stores float64.
    bound = 0.03 * (2.0**-52 if ending == ".ply" else 2.0**-24)
    assert np.abs(read_vertices[read_faces] - vertices[faces]).max() <= bound


@pytest.mark.parametrize("shift", [1e3, 1e6])
def test_stl_refuses_what_float32_would_collapse(tmp_path: Path, shift: float) -> None:
    # float32 is spaced 0.06 mm at 1 km and 60 mm at 1000 km; the edges are 2 mm long.
    finger = qr.models.fingertip(edge_length=2e-3)
    far = finger.vertices + shift
    with pytest.raises(MeshFileError, match=r"far\.stl: face 0 at .* lose its shape as float32, .*\.ply"):
        write_mesh(far, finger.faces, tmp_path / "far.stl", unit="m")
    assert not list(tmp_path.iterdir())
    write_mesh(far, finger.faces, tmp_path / "far.ply", unit="m")
    assert np.array_equal(qr.read_mesh(tmp_path / "far.ply", unit="m")[0], far)


@pytest.mark.parametrize("size", [1e-46, 1e39, 1e200])
def test_stl_refuses_numbers_that_float32_does_not_hold(tmp_path: Path, size: float) -> None:
    with pytest.raises(MeshFileError, match="as float32, 4 such faces in all"):
        write_mesh(size * np.array(POINTS), FACES, tmp_path / "mesh.stl", unit="m")


def test_what_float32_holds_exactly_is_written_however_short_an_edge(tmp_path: Path) -> None:
    points = np.array([*POINTS, (1.0 + 2.0**-23, 0.0, 0.0)])
    write_mesh(points, [*FACES, (1, 4, 2)], tmp_path / "mesh.stl", unit="m")
    vertices, faces = qr.read_mesh(tmp_path / "mesh.stl", unit="m")
    assert np.array_equal(vertices[faces[-1]], points[[1, 4, 2]])
