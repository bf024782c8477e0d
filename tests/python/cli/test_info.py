"""`quasirigid info`: size, defects and units of a mesh."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")
pytest.importorskip("matplotlib")

import quasirigid as qr
from quasirigid.cli import run

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")


def test_info_names_the_defect_of_an_open_product(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (in_demo_folder / "open.obj").write_text("v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n")
    assert run(["info", "open.obj", "--unit", "mm"]) == 0
    printed = capsys.readouterr().out
    assert "size (mm)" in printed
    assert "9 x 9 x 0" in printed
    with pytest.raises(qr.ObstacleError) as refusal:
        qr.Obstacle.mesh(*qr.read_mesh("open.obj", unit="mm"))
    rows = dict(re.split("  +", line) for line in printed.splitlines()[1:])
    assert (rows["as skin"], rows["as product"]) == ("yes", "no")
    assert rows["why no product"] == str(refusal.value)
    assert all(line == line.rstrip() for line in printed.splitlines())


def test_info_as_json_is_in_si_with_units(in_demo_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (in_demo_folder / "sheet.obj").write_text("v 0 0 0\nv 9 0 0\nv 0 8 0\nf 1 2 3\n")
    assert run(["info", "sheet.obj", "--unit", "mm", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["size"] == {"value": pytest.approx([9e-3, 8e-3, 0.0]), "unit": "m"}
    assert record["area"] == {"value": pytest.approx(36e-6), "unit": "m^2"}
    assert record["volume"] == {"value": None, "unit": "m^3"}
    assert (record["closed"], record["as_skin"], record["as_product"]) == (False, True, False)
    assert record["why_no_skin"] is None
    assert "open" in record["why_no_product"]


def test_files_in_inches_and_centimetres_are_read(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for unit in ("inch", "cm"):
        tip = qr.models.fingertip(edge_length=3e-3)
        qr.io.write_mesh(tip.vertices, tip.faces, "tip.stl", unit=unit)
        assert run(["info", "tip.stl", "--unit", unit]) == 0
        assert "x 30 x" in capsys.readouterr().out


@pytest.mark.filterwarnings("always::quasirigid.QuasirigidWarning")
def test_the_size_of_a_mesh_in_another_unit_is_told(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["info", "demo-output/handle.stl", "--unit", "mm"]) == 0
    assert capsys.readouterr().err == ""
    assert run(["info", "demo-output/handle.stl", "--unit", "m"]) == 0
    assert "the mesh is 110000 mm long, outside the 1 to 3000 mm of products" in capsys.readouterr().err
