"""Warnings by category: where they are told, kept and written."""

from __future__ import annotations

import json
import pickle
import warnings
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, PLATE, SKIN, ball

CATEGORIES = (
    "SizeWarning",
    "DirectionWarning",
    "DepthWarning",
    "ModulusWarning",
    "CoarseMeshWarning",
    "CutWarning",
    "ResponseRangeWarning",
    "MaskWarning",
    "PenetrationWarning",
    "RefinementWarning",
)

ALONG_X = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], dtype=float)


def pressed(surface: qr.Surface, skin: qr.Skin = SKIN, depth: float = 1e-3, **asked: object) -> qr.Contact:
    return qr.press(surface, PLATE, skin, [0, 0, 1], depth=depth, **asked)  # type: ignore[arg-type]


def pressed_on(product: qr.Obstacle, depth: float) -> qr.Contact:
    return qr.press(qr.Surface(*ball(8e-3, 3)), product, SKIN, [0, 0, 1], depth=depth)


def pad(thickness: float, modulus: float = 60e3, response: qr.Response | None = None) -> qr.Obstacle:
    plate = qr.Obstacle.box([0.03, 0.03, 0.5 * thickness]).moved(translation=[0, 0, -0.05])
    return plate.with_material(shear_modulus=modulus, poisson_ratio=0.5, response=response)


def kernel(response: qr.Response, shear_modulus: float = 60e3) -> qr.Skin:
    return qr.Skin(shear_modulus=shear_modulus, poisson_ratio=0.5, response=response)


def given(scale: float) -> qr.GivenMatrix:
    """Return the half-space of 60 kPa on the lower half of the ball, in another unit."""
    surface = qr.Surface(*ball(8e-3, 3))
    nodes = np.flatnonzero(surface.vertices[:, 2] < surface.vertices[:, 2].mean())
    return qr.GivenMatrix(nodes=nodes, compliance=scale * qr.response_matrix(surface, SKIN, nodes))


def coarse_body() -> qr.Skin:
    vertices, faces = ball(3e-3, 3)
    bone = qr.Surface(vertices + np.array([0, 0, 5e-3]), faces)
    return qr.Skin(
        shear_modulus=60e3, poisson_ratio=0.5, response=qr.Body(bone=bone, coarse_edge_length=3e-3)
    )


def few_may_touch() -> qr.Surface:
    surface = qr.Surface(*ball(8e-3, 3))
    lowest = np.argsort(surface.vertices[:, 2])[:6]
    return surface.with_skin_mask(np.isin(np.arange(len(surface.vertices)), lowest))


def halved() -> qr.Surface:
    surface = qr.Surface(*ball(8e-3, 3))
    return surface.with_skin_mask(surface.vertices[:, 0] > 0)


def huge() -> qr.Surface:
    return qr.Surface(*ball(8.0, 3))


def with_slivers() -> qr.Surface:
    """A ball of which the faces on the plate are cut in three by a point beside one of their edges."""
    vertices, faces = ball(8e-3, 3)
    lowest = np.argsort(vertices[faces, 2].mean(axis=1))[:6]
    a, b, c = faces[lowest].T
    added = len(vertices) + np.arange(len(lowest))
    beside = 0.49 * (vertices[a] + vertices[b]) + 0.02 * vertices[c]
    parts = [np.c_[a, b, added], np.c_[b, c, added], np.c_[c, a, added]]
    return qr.Surface(np.vstack([vertices, beside]), np.vstack([np.delete(faces, lowest, axis=0), *parts]))


def pressed_on_rounded_corner() -> qr.Contact:
    tip = qr.models.fingertip(edge_length=1.6e-3)
    tip = tip.with_skin_mask(qr.skin_without_caps(tip))
    corner = tip.vertices[:, 1].mean() + 0.012
    box = qr.models.rounded_box(size=(0.03, 0.03, 0.009)).moved(translation=[0.013, corner, -0.05])
    averaged = kernel(qr.HalfSpace(discretization="galerkin"))
    return qr.press(tip, box, averaged, [0, 0, 1], depth=0.6e-3)


def pressed_on_caps() -> qr.Contact:
    tip = qr.models.fingertip(edge_length=2.5e-3)
    caps = tip.with_skin_mask(~qr.skin_without_caps(tip))
    return qr.press(caps, PLATE, kernel(qr.HalfSpace()), [0, 0, 1], depth=1e-4, options=AS_GIVEN)


def pressed_on_cut(pitch: float) -> qr.Contact:
    """Press a plate on the cut end of a fingertip, or aslant on its rim."""
    tip = qr.models.fingertip(edge_length=2.5e-3)
    along = np.array([0, np.cos(pitch), np.sin(pitch)])
    plate = qr.Obstacle.half_space(-0.1 * along, along)
    return qr.press(tip, plate, SKIN, along, depth=3e-4, options=AS_GIVEN)


def moved_away(start: Literal["infinity", "current"]) -> qr.Contact:
    """A product above a ball that travels up."""
    product = qr.Obstacle.sphere([0, 0, 0.05], 0.01)
    return qr.press(
        qr.Surface(*ball(8e-3, 3)), product, kernel(qr.HalfSpace()), [0, 0, 1], depth=1e-3, start=start
    )


