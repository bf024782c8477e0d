"""Presses to a force and to an overlap."""

from __future__ import annotations

import pickle
import warnings
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, SKIN, ball
from shared_meshes import hand_file

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")

MATERIAL = {"shear_modulus": 60e3, "poisson_ratio": 0.5}
UP = [0.0, 0.0, 1.0]
PLATE = qr.Obstacle.half_space([0.0, 0.0, -0.05], UP)
TARGET = 0.02


@pytest.fixture(scope="module")
def body(fingertip: qr.Surface) -> qr.PreparedSkin:
    """The fingertip with its bone, prepared where the lowest 6 mm may touch."""
    height = fingertip.vertices[:, 2] - fingertip.vertices[:, 2].min()
    response = qr.Body(bone=qr.models.bone_of(fingertip), fixed=~fingertip.skin_mask)
    skin = qr.Skin(**MATERIAL, response=response)
    return skin.prepared(fingertip, np.flatnonzero(fingertip.skin_mask & (height < 6e-3)))


@pytest.mark.filterwarnings("ignore:the contact reaches:quasirigid.QuasirigidWarning")
@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
@pytest.mark.parametrize("force", [0.1, 1.0, 5.0, 20.0])
def test_the_depth_of_a_force_gives_it_back_on_a_body(
    force: float, fingertip: qr.Surface, body: qr.PreparedSkin
) -> None:
    given = qr.press(fingertip, PLATE, body, UP, force=force, options=AS_GIVEN)
    assert given.force[2] == pytest.approx(force, rel=1e-6)
    again = qr.press(fingertip, PLATE, body, UP, depth=given.depth, options=AS_GIVEN)
    np.testing.assert_array_equal(again.node_force, given.node_force)

    refined = qr.press(fingertip, PLATE, body, UP, force=force)
    assert refined.force[2] == pytest.approx(force, rel=1e-6)
    assert refined.refinements[-1].reason == "target_error"
    np.testing.assert_array_equal(refined.refinements[-1].force, refined.force)
    assert refined.accuracy.mesh_error is not None
    assert refined.accuracy.mesh_error <= TARGET
    again = qr.press(fingertip, PLATE, body, UP, depth=refined.depth)
    assert again.force[2] == pytest.approx(force, rel=2 * TARGET)


def test_the_stages_take_the_time_of_all_meshes(fingertip: qr.Surface) -> None:
    ball = qr.Obstacle.sphere([0.0, 0.02, -0.05], 5e-3)

    def share_in_stages() -> float:
        contact = qr.press(fingertip, ball, SKIN, UP, depth=1e-3)
        meshes = [one.seconds for one in contact.refinements if one.kind == "mesh"]
        assert len(meshes) > 2
        return sum(contact.timings.values()) / sum(meshes)

    # Of the first and the last mesh alone it is less than half; a busy machine may stop between stages.
    assert max(share_in_stages() for _ in range(3)) > 0.9


def test_the_overlap_asked_for_is_the_penetration_before(fingertip: qr.Surface) -> None:
    contact = qr.press(fingertip, PLATE, SKIN, UP, overlap=1.12e-3, options=AS_GIVEN)
    assert contact.max_penetration_before == pytest.approx(1.12e-3, rel=1e-6)


def test_a_contact_knows_its_depth(fingertip: qr.Surface, apart: qr.Contact) -> None:
    contact = qr.press(fingertip, PLATE, SKIN, UP, depth=0.3e-3)
    assert contact.depth == 0.3e-3
    assert apart.depth is None
    assert pickle.loads(pickle.dumps(contact)).depth == 0.3e-3
    here = qr.press(fingertip, PLATE, SKIN, UP, force=1.0, start="current")
    assert here.depth == here.travel


@pytest.mark.parametrize("name", ["force", "overlap"])
def test_a_goal_that_is_not_above_zero_is_named(name: str, fingertip: qr.Surface) -> None:
    asked: dict[str, Any] = {name: 0.0}
    with pytest.raises(qr.ContactError, match=f"{name} is .*, expected a finite {name} > 0"):
        qr.press(fingertip, PLATE, SKIN, UP, **asked)


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize(("goal", "words"), [("force", "a force of .* N"), ("overlap", "an overlap of .* m")])
def test_a_goal_out_of_reach_is_named_with_its_article(goal: str, words: str) -> None:
    surface, small = qr.Surface(*ball(8e-3, 2)), qr.Obstacle.sphere([0.0, 0.0, -0.05], 1e-3)
    for value in (1e3, 1e300):
        asked: dict[str, Any] = {goal: value}
        message = f"^{words} is not reached: the largest {goal} found is"
        with pytest.raises(qr.ContactError, match=message) as raised:
            qr.press(surface, small, SKIN, UP, options=AS_GIVEN, **asked)
        assert f" of {'1000' if value == 1e3 else '1e300'} " in str(raised.value)


