"""What a contact is saved to: complete, in SI, each file whole or not there; and its tables."""

from __future__ import annotations

import base64
import dataclasses
import json
import re
import sys
import warnings
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.io import (
    compare_contacts,
    contact_record,
    contact_summary,
    patch_table,
    refinement_table,
    save_contact,
    write_mesh,
)
from quasirigid.io.atomic import atomic_write
from shapes import AS_GIVEN, ball, grid

FILES = ["contact.json", "contact.npz", "deformed.ply", "deformed.vtp"]


@pytest.fixture(scope="module")
def folder(pressed: qr.Contact, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the pressed fingertip is saved to."""
    folder = tmp_path_factory.mktemp("saved")
    inputs = {"depth": {"value": np.float64(1.12e-3), "unit": "m"}, "file": Path("finger.ply")}
    save_contact(pressed, folder, inputs=inputs)
    return folder


@pytest.fixture(scope="module")
def on_edge() -> qr.Contact:
    """A ball pressed by an edge of a box."""
    return pressed_by_edge(qr.HalfSpace(), depth=1e-3)


def pressed_by_edge(response: qr.HalfSpace, depth: float) -> qr.Contact:
    """Press a ball as it is by an edge between the vertices of its pad."""
    turn, half = 2.79, np.sqrt(0.5)
    up_edge = np.array([[1, 0, 0], [0, half, -half], [0, half, half]])
    about_z = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    edge = qr.Obstacle.box([0.02, 0.02, 0.02]).moved(about_z @ up_edge, [7e-5, 4.1e-4, -0.06])
    return pressed_as_given(qr.Surface(*ball(8e-3, 2)), edge, response, depth)


def pressed_as_given(
    surface: qr.Surface, obstacle: qr.Obstacle, response: qr.HalfSpace, depth: float
) -> qr.Contact:
    """Press on the mesh as it is, with no word of how coarse it is."""
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", qr.QuasirigidWarning)
        return qr.press(surface, obstacle, skin, [0, 0, 1], depth=depth, options=AS_GIVEN)


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


def test_a_file_in_the_place_of_the_folder_is_refused(pressed: qr.Contact, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(NotADirectoryError, match="is a file"):
        save_contact(pressed, tmp_path / "out")
    assert (tmp_path / "out").read_text() == "a file"


def test_meshes_are_written_as_ply_or_stl_only(tmp_path: Path) -> None:
    with pytest.raises(qr.MeshFileError, match=r"expected \.ply or \.stl"):
        write_mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]), tmp_path / "mesh.obj", unit="m")


def test_a_summary_has_the_figures_in_mm_n_and_kpa(pressed: qr.Contact) -> None:
    lines = contact_summary(pressed).splitlines()
    rows = dict(line.split("  ", 1) for line in lines if "  " in line)
    rows = {name: value.strip() for name, value in rows.items()}
    assert rows["status"] == "solved"
    figures = {
        "force": (np.linalg.norm(pressed.force), "N", pressed.accuracy.force_error),
        "contact area": (1e6 * pressed.contact_area, "mm²", pressed.accuracy.area_error),
        "peak pressure": (1e-3 * pressed.max_pressure, "kPa", pressed.accuracy.max_pressure_error),
    }
    for name, (value, unit, error) in figures.items():
        number, found, sign, percent, percent_sign = rows[name].split()
        assert (found, sign, percent_sign) == (unit, "±", "%")
        assert float(number) == pytest.approx(value, rel=1e-3)
        # One digit of an estimate is enough.
        assert error is not None
        assert float(percent) == pytest.approx(100 * error, rel=0.5)
    assert rows["force vector"].split(", ")[:2] == ["0", "0"]
    assert float(rows["overlap before"].removesuffix(" mm")) == pytest.approx(1.12, rel=1e-3)
    assert rows["rounds of refinement"] == f"{len(pressed.refinements) - 1}, target_error"
    assert sum(line.startswith("left out: ") for line in lines) == len(pressed.left_out) > 0


@pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")
def test_a_summary_tells_no_mean_over_less_than_a_cell() -> None:
    tip = qr.models.fingertip(edge_length=2.5e-3)
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    plate = qr.Obstacle.half_space([0, 0, -1], [0, 0, 1])
    as_given = qr.ContactOptions(target_error=None)
    contact = qr.press(tip, plate, skin, [0, 0, 1], depth=0.5e-3, options=as_given)
    assert 1e-6 < contact.contact_area / len(contact.active) < 1e-4
    lines = contact_summary(contact).splitlines()
    (coarse,) = (line for line in lines if line.startswith("mean pressure over 1 mm²"))
    assert coarse.endswith("not resolved: mesh too coarse")
    of_cm, of_mm = contact_record(contact)["mean_pressure"]
    assert of_cm["value"] == contact.mean_pressure(1e-4)
    assert of_mm["value"] is None
    (fine,) = (line for line in lines if line.startswith("mean pressure over 1 cm²"))
    assert fine.endswith(f"{1e-3 * contact.mean_pressure(1e-4):.4g} kPa")


def test_a_table_has_one_line_a_patch(pressed: qr.Contact, apart: qr.Contact) -> None:
    heads, line = patch_table(pressed).splitlines()
    (patch,) = pressed.patches
    names = ["patch", "force (N)", "area (mm²)", "peak (kPa)", "mean over 1 cm² (kPa)", "center (mm)"]
    assert re.split("  +", heads) == names
    figures = [np.linalg.norm(patch.force), 1e6 * patch.contact_area]
    figures += [1e-3 * patch.max_pressure, 1e-3 * patch.mean_pressure]
    cells = re.split("  +", line)
    assert cells[:-1] == ["1", *(f"{figure:.4g}" for figure in figures)]
    np.testing.assert_allclose(
        [float(word) for word in cells[-1].split(", ")], 1e3 * patch.center_of_pressure, rtol=1e-3, atol=1e-9
    )
    assert len(patch_table(apart).splitlines()) == 1


def test_a_summary_tells_an_infinite_error_by_its_cause(on_edge: qr.Contact) -> None:
    # Averages that feel nothing of a graze; a rod that came twice as far in between the vertices as at them.
    unfelt = pressed_by_edge(qr.HalfSpace(discretization="galerkin"), depth=2e-5)
    across = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    rod = qr.Obstacle.cylinder(half_height=5e-3, radius=1e-3).moved(across, [1e-4, 6e-4, -0.01])
    coarse = pressed_as_given(qr.Surface(*grid(20, 2e-3)), rod, qr.HalfSpace(), 0.2e-3)
    assert coarse.max_penetration_after > coarse.max_penetration_before
    expected = {
        "infinite at an edge or a cut": (on_edge, ["peak pressure"]),
        "not known: nothing carries force": (unfelt, ["force", "contact area", "peak pressure"]),
        "not known: mesh too coarse": (coarse, ["force", "contact area", "peak pressure"]),
    }
    for words, (contact, figures) in expected.items():
        lines = [line for line in contact_summary(contact).splitlines() if line.endswith(f", {words}")]
        assert [line.split("  ")[0] for line in lines] == figures
        assert ("not known" in words) == (contact.accuracy.force_error == np.inf)


def test_a_summary_of_a_press_has_its_depth_and_travel(pressed: qr.Contact, folder: Path) -> None:
    lines = contact_summary(pressed).splitlines()
    ways = {name: line.split()[1:] for line in lines for name in ("depth", "travel") if line.startswith(name)}
    assert ways == {"depth": ["1.12", "mm"], "travel": [f"{1e3 * pressed.travel:.4g}", "mm"]}
    assert read_record(folder)["depth"] == {"value": pressed.depth, "unit": "m"}
    assert read_record(folder)["travel"] == {"value": pressed.travel, "unit": "m"}
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    here = qr.solve_contact(pressed.surface, pressed.obstacle, skin, options=AS_GIVEN)
    assert contact_summary(here).splitlines()[1].startswith("force")


def test_a_summary_of_a_bad_ending_says_what_to_try(unsolved: qr.Contact) -> None:
    assert contact_summary(unsolved).splitlines()[-1] == f"advice: {unsolved.advice}"


def test_a_summary_without_estimates_has_the_bare_figures(apart: qr.Contact) -> None:
    lines = contact_summary(apart).splitlines()
    assert lines[1].split() == ["force", "0", "N"]
    assert not any("±" in line for line in lines)


def test_the_rounds_of_refinement_are_a_line_each(pressed: qr.Contact) -> None:
    heads, *lines = refinement_table(pressed).splitlines()
    assert heads.split("  ")[0] == "mesh"
    assert len(lines) == len(pressed.refinements) > 1
    last = lines[-1].split()
    assert last[:3] == ["round", str(len(lines) - 1), str(len(pressed.candidates))]
    assert float(last[3]) == pytest.approx(pressed.force[2], rel=1e-3)


def test_contacts_are_compared_column_by_column(pressed: qr.Contact, apart: qr.Contact) -> None:
    lines = compare_contacts({"pressed": pressed, "apart": apart}).splitlines()
    assert lines[0].split() == ["pressed", "apart"]
    assert lines[1].split() == ["status", "solved", "no_contact"]
    # What both left out is noted once.
    notes = [line for line in lines if line.startswith("left out: ")]
    assert len(notes) == len(set(notes))


def test_a_notebook_gets_the_summary_as_a_table(unsolved: qr.Contact) -> None:
    text = unsolved._repr_html_()
    rows = ElementTree.fromstring(f"<all>{text}</all>").findall(".//tr")
    assert [rows[0][0].text, rows[0][1].text] == ["status", str(unsolved.status)]
    assert len(rows) == len([line for line in contact_summary(unsolved).splitlines() if "  " in line])


def test_a_record_is_ready_for_json(apart: qr.Contact) -> None:
    json.dumps(contact_record(apart), allow_nan=False)
