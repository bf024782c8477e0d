"""Meshes and files with any damage: taken with finite figures, or refused by name."""

from __future__ import annotations

import io
import tempfile
import zipfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from fuzz_profile import EXAMPLES
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from quasirigid.errors import MeshFileError
from quasirigid.io import write_mesh
from shapes import Mesh, ball, grid, tetrahedron

pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
SKIN = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())

number = (
    st.sampled_from([0.0, 1e-300, 1e-12, 1e-3, 1.0, 1e9, 1e59, 1e61, 1e200, np.inf, np.nan]) | st.floats()
)
change = st.tuples(
    st.sampled_from(["move", "draw", "join", "scale", "shift", "face", "flip", "drop", "copy", "swap"]),
    st.integers(0, 10**6),
    st.integers(0, 10**6),
    number,
)


def changed(mesh: Mesh, changes: list[tuple[str, int, int, float]]) -> Mesh:
    vertices, faces = mesh[0].copy(), mesh[1].astype(np.int64).copy()
    for kind, i, j, x in changes:
        v, w, f = i % len(vertices), j % len(vertices), i % max(len(faces), 1)
        with np.errstate(all="ignore"):
            match kind:
                case "move":
                    vertices[v, j % 3] = x
                case "draw":
                    vertices[v] *= x
                case "join":
                    vertices[v] = vertices[w]
                case "scale":
                    vertices *= x
                case "shift":
                    vertices[:, j % 3] += x
                case _ if len(faces) == 0:
                    pass
                case "face":
                    faces[f, j % 3] = j % (len(vertices) + 2) - 1
                case "flip":
                    faces[f] = faces[f, ::-1]
                case "drop":
                    faces = np.delete(faces, f, axis=0)
                case "copy":
                    faces = np.concatenate([faces, faces[f : f + 1]])
                case _:
                    faces[f] = faces[j % len(faces)]
    return vertices, faces


meshes = st.sampled_from(["tetrahedron", "ball", "grid"]).map(
    {"tetrahedron": tetrahedron(), "ball": ball(8e-3, 1), "grid": grid(4, 1e-3)}.__getitem__
)


def check_surface(surface: qr.Surface) -> None:
    assert np.isfinite([surface.area, surface.mean_edge_length]).all()
    assert np.isfinite(surface.volume) == surface.is_closed
    assert np.isfinite(surface.vertex_normals).all()
    assert np.isfinite(surface.vertex_areas).all()
    np.testing.assert_allclose(np.linalg.norm(surface.vertex_normals, axis=1), 1.0, rtol=1e-9)
    size = np.ptp(surface.vertices, axis=0).max()
    # Entries go with one over the size.
    if 1e-50 < size < 1e50:
        assert np.isfinite(qr.response_matrix(surface, SKIN, [0, 1, 2])).all()


def check_obstacle(obstacle: qr.Obstacle, vertices: NDArray[np.float64]) -> None:
    center = vertices.mean(axis=0)
    points = np.concatenate([vertices, [center], center + 2.0 * (vertices - center)])
    distance, closest, normal = obstacle.signed_distance(points)
    assert np.isfinite(distance).all()
    assert np.isfinite(closest).all()
    assert np.isfinite(normal).all()


@given(meshes, st.lists(change, max_size=4))
@settings(max_examples=6 * EXAMPLES)
def test_a_damaged_mesh_is_sound_or_refused(mesh: Mesh, changes: list[tuple[str, int, int, float]]) -> None:
    vertices, faces = changed(mesh, changes)
    try:
        check_surface(qr.Surface(vertices, faces))
    except qr.SurfaceError as error:
        assert str(error)
    try:
        check_obstacle(qr.Obstacle.mesh(vertices, faces), vertices)
    except qr.ObstacleError as error:
        assert str(error)
    try:
        repaired = qr.repair(vertices, faces, weld_tolerance=1e-6)
        assert np.isfinite(repaired.vertices).all()
        check_surface(qr.Surface(repaired.vertices, repaired.faces))
    except qr.SurfaceError as error:
        assert str(error)


def written(ending: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mesh{ending}"
        write_mesh(*tetrahedron(), path, unit="m")
        return path.read_bytes()


ASCII_PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)
ASCII_STL = (
    b"solid a\nfacet normal 0 0 1\nouter loop\n"
    b"vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
)
OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1/1/1 2//1 -1\n"
FILES = [
    (".ply", ASCII_PLY),
    (".stl", ASCII_STL),
    (".obj", OBJ),
    *((end, written(end)) for end in (".ply", ".stl")),
]

cut = st.tuples(
    st.sampled_from(["set", "delete", "insert", "repeat", "number", "end"]),
    st.integers(0, 2**16),
    st.integers(0, 2**16),
    st.binary(min_size=1, max_size=8),
)
NUMBERS = [
    b"-1",
    b"0",
    b"1e999",
    b"nan",
    b"99999999999999999999",
    b"1099511627776",
    b"0x7",
    b"1_0",
    b"\xb2",
    b"9" * 5000,
]


