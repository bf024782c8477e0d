"""Summaries and tables of contacts: mm, N, kPa, and what is not known."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import quasirigid as qr
from edge_press import pressed_as_given, pressed_by_edge
from quasirigid.contact.warned import Warned
from quasirigid.io import (
    compare_contacts,
    contact_record,
    contact_summary,
    patch_table,
    refinement_table,
)
from quasirigid.io.record import mean_pressure
from shapes import AS_GIVEN, PLATE, SKIN, ball, grid


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
    record = json.loads((folder / "contact.json").read_text())
    assert record["depth"] == {"value": pressed.depth, "unit": "m"}
    assert record["travel"] == {"value": pressed.travel, "unit": "m"}
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


def test_warnings_and_advice_of_several_say_whose_they_are(apart: qr.Contact, unsolved: qr.Contact) -> None:
    warned = dataclasses.replace(apart, warnings=(Warned(qr.SizeWarning, "of one"),))
    both = dataclasses.replace(unsolved, warnings=(Warned(qr.SizeWarning, "of two"), *warned.warnings))
    lines = compare_contacts({"a": warned, "b": both}).splitlines()
    told = [line for line in lines if "warning: " in line or "advice: " in line]
    expected = {
        "a, b: warning: SizeWarning: of one",
        "b: warning: SizeWarning: of two",
        f"b: advice: {unsolved.advice}",
    }
    assert set(told) == expected
    assert len(told) == len(expected)
    assert "warning: SizeWarning: of one" in compare_contacts({"a": warned}).splitlines()


def test_no_contacts_are_named() -> None:
    with pytest.raises(qr.ContactError, match="contacts is empty, expected at least one"):
        compare_contacts({})


def test_a_contact_is_compared_under_a_word(apart: qr.Contact) -> None:
    with pytest.raises(TypeError, match="a contact is named 5, expected a str"):
        compare_contacts({5: apart})  # type: ignore[dict-item]


def test_a_notebook_gets_the_summary_as_a_table(unsolved: qr.Contact) -> None:
    text = unsolved._repr_html_()
    rows = ElementTree.fromstring(f"<all>{text}</all>").findall(".//tr")
    assert [rows[0][0].text, rows[0][1].text] == ["status", str(unsolved.status)]
    assert len(rows) == len([line for line in contact_summary(unsolved).splitlines() if "  " in line])


def test_a_record_is_ready_for_json(apart: qr.Contact) -> None:
    json.dumps(contact_record(apart), allow_nan=False)


def test_a_mean_within_the_cell_of_the_peak_is_no_mean() -> None:
    x, y, z = (ball(1.0, 4)[0] - [0, 0, 1]).T
    # Larger cells at the lowest vertex than around it.
    angle = np.pi * (np.arccos(np.clip(-z, -1, 1)) / np.pi) ** 0.8
    around = np.arctan2(y, x)
    vertices = 8e-3 * np.stack(
        [np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), -np.cos(angle)], axis=1
    )
    surface = qr.Surface(vertices, ball(1.0, 4)[1])
    contact = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=1e-3, options=AS_GIVEN)
    cell = surface.vertex_areas[np.argmax(contact.pressure)]
    assert contact.contact_area / len(contact.active) < 0.9 * cell
    assert contact.mean_pressure(0.95 * cell) == pytest.approx(contact.max_pressure, rel=0.01)
    assert mean_pressure(contact, 0.95 * cell) is None
    assert mean_pressure(contact, 4 * cell) == contact.mean_pressure(4 * cell) < contact.max_pressure
