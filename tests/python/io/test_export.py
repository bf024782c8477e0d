"""What a contact is saved to: complete, in SI, each file whole or not there."""

from __future__ import annotations

import base64
import dataclasses
import json
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.io import (
    contact_record,
    save_contact,
    write_mesh,
)
from quasirigid.io.atomic import atomic_write

FILES = ["contact.json", "contact.npz", "deformed.ply", "deformed.vtp"]


def read_record(folder: Path) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(
        (folder / "contact.json").read_text(), parse_constant=lambda _: pytest.fail("JSON knows no nan")
    )
    return document


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


def test_the_ply_carries_pressure_and_displacement_at_each_vertex(pressed: qr.Contact, folder: Path) -> None:
    path = folder / "deformed.ply"
    vertices, faces = qr.read_mesh(path, unit="m")
    assert np.array_equal(vertices, pressed.deformed.vertices)
    assert np.array_equal(faces, pressed.deformed.faces)
    data = path.read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    rows = np.frombuffer(data, "<f8", 7 * len(vertices), start).reshape(-1, 7)
    assert np.array_equal(rows[:, 3], pressed.pressure)
    assert np.array_equal(rows[:, 4:], pressed.displacement)
    assert b"comment units: x y z m, pressure Pa, displacement m\n" in data


def test_the_vtp_holds_the_mesh_and_every_vertex_array(pressed: qr.Contact, folder: Path) -> None:
    arrays = vtp_arrays(folder / "deformed.vtp")
    assert np.array_equal(arrays["points"], pressed.deformed.vertices)
    assert np.array_equal(arrays["connectivity"].reshape(-1, 3), pressed.deformed.faces)
    assert np.array_equal(arrays["offsets"], 3 * np.arange(1, len(pressed.deformed.faces) + 1))
    for name in ("pressure", "node_force", "displacement"):
        assert np.array_equal(arrays[name], getattr(pressed, name))
    assert np.array_equal(arrays["force"], pressed.force_vectors)
    known = np.isfinite(pressed.gap)
    assert np.array_equal(arrays["gap"][known], pressed.gap[known])
    assert np.isnan(arrays["gap"][~known]).all()
    assert arrays["given_vertex_count"] == pressed.given_vertex_count
    assert np.array_equal(arrays["parents"], pressed.parents)
    assert np.array_equal(np.flatnonzero(arrays["active"]), pressed.active)
    assert np.array_equal(np.flatnonzero(arrays["candidate"]), pressed.candidates)


def test_the_archive_holds_every_array(pressed: qr.Contact, folder: Path) -> None:
    with np.load(folder / "contact.npz") as archive:
        assert np.array_equal(archive["vertices"], pressed.deformed.vertices)
        assert np.array_equal(archive["skin_mask"], pressed.deformed.skin_mask)
        names = ["pressure", "node_force", "force_vectors", "gap", "displacement", "candidates", "active"]
        names += ["force", "moment", "center_of_pressure", "given_vertex_count", "parents"]
        for name in names:
            assert np.array_equal(archive[name], getattr(pressed, name)), name


def test_the_json_has_every_scalar_with_its_unit(pressed: qr.Contact, folder: Path) -> None:
    document = read_record(folder)
    assert document["status"] == "solved"
    assert document["force"] == {"value": pressed.force.tolist(), "unit": "N"}
    assert document["contact_area"] == {"value": pressed.contact_area, "unit": "m^2"}
    assert document["max_pressure"] == {"value": pressed.max_pressure, "unit": "Pa"}
    means = [(entry["value"], entry["area"]["value"]) for entry in document["mean_pressure"]]
    assert means == [(pressed.mean_pressure(area), area) for area in (1e-4, 1e-6)]
    assert document["accuracy"]["natural_residual"]["unit"] == "1"
    assert document["accuracy"]["force_error"]["value"] == pressed.accuracy.force_error
    assert document["given_vertex_count"] == pressed.given_vertex_count < document["vertices"]
    for written, one in zip(document["refinements"], pressed.refinements, strict=True):
        assert (written["nodes"], written["reason"]) == (one.nodes, one.reason)
        assert written["force"] == {"value": one.force.tolist(), "unit": "N"}
        assert written["area_error"] == {"value": one.area_error, "unit": "1"}
    assert document["timings"].keys() == pressed.timings.keys()
    assert [(entry["what"], entry["why"]) for entry in document["left_out"]] == list(pressed.left_out)
    assert document["inputs"] == {"depth": {"value": 1.12e-3, "unit": "m"}, "file": "finger.ply"}
    assert len(document["patches"]) == len(pressed.patches) == 1


