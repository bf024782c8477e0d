"""Files that a contact is written to: complete, in SI, and whole or not there."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.io import write


def vtp_arrays(path: Path) -> dict[str, np.ndarray]:
    """Arrays of a VTP file with inline binary data, as VTK's format has them."""
    root = ElementTree.parse(path).getroot()
    assert root.attrib == {
        "type": "PolyData",
        "version": "1.0",
        "byte_order": "LittleEndian",
        "header_type": "UInt64",
    }
    arrays = {}
    for element in root.iter("DataArray"):
        raw = base64.b64decode(element.text or "")
        assert int.from_bytes(raw[:8], "little") == len(raw) - 8
        kind = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}[element.attrib["type"]]
        values = np.frombuffer(raw[8:], kind)
        width = int(element.attrib.get("NumberOfComponents", "1"))
        arrays[element.attrib["Name"]] = values.reshape(-1, width) if width > 1 else values
    return arrays


def test_the_ply_carries_pressure_and_displacement_at_each_vertex(
    pressed: qr.Contact, tmp_path: Path
) -> None:
    path = tmp_path / "deformed.ply"
    write.write_ply(pressed, path)
    vertices, faces = qr.read_mesh(path, unit="m")
    assert np.array_equal(vertices, pressed.deformed.vertices)
    assert np.array_equal(faces, pressed.deformed.faces)
    data = path.read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    rows = np.frombuffer(data, "<f8", 7 * len(vertices), start).reshape(-1, 7)
    assert np.array_equal(rows[:, 3], pressed.pressure)
    assert np.array_equal(rows[:, 4:], pressed.displacement)
    assert b"comment units: x y z m, pressure Pa, displacement m\n" in data


def test_the_vtp_holds_the_mesh_and_every_vertex_array(pressed: qr.Contact, tmp_path: Path) -> None:
    path = tmp_path / "deformed.vtp"
    write.write_vtp(pressed, path)
    arrays = vtp_arrays(path)
    assert np.array_equal(arrays["points"], pressed.deformed.vertices)
    assert np.array_equal(arrays["connectivity"].reshape(-1, 3), pressed.deformed.faces)
    assert np.array_equal(arrays["offsets"], 3 * np.arange(1, len(pressed.deformed.faces) + 1))
    for name in ("pressure", "node_force", "displacement"):
        assert np.array_equal(arrays[name], getattr(pressed, name))
    known = np.isfinite(pressed.gap)
    assert np.array_equal(arrays["gap"][known], pressed.gap[known])
    assert np.isnan(arrays["gap"][~known]).all()
    assert np.array_equal(np.flatnonzero(arrays["active"]), pressed.active)


def test_the_archive_holds_every_array(pressed: qr.Contact, tmp_path: Path) -> None:
    write.write_npz(pressed, tmp_path / "contact.npz")
    with np.load(tmp_path / "contact.npz") as archive:
        assert np.array_equal(archive["vertices"], pressed.deformed.vertices)
        for name in (
            "pressure",
            "node_force",
            "gap",
            "displacement",
            "candidates",
            "active",
            "force",
            "moment",
        ):
            assert np.array_equal(archive[name], getattr(pressed, name)), name


def test_the_json_has_every_scalar_with_its_unit(pressed: qr.Contact, tmp_path: Path) -> None:
    write.write_json(pressed, tmp_path / "contact.json", inputs={"depth": {"value": 1.12e-3, "unit": "m"}})
    document = json.loads((tmp_path / "contact.json").read_text())
    assert document["status"] == "solved"
    assert document["force"] == {"value": pressed.force.tolist(), "unit": "N"}
    assert document["contact_area"] == {"value": pressed.contact_area, "unit": "m^2"}
    assert document["max_pressure"] == {"value": pressed.max_pressure, "unit": "Pa"}
    assert document["accuracy"]["natural_residual"]["unit"] == "1"
    assert document["timings"].keys() == pressed.timings.keys()
    assert [(entry["what"], entry["why"]) for entry in document["left_out"]] == list(pressed.left_out)
    assert document["inputs"]["depth"]["value"] == 1.12e-3
    assert len(document["patches"]) == len(pressed.patches) == 1


def test_numbers_that_are_not_finite_are_null(apart: qr.Contact, tmp_path: Path) -> None:
    write.write_json(apart, tmp_path / "contact.json")
    document = json.loads((tmp_path / "contact.json").read_text(), parse_constant=pytest.fail)
    assert document["status"] == "no_contact"
    assert document["center_of_pressure"]["value"] == [None, None, None]


def test_a_contact_without_result_is_written_with_its_reason(unsolved: qr.Contact, tmp_path: Path) -> None:
    write.write_contact(unsolved, tmp_path / "out", pictures=False)
    document = json.loads((tmp_path / "out" / "contact.json").read_text())
    assert document["status"] == unsolved.status
    assert document["advice"]
    assert document["contact_area"]["value"] is None


def test_a_folder_is_written_whole(pressed: qr.Contact, tmp_path: Path) -> None:
    files = write.write_contact(pressed, tmp_path / "deep" / "out", pictures=False)
    assert sorted(path.name for path in files) == [
        "contact.json",
        "contact.npz",
        "deformed.ply",
        "deformed.vtp",
    ]
    assert sorted(files) == sorted((tmp_path / "deep" / "out").iterdir())
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["out"]


def test_files_of_others_stay_in_a_folder_that_is_there(pressed: qr.Contact, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "contact.json").write_text("old")
    write.write_contact(pressed, tmp_path, pictures=False)
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert json.loads((tmp_path / "contact.json").read_text())["status"] == "solved"


def test_nothing_is_left_behind_when_writing_fails(
    pressed: qr.Contact, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full_disk(*_: Any, **__: Any) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(write, "write_json", full_disk)
    with pytest.raises(OSError, match="no space left"):
        write.write_contact(pressed, tmp_path / "out", pictures=False)
    assert list(tmp_path.iterdir()) == []


def test_a_file_in_the_place_of_the_folder_is_refused(pressed: qr.Contact, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(NotADirectoryError, match="is a file"):
        write.write_contact(pressed, tmp_path / "out")
    assert (tmp_path / "out").read_text() == "a file"


def test_meshes_are_written_as_ply_or_stl_only(tmp_path: Path) -> None:
    with pytest.raises(qr.MeshFileError, match=r"expected \.ply or \.stl"):
        write.write_mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]), tmp_path / "mesh.obj", unit="m")
