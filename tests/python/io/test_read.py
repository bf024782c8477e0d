"""Mesh files: read as stored."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from mesh_files import FACES, PLY_HEADER, POINTS, good_ply_rows, obj_text, ply_text, read, stl_bytes, stl_text
from quasirigid.errors import MeshFileError
from quasirigid.io import LengthUnit, write_mesh
from shared_meshes import DATA, MISSING


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


@pytest.mark.parametrize("unit", [np.zeros(3), [], None, 10**400])
def test_a_unit_that_is_no_word_is_named(unit: Any) -> None:
    with pytest.raises(MeshFileError, match=r"unit is .*, expected 'm'"):
        qr.read_mesh("any.ply", unit=unit)


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


@pytest.mark.parametrize("far", [0.0, 1e7])
def test_a_face_that_bends_inwards_is_cut_far_from_the_origin_too(tmp_path: Path, far: float) -> None:
    # An arrow head of powers of two, which are not rounded there; a fan from its first corner would fold.
    outline = np.array([(0, 0), (2, 1), (0, 2), (1, 1)]) * 2.0**-7
    path = tmp_path / "far.obj"
    for axis in range(3):
        points = far + np.roll(np.column_stack([outline, np.zeros(4)]), axis, axis=1)
        path.write_text("".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()) + "f 1 2 3 4\n")
        vertices, faces = qr.read_mesh(path, unit="m")
        a, b, c = vertices[faces].swapaxes(0, 1)
        assert np.cross(b - a, c - a)[:, axis - 1].tolist() == [2.0**-14, 2.0**-14]


def turned(rows: list[int], start: int) -> str:
    """The line of a face from another of its corners."""
    return "f " + " ".join(str(corner + 1) for corner in rows[start:] + rows[:start]) + "\n"


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize("cuts", [(1, 0, 0), (2, 1, 0), (3, 2, 2)])
def test_corners_in_line_leave_no_triangle_without_area(
    tmp_path: Path, cuts: tuple[int, int, int], turn: float
) -> None:
    # A prism over a right triangle, whose upper edges have further corners, which their side faces share.
    ends = np.array([(0, 0, 1), (1, 0, 1), (0, 1, 1)], dtype=float)
    points = [np.array(point, dtype=float) for point in ((0, 0, 0), (1, 0, 0), (0, 1, 0))]
    edges = []
    for at, count in enumerate(cuts):
        edges.append(list(range(len(points), len(points) + count + 1)))
        points += [ends[at] + (ends[at - 2] - ends[at]) * k / (count + 1) for k in range(count + 1)]
    sides = [[at, (at + 1) % 3, edges[(at + 1) % 3][0], *edges[at][::-1]] for at in range(3)]
    axes = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(turn), -np.sin(turn)], [0.0, np.sin(turn), np.cos(turn)]])
    lines = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in (np.array(points) @ axes.T).tolist()]
    top = [corner for edge in edges for corner in edge]
    path = tmp_path / "prism.obj"
    for start in range(len(top)):
        faces = [[0, 2, 1], top, *sides]
        path.write_text("".join(lines + [turned(face, start % len(face)) for face in faces]))
        surface = qr.read_surface(path, unit="m")
        assert surface.is_closed
        assert surface.volume == pytest.approx(0.5, rel=1e-12)
        assert surface.area == pytest.approx(3.0 + np.sqrt(2.0), rel=1e-12)
        assert len(surface.faces) == 8 + 2 * sum(cuts)


def test_a_real_solid_with_corners_in_line_is_sound(shared_files: list[Path]) -> None:
    path = next(path for path in shared_files if path.name == "trimesh_wallhole.obj")
    product = qr.read_obstacle(path, unit="m").triangles()
    assert product is not None
    surface = qr.Surface(*product)
    assert surface.is_closed
    # As its planar faces enclose it, however they are cut: so that collection's own list has it.
    assert surface.volume == pytest.approx(1066.6666666667)


def test_a_byte_order_mark_is_no_part_of_the_first_word(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    path = tmp_path / "marked.obj"
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    np.testing.assert_array_equal(qr.read_surface(path, unit="m").vertices[0], [0, 0, 0])