def test_a_record_in_a_new_folder_says_that_all_is_there(
    pressed: qr.Contact, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = []
    monkeypatch.setattr(Path, "replace", lambda draft, place: written.append(place.name))
    moved = pressed.obstacle.with_material(shear_modulus=1e6, poisson_ratio=0.4)
    save_contact(dataclasses.replace(pressed, obstacle=moved), tmp_path)
    assert written[-1] == "contact.json"
    assert len(written) == len(set(written)) > 3


def test_what_is_not_known_is_null(apart: qr.Contact, tmp_path: Path) -> None:
    save_contact(apart, tmp_path)
    document = read_record(tmp_path)
    assert document["status"] == "no_contact"
    assert document["center_of_pressure"]["value"] == [None, None, None]
    assert document["accuracy"]["force_error"]["value"] is None


def test_words_and_booleans_stand_plain_whether_known_or_not(pressed: qr.Contact) -> None:
    for definite in (True, None):
        accuracy = dataclasses.replace(pressed.accuracy, definite=definite)
        record = contact_record(dataclasses.replace(pressed, accuracy=accuracy))["accuracy"]
        assert (record.pop("discretization"), record.pop("definite")) == ("collocation", definite)
        figures = dataclasses.asdict(accuracy).keys() - {"discretization", "definite"}
        assert record == {name: {"value": getattr(accuracy, name), "unit": "1"} for name in figures}


def test_inputs_that_hold_themselves_are_refused(apart: qr.Contact, tmp_path: Path) -> None:
    endless: dict[str, Any] = {}
    endless["again"] = [endless]
    with pytest.raises(ValueError, match="inputs holds itself"):
        save_contact(apart, tmp_path, inputs=endless)
    assert not list(tmp_path.iterdir())


def test_a_skin_among_the_inputs_is_named_and_holds_no_address(apart: qr.Contact, tmp_path: Path) -> None:
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.Layer(thickness=5e-3))
    save_contact(apart, tmp_path, inputs={"skin": skin})
    record = read_record(tmp_path)["inputs"]["skin"]
    assert (record["type"], record["response"]["type"]) == ("Skin", "Layer")
    assert record["response"]["thickness"] == 5e-3
    assert not [name for name in record if name.startswith("_")]


def test_what_is_infinite_is_a_word_that_reads_as_such(on_edge: qr.Contact, tmp_path: Path) -> None:
    save_contact(on_edge, tmp_path, inputs={"limits": [float("-inf"), float("nan"), np.float64("inf")]})
    document = read_record(tmp_path)
    assert document["inputs"] == {"limits": ["-Infinity", None, "Infinity"]}
    error = document["accuracy"]["max_pressure_error"]
    assert error == {"value": "Infinity", "unit": "1"}
    assert float(error["value"]) == on_edge.accuracy.max_pressure_error


def test_a_contact_without_result_is_written_with_its_reason(unsolved: qr.Contact, tmp_path: Path) -> None:
    save_contact(unsolved, tmp_path / "out")
    document = read_record(tmp_path / "out")
    assert document["status"] == unsolved.status
    assert document["advice"]
    assert document["contact_area"]["value"] is None


# The handle's facets are long and flat, and their edges stand in the skin between its vertices.
@pytest.mark.filterwarnings("ignore:the deformed skin still penetrates:quasirigid.QuasirigidWarning")
def test_the_product_is_written_where_it_stands(fingertip: qr.Surface, tmp_path: Path) -> None:
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    handle = qr.models.cylinder_handle(edge_length=3e-3).moved(turn, [0.0, 0.02, -0.05])
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    contact = qr.press(fingertip, handle, skin, [0.0, 0.0, 1.0], depth=0.5e-3)
    assert tmp_path / "product.ply" in save_contact(contact, tmp_path)
    vertices, faces = qr.read_mesh(tmp_path / "product.ply", unit="m")
    expected = contact.obstacle.triangles()
    assert expected is not None
    assert np.array_equal(vertices, expected[0])
    assert np.array_equal(faces, expected[1])
    # At the end of its way, not at its start.
    assert vertices.mean(axis=0)[2] == pytest.approx(-0.05 + contact.travel)
    product = read_record(tmp_path)["product"]
    assert (product["kind"], product["file"]) == ("mesh", "product.ply")
    assert product["translation"]["value"] == pytest.approx([0.0, 0.02, -0.05 + contact.travel])