CASES = {
    "a ball of metres": ("SizeWarning", "1.6000e1 m", lambda: pressed(huge(), depth=0.08)),
    "deeper than broad": (
        "DepthWarning",
        "8.1000e-3 m",
        lambda: pressed(qr.Surface(*ball(8e-3, 3)), depth=8.1e-3),
    ),
    "away from the product": (
        "DirectionWarning",
        "taken back by",
        lambda: moved_away("infinity"),
    ),
    "away from where the product stands": (
        "DirectionWarning",
        "meets the skin nowhere on its way",
        lambda: moved_away("current"),
    ),
    "a modulus in kPa": (
        "ModulusWarning",
        "6.0000e1 Pa",
        lambda: pressed(qr.Surface(*ball(8e-3, 3)), kernel(qr.HalfSpace(), 60.0)),
    ),
    "a ball deeper than its radius": (
        "DepthWarning",
        "steeper than 60 degrees",
        lambda: pressed_on(qr.Obstacle.sphere([0, 0, -0.05], 2e-3), 2.2e-3),
    ),
    "a product's modulus in kPa": (
        "ModulusWarning",
        "product's shear modulus is 6.0000e1 Pa",
        lambda: pressed_on(PLATE.with_material(shear_modulus=60.0, poisson_ratio=0.3), 1e-3),
    ),
    "a compliance in mm/N": (
        "ModulusWarning",
        "is it in another unit? 1 mm/N is 1e-3 m/N",
        lambda: pressed(qr.Surface(*ball(8e-3, 3)), kernel(given(1e3)), options=AS_GIVEN),
    ),
    "a compliance in m/kN": (
        "ModulusWarning",
        "of a half-space of 6",
        lambda: pressed(qr.Surface(*ball(8e-3, 3)), kernel(given(1e-3)), options=AS_GIVEN),
    ),
    "through the layer of a product": (
        "ResponseRangeWarning",
        "half of the 1.0000e-3 m of its layer",
        lambda: pressed_on(
            PLATE.with_material(shear_modulus=2e3, poisson_ratio=0.3, response=qr.Layer(thickness=1e-3)),
            1.2e-3,
        ),
    ),
    "a product thinner than a half-space": (
        "ResponseRangeWarning",
        "the product is 5.0000e-3 m thick",
        lambda: pressed_on(pad(5e-3), 2e-3),
    ),
    "a mesh too coarse": (
        "CoarseMeshWarning",
        "mesh cells",
        lambda: pressed(qr.Surface(*ball(8e-3, 2)), depth=1e-4, options=AS_GIVEN),
    ),
    "slivers": ("CoarseMeshWarning", "6 of the", lambda: pressed(with_slivers())),
    "left by averages": ("PenetrationWarning", "averages over triangles", pressed_on_rounded_corner),
    "a body too coarse": (
        "RefinementWarning",
        "prepare it with `coarse_edge_length=",
        lambda: pressed(
            qr.Surface(*ball(8e-3, 3)), coarse_body(), options=qr.ContactOptions(target_error=0.005)
        ),
    ),
    "on a cut face": ("CutWarning", "qr.skin_without_caps(surface)", lambda: pressed_on_cut(0.0)),
    "on the rim of a cut": ("CutWarning", "% of all", lambda: pressed_on_cut(0.7)),
    "half masked": ("CutWarning", "% of all", lambda: pressed(halved())),
    "through a layer": (
        "ResponseRangeWarning",
        "half of the 3.0000e-3 m",
        lambda: pressed(qr.Surface(*ball(8e-3, 3)), kernel(qr.Layer(thickness=3e-3)), 1.8e-3),
    ),
    "an inverted mask": ("MaskWarning", "6 of 642", lambda: pressed(few_may_touch())),
    "the caps instead of the skin": ("MaskWarning", "may touch", lambda: pressed_on_caps()),
}


@pytest.mark.parametrize(("category", "words", "press"), CASES.values(), ids=CASES.keys())
def test_each_case_is_told_with_its_number_and_kept(category: str, words: str, press: object) -> None:
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        contact = press()  # type: ignore[operator]
    kept = [(one.__name__, message) for one, message in contact.warnings]
    assert [(one.category.__name__, str(one.message)) for one in told] == kept
    assert all(one.filename == __file__ for one in told)
    of_category = [message for name, message in kept if name == category]
    assert len(of_category) == 1
    assert words in of_category[0]


def test_all_categories_are_warnings_of_this_package() -> None:
    for name in CATEGORIES:
        assert name in qr.__all__
        category = getattr(qr, name)
        assert issubclass(category, qr.QuasirigidWarning)
        assert category is not qr.QuasirigidWarning


