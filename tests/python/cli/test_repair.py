"""`quasirigid repair`: changes are counted, what cannot be mended is told."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")

import quasirigid as qr
from quasirigid.cli import run
from shapes import ball

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")


def test_a_repaired_mesh_does_not_replace_the_broken_one(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (folder / "tip.ply").read_bytes()
    assert run(["repair", "tip.ply", "--unit", "m", "--out", str(folder / "tip.ply")]) == 2
    assert "tip.ply is read as MESH and would be replaced: name another file" in capsys.readouterr().err
    assert (folder / "tip.ply").read_bytes() == before


def test_a_mesh_is_repaired_and_the_changes_are_counted(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    vertices, faces = ball(8.0, 1)
    # Every triangle by itself, one of them turned inside out.
    loose = np.arange(3 * len(faces)).reshape(-1, 3)
    loose[0] = loose[0, ::-1]
    lines = [f"v {x} {y} {z}" for x, y, z in vertices[faces].reshape(-1, 3)]
    (folder / "soup.obj").write_text(
        "\n".join([*lines, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in loose)])
    )
    asked = ["repair", "soup.obj", "--unit", "mm", "--weld-tolerance", "1um"]
    assert run([*asked, "--out", "ball.ply"]) == 0
    printed = capsys.readouterr().out
    assert "flipped_faces 1" in printed
    assert "wrote ball.ply" in printed
    mended = qr.read_surface("ball.ply", unit="mm")
    assert mended.is_closed
    assert mended.volume == pytest.approx(qr.Surface(vertices * 1e-3, faces).volume)
    assert run([*asked, "--out", "ball.ply", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["changes"]["flipped_faces"] == 1
    assert record["as_product"] is True
    assert record["volume"] == {"value": pytest.approx(mended.volume), "unit": "m^3"}
    assert run([*asked, "--out", "ball.glb"]) == 2
    assert "expected .ply or .stl" in capsys.readouterr().err


def test_an_open_seam_is_told_with_the_option_that_welds_it(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    vertices, faces = ball(8.0, 1)
    # One corner of one face is a vertex of its own, 1 um beside.
    vertices = np.vstack([vertices, vertices[faces[0, 0]] + [1e-3, 0.0, 0.0]])
    faces[0, 0] = len(vertices) - 1
    qr.io.write_mesh(vertices * 1e-3, faces, "seam.ply", unit="mm")
    assert run(["info", "seam.ply", "--unit", "mm"]) == 2
    advised = capsys.readouterr().out.split("call `repair` with ")[1].split()[:2]
    assert advised[0] == "--weld-tolerance"
    assert run(["repair", "seam.ply", "--unit", "mm", "--out", "ball.ply", *advised]) == 0
    assert qr.read_surface("ball.ply", unit="mm").is_closed


def test_a_mesh_that_is_of_no_use_once_repaired_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Three triangles about one edge: which way each faces, nobody knows.
    fan = ["v 0 0 0", "v 9 0 0", "v 0 9 0", "v 0 -9 0", "v 0 0 9", "f 1 2 3", "f 1 2 4", "f 1 2 5"]
    (folder / "fan.obj").write_text("\n".join(fan))
    assert run(["repair", "fan.obj", "--unit", "mm", "--out", "fan.ply"]) == 2
    assert "fan" in capsys.readouterr().err


def test_a_mesh_that_cannot_be_repaired_is_told_by_its_file(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # A strip of five triangles with half a turn.
    corners = [f"v {x} {y} 0" for x, y in ((0, 0), (9, 0), (4, 8), (4, 2), (6, 5))]
    strip = [f"f {1 + at} {1 + (at + 1) % 5} {1 + (at + 2) % 5}" for at in range(5)]
    (folder / "strip.obj").write_text("\n".join(corners + strip))
    assert run(["repair", "strip.obj", "--unit", "mm", "--out", "mended.ply"]) == 2
    assert capsys.readouterr().err.startswith("error: strip.obj: ")
    collapse = ["--out", "mended.ply", "--weld-tolerance", "100mm"]
    assert run(["repair", "handle.stl", "--unit", "mm", *collapse]) == 2
    assert capsys.readouterr().err.startswith("error: handle.stl: repair leaves no face")
    assert not (folder / "mended.ply").exists()


def test_crossing_faces_of_an_open_mesh_are_counted_on_demand(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # A level square, and an upright one through its first triangle.
    corners = ["0 0 0", "9 0 0", "9 9 0", "0 9 0", "3 2 -4", "6 2.2 -4", "6 2.2 4", "3 2 4"]
    lines = [*(f"v {corner}" for corner in corners), "f 1 2 3", "f 1 3 4", "f 5 6 7", "f 5 7 8"]
    (folder / "cross.obj").write_text("\n".join(lines))
    assert run(["info", "cross.obj", "--unit", "mm"]) == 0
    assert "crossing faces" not in capsys.readouterr().out
    assert run(["info", "cross.obj", "--unit", "mm", "--check-crossings"]) == 0
    (row,) = (line for line in capsys.readouterr().out.splitlines() if "crossing faces" in line)
    assert row.split() == ["crossing", "faces", "2", "pairs,", "the", "first", "0", "and", "2"]
    assert run(["info", "tip.ply", "--unit", "m", "--check-crossings"]) == 0
    assert "0 pairs" in capsys.readouterr().out


def test_a_mesh_far_from_the_origin_is_not_written_as_stl(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tip = qr.read_surface("tip.ply", unit="m")
    qr.io.write_mesh(tip.vertices + 1e6, tip.faces, "far.ply", unit="m")
    assert run(["repair", "far.ply", "--unit", "m", "--out", "far.stl"]) == 2
    assert "would lose its shape as float32" in capsys.readouterr().err
    assert not Path("far.stl").exists()
    assert run(["repair", "far.ply", "--unit", "m", "--out", "whole.ply"]) == 0