def test_none_or_several_goals_are_named(fingertip: qr.Surface) -> None:
    with pytest.raises(qr.ContactError, match="given: none of them"):
        qr.press(fingertip, PLATE, SKIN, UP)
    with pytest.raises(qr.ContactError, match="given: depth and force"):
        qr.press(fingertip, PLATE, SKIN, UP, depth=1e-3, force=1.0)


# Deep inside, its far side is the closest.
@pytest.mark.filterwarnings(
    "ignore:the obstacle's normal points out of the skin:quasirigid.QuasirigidWarning"
)
@pytest.mark.filterwarnings("ignore:.*went through a wall:quasirigid.QuasirigidWarning")
@pytest.mark.filterwarnings("ignore::quasirigid.DepthWarning")
def test_a_force_out_of_reach_carries_the_largest_contact() -> None:
    # A ball of 1 mm that passes through the skin of one of 8 mm.
    surface = qr.Surface(*ball(8e-3, 2))
    small = qr.Obstacle.sphere([0.0, 0.0, -0.05], 1e-3)
    for throw in (True, False):
        with pytest.raises(qr.ContactError, match="is not reached") as raised:
            qr.press(surface, small, SKIN, UP, force=1e3, options=AS_GIVEN, throw=throw)
        contact = raised.value.contact
        assert contact is not None
        assert contact.status == "solved"
        assert 0.0 < contact.force[2] < 1e3
        again = qr.press(surface, small, SKIN, UP, depth=contact.depth, options=AS_GIVEN)
        np.testing.assert_array_equal(again.force, contact.force)


def test_a_bad_ending_on_the_way_is_out_of_reach(fingertip: qr.Surface) -> None:
    response = qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3)
    with pytest.warns(qr.QuasirigidWarning, match="not well posed"):
        skin = qr.Skin(**MATERIAL, response=response)
    with pytest.raises(qr.ContactError, match="deeper it does not end solved: ray") as raised:
        qr.press(fingertip, PLATE, skin, UP, force=50.0)
    contact = raised.value.contact
    assert contact is not None
    assert contact.status == "solved"
    assert 0.0 < contact.force[2] < 50.0


@pytest.mark.parametrize(("degrees", "force"), [(0.0, 1.0), (0.573, 0.2)])
def test_a_force_on_a_flat_end_is_that_of_the_depth_found(degrees: float, force: float) -> None:
    # The search ends at several times the area that its first mesh was refined for, or at a fraction of it.
    finger = qr.models.finger(edge_length=2.2e-3)
    up = np.array([0.0, np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    plate = qr.Obstacle.half_space(-0.1 * up, up)
    with warnings.catch_warnings():
        # The end is a sharp edge of the skin, and coarse.
        warnings.simplefilter("ignore", qr.QuasirigidWarning)
        found = qr.press(finger, plate, SKIN, [0, 1, 0], force=force)
        assert found.depth is not None
        back = qr.press(finger, plate, SKIN, [0, 1, 0], depth=found.depth)
    assert back.force[1] == pytest.approx(force, rel=0.01)


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize("force", [0.05, 0.1])
def test_a_force_that_the_given_mesh_jumps_over_is_found_on_a_finer_one(force: float) -> None:
    # The mesh is four times as coarse as the pin is broad: it feels nothing of it, and then a vertex.
    skin = qr.models.fingertip()
    pin = qr.Obstacle.cylinder(0.02, 0.3e-3).moved(np.eye(3), [0.0, 0.019, -0.1])
    with pytest.raises(qr.ContactError, match="is not reached"):
        qr.press(skin, pin, SKIN, UP, force=force, options=AS_GIVEN)
    contact = qr.press(skin, pin, SKIN, UP, force=force)
    assert contact.force[2] == pytest.approx(force, rel=1e-6)
    # Sneddon: F = 8 G a d, as the pin is a flat punch much smaller than the skin is round.
    assert contact.depth == pytest.approx(force / (8 * 60e3 * 0.3e-3), rel=0.03)


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize(
    ("response", "force", "options"),
    [
        (qr.HalfSpace(), 20.0, AS_GIVEN),
        (qr.HalfSpace(discretization="galerkin"), 6.0, qr.ContactOptions(max_nodes=600)),
    ],
)
def test_a_force_that_jumps_on_a_scan_deep_over_a_ball_is_refused(
    response: qr.Response, force: float, options: qr.ContactOptions
) -> None:
    # On refined parts of this skin vertices of the border are pinched.
    skin = qr.read_surface(hand_file("libhand_right_middle_1500"), unit="m")
    skin = skin.with_skin_mask(qr.skin_without_caps(skin))
    middle = skin.vertices[skin.skin_mask].mean(axis=0)
    product = qr.Obstacle.sphere(middle - [0.0, 0.0, 0.2], 5e-3)
    material = qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=response)
    with pytest.raises(qr.ContactError, match="is not reached") as caught:
        qr.press(skin, product, material, UP, force=force, options=options)
    reached = caught.value.contact
    assert reached is not None
    assert abs(reached.force[2] / force - 1.0) > 0.01