def test_what_a_filter_hides_is_kept_shown_written_and_pickled(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        contact = pressed(halved(), kernel(qr.HalfSpace(), 60.0))
    assert [one.category for one in contact.warnings] == [qr.ModulusWarning, qr.CutWarning]
    lines = [line for line in contact.summary().splitlines() if line.startswith("warning: ")]
    assert [line.split(": ")[1] for line in lines] == ["ModulusWarning", "CutWarning"]
    assert lines[0].endswith(contact.warnings[0].message)
    contact.save(tmp_path)
    record = json.loads((tmp_path / "contact.json").read_text())
    assert record["warnings"] == [
        {"category": one.category.__name__, "message": one.message} for one in contact.warnings
    ]
    assert pickle.loads(pickle.dumps(contact)).warnings == contact.warnings


def test_one_category_can_be_made_an_error() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", qr.ModulusWarning)
        with pytest.raises(qr.ModulusWarning, match="60e3"):
            pressed(qr.Surface(*ball(8e-3, 3)), kernel(qr.HalfSpace(), 60.0))


def test_an_ordinary_press_is_told_nothing() -> None:
    assert pressed(qr.Surface(*ball(8e-3, 3))).warnings == ()
    assert pressed(qr.Surface(*ball(8e-3, 3)), kernel(given(1.0)), options=AS_GIVEN).warnings == ()
    tip = qr.models.fingertip()
    plate = qr.Obstacle.half_space([0, 0, -0.05], [0, 0, 1])
    for depth in (0.1e-3, 1.12e-3):
        assert qr.press(tip, plate, SKIN, [0, 0, 1], depth=depth).warnings == ()


def test_a_thin_product_is_told_where_its_other_side_would_be_felt() -> None:
    def answer(product: qr.Obstacle) -> tuple[qr.Contact, bool, bool]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            contact = pressed_on(product, 2e-3)
        is_told = any(one.category is qr.ResponseRangeWarning for one in contact.warnings)
        return contact, is_told, "thickness of the product" in dict(contact.left_out)

    thin, *told = answer(pad(5e-3))
    assert told == [True, True]
    backed, *told = answer(pad(5e-3, response=qr.Layer(thickness=5e-3)))
    assert told == [False, False]
    # On something rigid the pad gives way by less than half as much, and without that by half of all.
    share = thin.obstacle_share
    assert share == pytest.approx(0.5, rel=1e-9)
    assert np.linalg.norm(backed.force) > np.linalg.norm(thin.force) / (1 - 0.5 * share)
    # Of thick pads hardly anybody feels the other side, nor of hard ones that they give way.
    for product in (pad(40e-3), pad(5e-3, 10e6)):
        assert answer(product)[1:] == (False, True)


def test_what_the_other_side_of_a_product_costs_is_told_to_the_first_order() -> None:
    with pytest.warns(qr.ResponseRangeWarning, match="2.0000e-2 m thick") as told:
        thin = pressed_on(pad(20e-3), 2e-3)
    backed = pressed_on(pad(20e-3, response=qr.Layer(thickness=20e-3)), 2e-3)
    percent = float(str(told[0].message).split("higher by ")[1].split(" %")[0])
    # 2 phi(0) / pi = 1.127 times the share of 1/2 and the radius over 20 mm, which the second order adds to.
    radius = np.sqrt(thin.contact_area / np.pi)
    assert percent == pytest.approx(100 * 1.127 * 0.5 * radius / 20e-3, abs=0.51)
    rise = 100 * (backed.force[2] / thin.force[2] - 1)
    assert percent < rise < 1.5 * percent


def test_cut_faces_are_looked_for_once_a_skin_and_never_behind_a_mask(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []
    look = qr.skin_without_caps

    def counted(surface: qr.Surface) -> object:
        asked.append(surface)
        return look(surface)

    monkeypatch.setattr("quasirigid.contact.caps.skin_without_caps", counted)
    tip = qr.models.fingertip(edge_length=1.6e-3)
    masked = tip.with_skin_mask(look(tip))
    for surface in (tip, tip, masked):
        assert pressed(surface, options=AS_GIVEN).status == "solved"
    assert asked == [tip]


# A pin four radii deep, where skin slips along its side, and a short roller, whose ends the skin hangs over.
@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize(
    ("product", "depth", "is_told"),
    [
        (qr.Obstacle.capsule([0, 5e-3, -0.1], [0, 5e-3, -0.05], 0.5e-3), 2e-3, True),
        (qr.Obstacle.cylinder(2e-3, 4e-3).moved(ALONG_X, [0, 5e-3, -0.05]), 0.8e-3, False),
    ],
    ids=["pin", "roller"],
)
def test_both_discretizations_tell_where_the_force_acts_off_the_product(
    product: qr.Obstacle, depth: float, is_told: bool
) -> None:
    at_vertices, averaged = (
        qr.press(qr.models.fingertip(), product, kernel(response), [0, 0, 1], depth=depth)
        for response in (qr.HalfSpace(), qr.HalfSpace(discretization="galerkin"))
    )
    for contact in (at_vertices, averaged):
        assert any("off the obstacle in the mean" in one.message for one in contact.warnings) == is_told
    # Each covers what the other says.
    apart = abs(at_vertices.force[2] - averaged.force[2])
    for contact in (at_vertices, averaged):
        assert contact.accuracy.force_error is not None
        assert apart < contact.accuracy.force_error * contact.force[2]
