"""Mesh files: read as stored, or refused with the defect and its place."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.errors import MeshFileError
from quasirigid.io import UNITS, LengthUnit, write_mesh
from shared_meshes import DATA, MISSING

POINTS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]

PLY_HEADER = (
    "ply\nformat {order} 1.0\ncomment unit cube corner\nelement vertex {vertices}\nproperty float x\n"
    "property float y\nproperty float z\nelement face {faces}\nproperty list uchar int vertex_indices\n"
    "end_header\n"
)


def ply_text(rows: list[str], vertices: int = 4, faces: int = 4) -> bytes:
    return (
        PLY_HEADER.format(order="ascii", vertices=vertices, faces=faces) + "\n".join(rows) + "\n"
    ).encode()


def good_ply_rows() -> list[str]:
    return [f"{x} {y} {z}" for x, y, z in POINTS] + [f"3 {a} {b} {c}" for a, b, c in FACES]


def stl_text(faces: list[tuple[int, int, int]]) -> str:
    facets = [
        "  facet normal 0 0 0\n    outer loop\n"
        + "".join("      vertex {} {} {}\n".format(*POINTS[corner]) for corner in face)
        + "    endloop\n  endfacet\n"
        for face in faces
    ]
    return "solid corner of a box\n" + "".join(facets) + "endsolid corner of a box\n"


def stl_bytes(faces: list[tuple[int, int, int]], header: bytes = b"solid or not") -> bytes:
    rows = [
        struct.pack("<12fH", 0, 0, 0, *(x for corner in face for x in POINTS[corner]), 0) for face in faces
    ]
    return header.ljust(80, b"\0") + struct.pack("<I", len(faces)) + b"".join(rows)


def obj_text() -> str:
    lines = ["# a corner", "o corner", *(f"v {x} {y} {z}" for x, y, z in POINTS)]
    return "\n".join([*lines, *(f"f {a + 1}/1 {b + 1}//2 {c + 1}/1/2" for a, b, c in FACES)]) + "\n"


def read(folder: Path, name: str, content: bytes | str) -> tuple[np.ndarray, np.ndarray]:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return qr.read_mesh(path, unit="m")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("ascii.ply", ply_text(good_ply_rows())),
        ("text.stl", stl_text(FACES)),
        ("binary.STL", stl_bytes(FACES)),
        ("plain.obj", obj_text()),
    ],
)
def test_every_format_gives_the_same_tetrahedron(tmp_path: Path, name: str, content: bytes | str) -> None:
    vertices, faces = read(tmp_path, name, content)
    assert vertices.dtype == np.float64
    assert faces.dtype == np.int64
    assert np.array_equal(vertices[faces], np.array(POINTS)[np.array(FACES)])
    assert len(vertices) == 4


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_binary_ply_keeps_order_bits_and_further_properties_apart(tmp_path: Path, order: str) -> None:
    points = np.array(POINTS) + 1.0 / 3.0
    header = (
        f"ply\nformat binary_{'little' if order == '<' else 'big'}_endian 1.0\nobj_info made by a test\n"
        "element vertex 4\nproperty uchar red\nproperty double x\nproperty double y\nproperty double z\n"
        "element edge 1\nproperty list uchar int ends\n"
        "element face 4\nproperty float weight\nproperty list uint8 uint32 vertex_index\nend_header\n"
    )
    body = b"".join(struct.pack(f"{order}B3d", 7, *point) for point in points)
    body += struct.pack(f"{order}B2i", 2, 0, 1)
    body += b"".join(struct.pack(f"{order}fB3I", 0.5, 3, *face) for face in FACES)
    vertices, faces = read(tmp_path, "mesh.ply", header.encode() + body)
    assert np.array_equal(vertices, points)
    assert faces.tolist() == [list(face) for face in FACES]


def test_faces_of_more_corners_become_fans_in_their_place(tmp_path: Path) -> None:
    header = PLY_HEADER.format(order="binary_little_endian", vertices=4, faces=2).encode()
    body = (
        np.array(POINTS, dtype="<f4").tobytes()
        + struct.pack("<B4i", 4, 0, 1, 2, 3)
        + struct.pack("<B3i", 3, 3, 2, 1)
    )
    expected = [[0, 1, 2], [0, 2, 3], [3, 2, 1]]
    assert read(tmp_path, "mixed.ply", header + body)[1].tolist() == expected
    rows = [f"{x} {y} {z}" for x, y, z in POINTS] + ["4 0 1 2 3", "3 3 2 1"]
    assert read(tmp_path, "mixed_ascii.ply", ply_text(rows, faces=2))[1].tolist() == expected
    lines = [f"v {x} {y} {z}" for x, y, z in POINTS] + ["f -4 -3 -2 -1", "f 4 3 \\", "  2"]
    assert read(tmp_path, "mixed.obj", "\n".join(lines))[1].tolist() == expected


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("inch", 25.4e-3)])
def test_every_unit_becomes_metres(tmp_path: Path, unit: LengthUnit, metres: float) -> None:
    path = tmp_path / "mesh.obj"
    path.write_text(obj_text())
    expected = pytest.approx(metres * np.array(POINTS), rel=1e-15)
    assert qr.read_mesh(path, unit=unit)[0] == expected
    assert qr.read_surface(path, unit=unit).vertices == expected
    product = qr.read_obstacle(path, unit=unit).triangles()
    assert product is not None
    assert product[0] == expected


@pytest.mark.parametrize("unit", ["km", "", None, "M"])
def test_an_unknown_unit_is_refused(tmp_path: Path, unit: Any) -> None:
    with pytest.raises(MeshFileError, match="expected 'm', 'cm', 'mm' or 'inch'"):
        qr.read_mesh(tmp_path / "mesh.ply", unit=unit)
    with pytest.raises(MeshFileError, match="expected 'm', 'cm', 'mm' or 'inch'"):
        write_mesh(np.array(POINTS), np.array(FACES), tmp_path / "mesh.ply", unit=unit)


@pytest.mark.parametrize("word", ["верх".encode(), "naïf…".encode("cp1252")])
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("ascii.ply", ply_text(good_ply_rows())),
        (
            "other.ply",
            ply_text(good_ply_rows()).replace(b"end_h", b"element corner 0\nproperty int corner\nend_h"),
        ),
        ("text.stl", stl_text(FACES).encode()),
        ("plain.obj", obj_text().replace("corner\n", "corner f\n").encode()),
    ],
)
def test_names_and_comments_hold_any_letters(tmp_path: Path, name: str, content: bytes, word: bytes) -> None:
    assert word.endswith(b"\x85")  # which ends a line in Latin-1
    vertices, faces = read(tmp_path, name, content.replace(b"corner", word))
    assert np.array_equal(vertices[faces], np.array(POINTS)[np.array(FACES)])


def test_stl_and_obj_join_equal_points_and_nothing_else(tmp_path: Path) -> None:
    nudged = stl_text(FACES).replace("vertex 1.0 0.0 0.0", "vertex 1.0000000001 0.0 0.0", 1)
    assert len(read(tmp_path, "nudged.stl", nudged)[0]) == 5
    assert len(read(tmp_path, "zero.stl", stl_text(FACES).replace("vertex 0.0", "vertex -0.0", 2))[0]) == 4
    twice = obj_text().replace("f 1", "v 1 0 0\nv 9 9 9\nf 1", 1)
    vertices, faces = read(tmp_path, "twice.obj", twice)
    # The doubled point is joined; the point that no face uses stays.
    assert len(vertices) == 5
    assert faces.max() == 3


def test_ply_joins_nothing(tmp_path: Path) -> None:
    rows = [f"{x} {y} {z}" for x, y, z in [*POINTS, POINTS[1]]] + [f"3 {a} {b} {c}" for a, b, c in FACES]
    assert len(read(tmp_path, "mesh.ply", ply_text(rows, vertices=5))[0]) == 5


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


def test_a_refused_surface_names_its_file(tmp_path: Path) -> None:
    path = tmp_path / "doubled.ply"
    path.write_bytes(ply_text([*good_ply_rows(), "3 0 2 1"], faces=5))
    with pytest.raises(qr.SurfaceError, match=r"doubled\.ply: "):
        qr.read_surface(path, unit="m")
    with pytest.raises(qr.ObstacleError, match=r"doubled\.ply: "):
        qr.read_obstacle(path, unit="m")


@pytest.fixture(scope="module")
def shared_files() -> list[Path]:
    files = sorted(path for path in DATA.glob("*/*") if path.suffix in (".ply", ".stl", ".obj"))
    if not files:
        pytest.skip(MISSING)
    return files


def test_real_binary_ply_files_are_read_bit_by_bit(shared_files: list[Path]) -> None:
    for path in shared_files:
        if path.suffix != ".ply" or path.stem in (
            "finger_nan",
            "finger_index_out_of_range",
            "finger_truncated",
        ):
            continue
        data = path.read_bytes()
        end = data.index(b"end_header\n") + len(b"end_header\n")
        header = data[:end].decode()
        count = int(header.split("element vertex ")[1].split()[0])
        raw = np.frombuffer(data, "<f4", 3 * count, end).reshape(-1, 3)
        rows = np.frombuffer(data[end + 12 * count :], np.dtype([("n", "u1"), ("v", "<i4", 3)]))
        vertices, faces = qr.read_mesh(path, unit="m")
        assert np.array_equal(vertices, raw.astype(np.float64)), path
        assert np.array_equal(faces, rows["v"]), path


# Vertices after joining equal points and faces, as that collection's own list has them.
COUNTS = {
    "trimesh_soup.stl": (300, 100),
    "trimesh_shared_edge.stl": (14, 24),
    "trimesh_multibody.stl": (20, 32),
    "trimesh_box_assembly.stl": (4455, 8954),
    "trimesh_wallhole.obj": (35, 66),
    "trimesh_not_convex.obj": (44, 96),
    "gc_fan3.obj": (5, 3),
    "gc_triple_vierbein.obj": (75, 108),
    "gc_moebius.obj": (280, 448),
}


def test_real_stl_and_obj_files_have_the_listed_sizes(shared_files: list[Path]) -> None:
    found = {path.name: path for path in shared_files}
    for name, counts in COUNTS.items():
        vertices, faces = qr.read_mesh(found[name], unit="m")
        assert (len(vertices), len(faces)) == counts, name


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("finger_truncated.ply", "ends in face 1234 of 2988"),
        ("finger_nan.ply", "vertex 397 is at .*nan.*3 such vertices"),
        (
            "finger_index_out_of_range.ply",
            "face 335 refers to vertex 1508, but there are 1496.*5 such faces",
        ),
        ("trimesh_notenoughindices.obj", "line 9 .*2 corners"),
    ],
)
def test_real_broken_files_are_refused(shared_files: list[Path], name: str, message: str) -> None:
    path = next(path for path in shared_files if path.name == name)
    with pytest.raises(MeshFileError, match=message):
        qr.read_mesh(path, unit="m")


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


@pytest.mark.parametrize("unit", [np.zeros(3), [], None, 10**400])
def test_a_unit_that_is_no_word_is_named(unit: Any) -> None:
    with pytest.raises(MeshFileError, match=r"unit is .*, expected 'm'"):
        qr.read_mesh("any.ply", unit=unit)


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


def test_a_face_that_bends_inwards_is_cut_ear_by_ear(tmp_path: Path) -> None:
    # Prisms over outlines of known area; of the second no corner sees all.
    bend = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
    comb = [(0, 0), (5, 0), (5, 3), (4, 3), (4, 1), (3, 1), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
    for outline, area in ((bend, 5.0), (comb, 11.0)):
        count = len(outline)
        points = "".join(f"v {x} {y} {z}\n" for z in (0, 1) for x, y in outline)
        around = [(k + 1, (k + 1) % count + 1) for k in range(count)]
        sides = "".join(f"f {a} {b} {b + count} {a + count}\n" for a, b in around)
        for start in range(count):
            top = [(start + k) % count + count + 1 for k in range(count)]
            bottom = [(start - k) % count + 1 for k in range(count)]
            lids = "".join("f " + " ".join(map(str, lid)) + "\n" for lid in (top, bottom))
            path = tmp_path / f"prism{start}.obj"
            path.write_text(points + sides + lids)
            surface = qr.read_surface(path, unit="m")
            a, b, c = surface.vertices[surface.faces].swapaxes(0, 1)
            height = np.cross(b - a, c - a)[:, 2] / 2
            assert height[height > 0].sum() == pytest.approx(area)
            assert height[height < 0].sum() == pytest.approx(-area)


def test_a_face_that_crosses_itself_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bow.obj"
    path.write_text("v 1 3 0\nv 2 0 0\nv 3 2 0\nv 3 0 0\nv 0 3 0\nv 0 2 0\nf 1 2 3 4 5 6\n")
    with pytest.raises(qr.MeshFileError, match="face 0 has 6 corners and crosses itself"):
        qr.read_surface(path, unit="m")


def test_a_byte_order_mark_is_no_part_of_the_first_word(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    path = tmp_path / "marked.obj"
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    np.testing.assert_array_equal(qr.read_surface(path, unit="m").vertices[0], [0, 0, 0])
