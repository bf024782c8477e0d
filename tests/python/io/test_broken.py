"""Mesh files that are refused with the defect and its place."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from mesh_files import FACES, PLY_HEADER, POINTS, good_ply_rows, obj_text, ply_text, read, stl_bytes, stl_text
from quasirigid.errors import MeshFileError

TRUNCATED = PLY_HEADER.format(order="binary_little_endian", vertices=4, faces=4).encode()
TRUNCATED += np.array(POINTS, dtype="<f4").tobytes() + struct.pack("<B3i", 3, 0, 2, 1)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("cut.ply", TRUNCATED, "ends in face 1 of 4"),
        ("cut.ply", TRUNCATED[:-20], "ends in vertex 3 of 4"),
        ("long.ply", TRUNCATED + struct.pack("<B3i", 3, 0, 1, 3) * 3 + b"xx", "2 bytes are left"),
        ("cut.ply", ply_text(good_ply_rows()[:-1]), "ends in face 3 of 4"),
        ("long.ply", ply_text([*good_ply_rows(), "3 0 1 2"]), "1 lines are left"),
        ("two.ply", ply_text([*good_ply_rows()[:-1], "2 0 1"]), "face 3 has 2 corners"),
        ("word.ply", ply_text(["0 zero 0", *good_ply_rows()[1:]]), "vertex 0 is not understood: '0 zero 0'"),
        ("short.ply", ply_text(["0 0", *good_ply_rows()[1:]]), "vertex 0 is not understood"),
        ("grouped.ply", ply_text(["0 1_0 0", *good_ply_rows()[1:]]), "vertex 0 is not understood"),
        ("huge.ply", ply_text([*good_ply_rows()[:-1], f"3 0 1 {10**30}"]), "face 3 is not understood"),
        (
            "nan.ply",
            ply_text(["0 nan 0", *good_ply_rows()[1:]]),
            r"vertex 0 is at \(0.0, nan, 0.0\), the only one",
        ),
        (
            "far.ply",
            ply_text([*good_ply_rows()[:-2], "3 0 1 7", "3 0 -1 2"]),
            "face 2 refers to vertex 7.*2 such faces",
        ),
        ("none.ply", ply_text(good_ply_rows()[:4], faces=0), "no faces"),
        ("kind.ply", b"ply\nformat ascii 2.0\nend_header\n", "line 2 of the header"),
        ("no.ply", b"solid\n", "does not start with 'ply'"),
        (
            "flat.ply",
            ply_text(good_ply_rows()).replace(b"property float z\n", b""),
            "no element 'vertex' with a number 'z'",
        ),
        ("empty.ply", b"", "does not start"),
        (
            "real.ply",
            ply_text(good_ply_rows()).replace(b"uchar int", b"uchar float"),
            "list of whole numbers",
        ),
        (
            "count.ply",
            ply_text(good_ply_rows()).replace(b"list uchar", b"list float"),
            "line 9 of the header",
        ),
        (
            "bare.ply",
            ply_text(good_ply_rows()).replace(b"end_header", b"element edge 9\nend_header"),
            "no properties",
        ),
        (
            "twice.ply",
            ply_text(good_ply_rows()).replace(b"property float y", b"property float x"),
            "one of them twice",
        ),
        (
            "cut.stl",
            stl_bytes(FACES)[:-1],
            "is 283 bytes long, but its header promises 4 triangles, 284 bytes",
        ),
        ("long.stl", stl_bytes(FACES) + b"x", "is 285 bytes long"),
        ("empty.stl", b"", "0 bytes long"),
        ("cut_text.stl", stl_text(FACES).rpartition("endsolid")[0], "ends after line"),
        (
            "gap.stl",
            stl_text(FACES).replace("      vertex 1.0 0.0 0.0\n", "", 1),
            "line 6 is 'endloop', expected 'vertex'",
        ),
        (
            "word.stl",
            stl_text(FACES).replace("vertex 1.0 0.0", "vertex x 0.0", 1),
            "line 6 .*expected 3 numbers",
        ),
        ("two.obj", obj_text() + "f 1// 2//\n", r"line 11 \('f 1// 2//'\): face 4 has 2 corners"),
        ("far.obj", obj_text() + "f 1 2 9\n", "refers to vertex 9, but the file has 4"),
        ("zero.obj", obj_text() + "f 0 1 2\n", "refers to vertex 0"),
        ("back.obj", obj_text() + "f -9 1 2\n", "refers to vertex -9"),
        ("word.obj", obj_text() + "f a b c\n", "'a' names no vertex"),
        ("short.obj", obj_text() + "v 1 2\n", "expected 3 coordinates"),
        ("inf.obj", obj_text() + "v 1 2 inf\n", r"vertex 4 is at \(1.0, 2.0, inf\)"),
        ("curved.obj", obj_text() + "surf 0 1 0 1 1 2 3 4\n", "free-form"),
        ("empty.obj", "", "neither vertices nor faces: is it a mesh"),
        ("ply.stl", ply_text(good_ply_rows()), "begins as a .ply file, but is named .stl: rename it"),
        ("ply.obj", ply_text(good_ply_rows()), "begins as a .ply file, but is named .obj: rename it"),
        ("stl.obj", stl_text(FACES), "begins as a .stl file, but is named .obj: rename it"),
        ("stl.ply", stl_text(FACES), "begins as a .stl file, but is named .ply: rename it"),
        ("mesh.off", "OFF", "the ending is '.off', expected .ply, .stl or .obj"),
        ("mesh", "OFF", "has no ending, expected .ply, .stl or .obj"),
    ],
)
def test_a_broken_file_is_refused_with_its_defect(
    tmp_path: Path, name: str, content: bytes | str, message: str
) -> None:
    with pytest.raises(MeshFileError, match=message) as refusal:
        read(tmp_path, name, content)
    assert name in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("binary.ply", TRUNCATED + struct.pack("<B3i", 3, 0, 1, 3) * 3),
        ("ascii.ply", ply_text(good_ply_rows())),
        ("binary.stl", stl_bytes(FACES)),
        ("text.stl", stl_text(FACES).encode()),
        ("plain.obj", obj_text().encode()),
    ],
)
def test_a_damaged_file_is_read_or_refused_but_never_worse(tmp_path: Path, name: str, content: bytes) -> None:
    random = np.random.default_rng(20)
    for _ in range(400):
        damaged = bytearray(content)
        for _ in range(random.integers(1, 4)):
            place = int(random.integers(len(damaged)))
            match random.integers(3):
                case 0:
                    damaged[place] = int(random.integers(256))
                case 1:
                    del damaged[place : place + int(random.integers(1, 9))]
                case _:
                    damaged[place:place] = damaged[: int(random.integers(1, 9))]
        try:
            vertices, faces = read(tmp_path, name, bytes(damaged))
        except MeshFileError:
            continue
        assert np.isfinite(vertices).all()
        assert 0 <= faces.min() <= faces.max() < len(vertices)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshFileError, match=r"nowhere\.ply: No such file"):
        qr.read_mesh(tmp_path / "nowhere.ply", unit="m")


def test_a_folder_is_no_mesh_file(tmp_path: Path) -> None:
    (tmp_path / "mesh.ply").mkdir()
    for folder in (tmp_path, tmp_path / "mesh.ply"):
        with pytest.raises(MeshFileError, match=f"{folder}: is a folder, expected a .ply, .stl or .obj file"):
            qr.read_mesh(folder, unit="m")


def test_a_refused_surface_names_its_file(tmp_path: Path) -> None:
    path = tmp_path / "doubled.ply"
    path.write_bytes(ply_text([*good_ply_rows(), "3 0 2 1"], faces=5))
    with pytest.raises(qr.SurfaceError, match=r"doubled\.ply: "):
        qr.read_surface(path, unit="m")
    with pytest.raises(qr.ObstacleError, match=r"doubled\.ply: "):
        qr.read_obstacle(path, unit="m")


@pytest.mark.parametrize("order", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_a_cloud_of_points_has_no_faces(tmp_path: Path, order: str) -> None:
    rows = (
        b"0 0 0\n1 0 0\n"
        if order == "ascii"
        else struct.pack(f"{'<>'[order.endswith('big_endian')]}6f", *range(6))
    )
    (tmp_path / "cloud.ply").write_bytes(PLY_HEADER.format(order=order, vertices=2, faces=0).encode() + rows)
    with pytest.raises(MeshFileError, match=r"cloud\.ply: has 2 vertices but no faces"):
        qr.read_mesh(tmp_path / "cloud.ply", unit="m")


@pytest.mark.parametrize("count", [str(2**40), "9" * 18, "9" * 5000, "\u00b2", "-1"])
def test_a_header_that_promises_more_than_the_file_holds_is_refused_at_once(
    tmp_path: Path, count: str
) -> None:
    for order in ("ascii", "binary_little_endian"):
        header = PLY_HEADER.format(order=order, vertices=count, faces=1)
        (tmp_path / "vast.ply").write_bytes(header.encode("latin-1") + b"0 0 0\n" * 4)
        with pytest.raises(MeshFileError, match=r"vast\.ply: (ends in vertex|line 4 of the header)"):
            qr.read_mesh(tmp_path / "vast.ply", unit="m")


@pytest.mark.parametrize("length", [0, 5, 33, 34, 83])
def test_an_stl_file_shorter_than_its_header_is_refused(tmp_path: Path, length: int) -> None:
    (tmp_path / "short.stl").write_bytes(b"\x01" * length)
    with pytest.raises(MeshFileError, match=f"short.stl: is {length} bytes long, too short"):
        qr.read_mesh(tmp_path / "short.stl", unit="m")


def test_a_signalling_nan_is_refused_without_a_warning_of_numpy(tmp_path: Path) -> None:
    row = np.zeros(50, np.uint8)
    row[12:48] = np.arange(9, dtype="<f4").view(np.uint8)
    row[20:24] = np.frombuffer(b"\x01\x00\x81\x7f", np.uint8)
    data = bytes(80) + np.array(1, "<u4").tobytes() + row.tobytes()
    (tmp_path / "signal.stl").write_bytes(data)
    with pytest.raises(MeshFileError, match=r"signal\.stl: vertex \d is at .*nan"):
        qr.read_mesh(tmp_path / "signal.stl", unit="m")


@pytest.mark.parametrize(
    "corners",
    [
        [(1, 3), (2, 0), (3, 2), (3, 0), (0, 3), (0, 2)],
        # Its one ear leaves a triangle that faces away.
        [(0, 0), (4, 0), (4, 3), (1, -0.25)],
    ],
)
def test_a_face_that_crosses_itself_is_refused(tmp_path: Path, corners: list[tuple[float, float]]) -> None:
    count, path = len(corners), tmp_path / "bow.obj"
    face = " ".join(str(at + 1) for at in range(count))
    path.write_text("".join(f"v {x} {y} 0\n" for x, y in corners) + f"f {face}\n")
    with pytest.raises(qr.MeshFileError, match=f"face 0 has {count} corners and crosses itself"):
        qr.read_surface(path, unit="m")