def damaged(data: bytes, cuts: list[tuple[str, int, int, bytes]]) -> bytes:
    for kind, i, j, new in cuts:
        at, to = sorted((i % (len(data) + 1), j % (len(data) + 1)))
        match kind:
            case "set":
                data = data[:at] + new + data[at + len(new) :]
            case "delete":
                data = data[:at] + data[min(to, at + 40) :]
            case "insert":
                data = data[:at] + new + data[at:]
            case "repeat":
                data = data[:to] + data[at:to] + data[to:]
            case "number":
                words = data.split(b" ")
                words[i % len(words)] = NUMBERS[j % len(NUMBERS)] + words[i % len(words)].lstrip(
                    b"0123456789"
                )
                data = b" ".join(words)
            case _:
                data = data[:at]
    return data


@given(st.sampled_from(FILES), st.lists(cut, min_size=1, max_size=4))
@settings(max_examples=6 * EXAMPLES)
def test_a_damaged_file_is_read_or_refused_with_its_name(
    file: tuple[str, bytes], cuts: list[tuple[str, int, int, bytes]]
) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mesh{file[0]}"
        path.write_bytes(damaged(file[1], cuts))
        try:
            vertices, faces = qr.read_mesh(path, unit="mm")
        except MeshFileError as error:
            assert str(path) in str(error)
            return
    assert np.isfinite(vertices).all()
    assert faces.min() >= 0 and faces.max() < len(vertices)


@cache
def prepared(kind: str) -> bytes:
    surface = qr.Surface(*ball(8e-3, 2))
    bone = qr.Surface(ball(3e-3, 1)[0] + [0, 0, 5e-3], ball(3e-3, 1)[1])
    response = {
        "half_space": qr.HalfSpace(),
        "layer": qr.Layer(thickness=np.full(162, 0.02)),
        "body": qr.Body(bone=bone),
    }
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=response[kind])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "skin.npz"
        skin.prepared(surface, np.arange(6)).save(path)
        return path.read_bytes()


part = st.tuples(
    st.integers(0, 100),
    st.sampled_from(
        ["cut", "empty", "nan", "huge", "negative", "reshaped", "integers", "words", "missing", "one"]
    ),
)


def with_parts(data: bytes, parts: list[tuple[int, str]]) -> bytes:
    with np.load(io.BytesIO(data)) as stored:
        arrays: dict[str, Any] = {name: stored[name] for name in stored.files}
    for which, how in parts:
        names = sorted(arrays)
        name = names[which % len(names)]
        value = arrays[name]
        if how == "missing":
            del arrays[name]
        elif value.dtype.kind == "U":
            arrays[name] = np.array(
                str(value).replace("0", "-1") if how == "negative" else str(value)[: which % 300]
            )
        else:
            with np.errstate(all="ignore"):
                arrays[name] = {
                    "cut": lambda value: value[:-1] if value.ndim else value,
                    "empty": lambda value: value.reshape(-1)[:0],
                    "nan": lambda value: np.full(value.shape, np.nan),
                    "huge": lambda value: value * 1e200,
                    "negative": lambda value: -value.astype(float) if value.dtype == bool else -value,
                    "reshaped": lambda value: value.reshape(-1),
                    "integers": lambda value: np.ones(value.shape, dtype=np.int64) * 2**40,
                    "words": lambda value: np.full(value.shape, "word"),
                    "one": lambda value: np.array(1.0),
                }[how](value)
        if not arrays:
            break
    out = io.BytesIO()
    np.savez(out, **arrays)
    return out.getvalue()


@given(
    st.sampled_from(["half_space", "layer", "body"]),
    st.lists(part, max_size=3),
    st.lists(cut, max_size=2),
)
@settings(max_examples=4 * EXAMPLES)
def test_a_damaged_prepared_skin_is_loaded_or_refused_with_its_name(
    kind: str, parts: list[tuple[int, str]], cuts: list[tuple[str, int, int, bytes]]
) -> None:
    data = with_parts(prepared(kind), parts) if parts else prepared(kind)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "skin.npz"
        path.write_bytes(damaged(data, [one for one in cuts if one[0] != "number"]))
        try:
            skin = qr.load_prepared(path)
        except qr.ResponseError as error:
            assert str(path) in str(error)
            return
    surface = qr.Surface(*ball(8e-3, 2))
    plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
    try:
        contact = qr.press(surface, plate, skin, [0, 0, 1], depth=1e-4, throw=False)
    except qr.QuasirigidError:
        return
    if contact.status == "solved":
        assert np.isfinite(contact.force).all()


@given(st.binary(max_size=300), st.sampled_from([".ply", ".stl", ".obj", ".npz"]))
def test_bytes_of_no_kind_are_refused(data: bytes, ending: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"file{ending}"
        path.write_bytes(data)
        with pytest.raises((MeshFileError, qr.ResponseError), match="file"):
            qr.load_prepared(path) if ending == ".npz" else qr.read_mesh(path, unit="m")


def test_a_zip_with_overlapping_parts_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "skin.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("header.npy", b"x" * 1000)
    data = path.read_bytes()
    # The directory's one entry again and again: parts that share their bytes.
    start, end = data.rindex(b"PK\x01\x02"), data.rindex(b"PK\x05\x06")
    entries = b"".join(data[start:end].replace(b"header.npy", f"head{k:02}.npy".encode()) for k in range(90))
    tail = bytearray(data[end:])
    tail[8:12] = (90).to_bytes(2, "little") * 2
    tail[12:16] = len(entries).to_bytes(4, "little")
    path.write_bytes(data[:start] + entries + tail)
    with pytest.raises(qr.ResponseError, match="cannot be read"):
        qr.load_prepared(path)