def test_a_product_without_triangles_is_left_out_with_a_note(folder: Path) -> None:
    assert not (folder / "product.ply").exists()
    product = read_record(folder)["product"]
    assert product["kind"] == "half_space"
    assert "no triangles" in product["note"]


def test_a_folder_is_made_and_holds_what_is_returned(pressed: qr.Contact, tmp_path: Path) -> None:
    files = save_contact(pressed, tmp_path / "deep" / "out")
    assert sorted(path.name for path in files) == FILES
    assert sorted(files) == sorted((tmp_path / "deep" / "out").iterdir())
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["out"]


def test_files_of_others_stay_in_a_folder_that_is_there(pressed: qr.Contact, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "contact.json").write_text("old")
    save_contact(pressed, tmp_path)
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert read_record(tmp_path)["status"] == "solved"


@pytest.mark.parametrize("record", ["contact.json", "grasp.json"])
def test_a_record_of_an_earlier_result_does_not_outlast_its_files(
    record: str, pressed: qr.Contact, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save_contact(pressed, tmp_path)
    (tmp_path / record).touch()

    def full(path: Path) -> None:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("quasirigid.io.atomic.atomic_write", full)
    with pytest.raises(OSError, match="No space left"):
        save_contact(pressed, tmp_path)
    assert not list(tmp_path.glob("*.json"))


def test_nothing_is_written_where_no_picture_can_be_drawn(
    pressed: qr.Contact, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(qr.MissingExtraError, match=r"pip install 'quasirigid\[plot\]'"):
        save_contact(pressed, tmp_path / "out", pictures=True)
    assert list(tmp_path.iterdir()) == []


def test_a_picture_that_fails_leaves_the_numbers(
    pressed: qr.Contact, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib")

    def fail(*_: object, **__: object) -> None:
        raise ValueError("no picture")

    monkeypatch.setattr("quasirigid.plot.footprint_figure", fail)
    with pytest.raises(ValueError, match="no picture"):
        save_contact(pressed, tmp_path, pictures=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == FILES


def test_a_place_without_its_folder_and_a_folder_are_told_by_their_name(
    pressed: qr.Contact, tmp_path: Path
) -> None:
    vertices, faces = pressed.surface.vertices, pressed.surface.faces
    with pytest.raises(FileNotFoundError, match=r"its folder does not exist: .*/no/mesh\.ply'$"):
        write_mesh(vertices, faces, tmp_path / "no" / "mesh.ply", unit="m")
    (tmp_path / "mesh.ply").mkdir()
    with pytest.raises(IsADirectoryError, match=r"is a folder, expected a file: .*/mesh\.ply'$"):
        write_mesh(vertices, faces, tmp_path / "mesh.ply", unit="m")


def test_a_write_that_fails_leaves_the_old_file_and_no_draft(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("old")

    def write_half() -> None:
        with atomic_write(path) as file:
            file.write(b"half")
            raise OSError("no space left")

    with pytest.raises(OSError, match="no space left"):
        write_half()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
    with atomic_write(path) as file:
        file.write(b"whole")
        assert path.read_text() == "old"
    assert path.read_text() == "whole"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_one_and_its_file_is_written(tmp_path: Path) -> None:
    kept, link = tmp_path / "kept" / "file", tmp_path / "link"
    kept.parent.mkdir()
    link.symlink_to(kept)
    for content in (b"new", b"whole"):
        with atomic_write(link) as file:
            file.write(content)
        assert link.is_symlink()
        assert kept.read_bytes() == content
    assert list(kept.parent.iterdir()) == [kept]
    kept.unlink()
    kept.parent.rmdir()
    with pytest.raises(FileNotFoundError, match=r"its folder does not exist: .*/link'$"), atomic_write(link):
        pass


def test_a_file_in_the_place_of_the_folder_is_refused(pressed: qr.Contact, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(NotADirectoryError, match="is a file"):
        save_contact(pressed, tmp_path / "out")
    assert (tmp_path / "out").read_text() == "a file"


def test_meshes_are_written_as_ply_or_stl_only(tmp_path: Path) -> None:
    with pytest.raises(qr.MeshFileError, match=r"expected \.ply or \.stl"):
        write_mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]), tmp_path / "mesh.obj", unit="m")
