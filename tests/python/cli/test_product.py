"""A product that gives way or tilts, on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")

from command_words import press_arguments, sweep_arguments
from quasirigid.cli import run
from quasirigid.cli.product import ProductMaterial, parse_material
from quasirigid.cli.quantities import QuantityError

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings(
    "ignore::quasirigid.CoarseMeshWarning", "ignore::quasirigid.PenetrationWarning"
)

SAME_AS_SKIN = {"product_shear_modulus": "60kPa", "product_poisson_ratio": "0.5"}


def test_a_product_of_the_skin_s_tissue_takes_half_of_the_overlap(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(press_arguments(out="soft", target_error="none", **SAME_AS_SKIN)) == 0
    assert "share of the product" in capsys.readouterr().out
    document = json.loads((in_demo_folder / "soft" / "contact.json").read_text())
    # Both have one response at the same nodes: equal up to rounding.
    assert document["obstacle_share"]["value"] == pytest.approx(0.5, abs=1e-9)
    assert document["product"]["material"]["shear_modulus"] == {"value": 60e3, "unit": "Pa"}
    assert document["inputs"]["product_poisson_ratio"] == {"value": 0.5, "unit": "1"}
    assert (in_demo_folder / "soft" / "deformed_product.ply").exists()


def test_a_sweep_takes_a_material_too(in_demo_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--depths", "0.5,1mm", "--target-error", "none", "--json", "--quiet"]
    forces = []
    for material in ([], ["--product-shear-modulus", "60kPa", "--product-poisson-ratio", "0.5"]):
        assert run(sweep_arguments(*words, *material)) == 0
        forces.append(json.loads(capsys.readouterr().out)["columns"]["normal_force (N)"])
    # Twice the compliance at the same overlap; the gaps are taken anew where the skin then is, to 1e-3 of it.
    assert 2.0 * np.array(forces[1]) == pytest.approx(np.array(forces[0]), rel=5e-3)


@pytest.mark.parametrize(
    ("modulus", "ratio", "message"),
    [
        ("1MPa", None, "needs --product-poisson-ratio too"),
        (None, "0.4", "needs --product-shear-modulus too"),
        ("1", "0.4", "--product-shear-modulus: '1' has no unit"),
        ("1MPa", "0.6", "--product-poisson-ratio: 0.6 is not from 0 to 0.5"),
    ],
)
def test_half_a_material_is_refused(modulus: str | None, ratio: str | None, message: str) -> None:
    with pytest.raises(QuantityError, match=message):
        parse_material(modulus, ratio)


def test_without_constants_a_product_is_rigid() -> None:
    assert parse_material(None, None) == ProductMaterial()


@pytest.mark.parametrize("response", ["half-space", "body"])
def test_a_product_tilts_until_the_skin_presses_at_its_point(response: str, in_demo_folder: Path) -> None:
    tilt = {"tilt_point": "0.5,19.2,-40mm", "response": response, "depth": None, "force": "1N"}
    assert run(press_arguments(out="tilted", target_error="none", **tilt)) == 0
    document = json.loads((in_demo_folder / "tilted" / "contact.json").read_text())
    # The point travels with the product.
    point = np.array([0.5e-3, 19.2e-3, -40e-3 + document["travel"]["value"]])
    force, moment = (np.array(document[name]["value"]) for name in ("force", "moment"))
    left = moment - np.cross(point, force)
    # 1e-6 of force times lever, which is no longer than the finger's pad.
    assert np.abs(left[:2]).max() < 1e-6 * 1.0 * 20e-3
    assert document["inputs"]["tilt_point"] == {
        "value": pytest.approx([0.5e-3, 19.2e-3, -40e-3]),
        "unit": "m",
    }


def test_a_product_tilts_about_the_axis_asked_for_alone(in_demo_folder: Path) -> None:
    tilt = {"tilt_point": "0.5,19.7,-40mm", "tilt_axes": "0,1,0", "target_error": "none"}
    assert run(press_arguments(out="tilted", **tilt)) == 0
    document = json.loads((in_demo_folder / "tilted" / "contact.json").read_text())
    point = np.array([0.5e-3, 19.7e-3, -40e-3 + document["travel"]["value"]])
    force, moment = (np.array(document[name]["value"]) for name in ("force", "moment"))
    about_x, about_y = (moment - np.cross(point, force))[:2] / np.linalg.norm(force)
    # Levers (m): 1e-6 of one no longer than the finger's pad, and 0.5 mm from where the demo's handle stands.
    assert abs(about_y) < 1e-6 * 20e-3
    assert abs(about_x) > 1e-4
    assert document["inputs"]["tilt_axes"] == [[0.0, 1.0, 0.0]]


def test_a_product_without_balance_names_the_option(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(press_arguments(out="fell", tilt_point="0,60,-40mm", target_error="none")) == 1
    assert "move --tilt-point between" in capsys.readouterr().err.splitlines()[-1]
    assert json.loads((in_demo_folder / "fell" / "contact.json").read_text())["status"] == "not_reached"
