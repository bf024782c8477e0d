"""Presses whose obstacle turns to its balance."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from numpy.typing import NDArray
from shapes import AS_GIVEN, SKIN, ball
from shared_meshes import hand_file

UP = np.array([0.0, 0.0, 1.0])
POINT = np.array([0.0, 0.0, -0.02])
PLATE = qr.Obstacle.half_space(POINT, UP)
ARM = 0.03
RADIUS = 8e-3
HEIGHTS = [0.0, 0.5e-3, 1e-3]


def places() -> NDArray[np.float64]:
    """Three places around the origin, ARM away."""
    angle = 2 * np.pi / 3 * np.arange(3)
    return ARM * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)


def balls(heights: list[float], radii: list[float] | None = None) -> qr.Surface:
    """Three balls whose lowest points lie at the places, at some heights."""
    meshes = [ball(radius, 3) for radius in radii or [RADIUS] * 3]
    vertices = [
        mesh[0] - [0, 0, mesh[0][:, 2].min()] + place + height * UP
        for mesh, place, height in zip(meshes, places(), heights, strict=True)
    ]
    first = np.cumsum([0] + [len(one) for one in vertices[:-1]])
    faces = [mesh[1] + start for mesh, start in zip(meshes, first, strict=True)]
    return qr.Surface(np.concatenate(vertices), np.concatenate(faces))


def tilted(surface: qr.Surface, **given: Any) -> qr.Contact:
    """The plate's press upwards, which turns about the point unless told otherwise."""
    settings = {"balance": "tilt", "tilt_point": POINT, "options": AS_GIVEN} | given
    return qr.press(surface, PLATE, SKIN, UP, **settings)


def normal(contact: qr.Contact) -> NDArray[np.float64]:
    """Normal of the plate where it stands."""
    found: NDArray[np.float64] = contact.obstacle.signed_distance(np.zeros((1, 3)))[2][0]
    return found


def moment(contact: qr.Contact, point: NDArray[np.float64] = POINT) -> tuple[NDArray[np.float64], float]:
    """Moment about the point where it stands (N m), and force times lever."""
    moved = point + contact.travel * UP
    lever = np.linalg.norm(contact.surface.vertices[contact.active] - moved, axis=1).max()
    return contact.moment - np.cross(moved, contact.force), float(np.linalg.norm(contact.force) * lever)


@pytest.mark.parametrize("options", [AS_GIVEN, None], ids=["as given", "refined"])
@pytest.mark.parametrize(("goal", "value"), [("depth", 2.5e-3), ("force", 3.0), ("overlap", 1e-3)])
def test_a_plate_settles_on_three_balls_of_unequal_height(
    goal: str, value: float, options: qr.ContactOptions | None
) -> None:
    contact = tilted(balls(HEIGHTS), options=options, **{goal: value})
    left, scale = moment(contact)
    assert np.abs(left[:2]).max() < 1e-6 * scale
    found = {
        "depth": contact.depth,
        "force": contact.force[2],
        "overlap": contact.max_penetration_before,
    }
    assert found[goal] == pytest.approx(value, rel=1e-6)
    assert contact.warnings == ()

    loads = np.array([patch.force[2] for patch in contact.patches])
    assert loads.shape == (3,)
    # The arms are equal but for the way of the contacts on the balls, RADIUS times the slope.
    top = places() + np.outer(HEIGHTS, UP)
    across = np.cross(top[1] - top[0], top[2] - top[0])
    across /= np.linalg.norm(across)
    slope = math.hypot(*across[:2]) / across[2]
    np.testing.assert_allclose(loads, loads.mean(), rtol=2 * RADIUS * slope / ARM)
    # The plate lies on equal balls, but for what unequal loads press in: the depth rises with the power 2/3.
    uneven = np.ptp(loads) / loads.mean() * 2 / 3 * contact.max_penetration_before
    assert np.linalg.norm(normal(contact) - across) < 1.2 * uneven / ARM


@pytest.mark.parametrize("options", [AS_GIVEN, None], ids=["as given", "refined"])
def test_a_symmetric_press_keeps_its_pose(options: qr.ContactOptions | None) -> None:
    surface = balls([0.0, 0.0, 0.0])
    turned = tilted(surface, depth=1e-3, options=options)
    np.testing.assert_allclose(normal(turned), UP, atol=1e-12)
    plain = qr.press(surface, PLATE, SKIN, UP, depth=1e-3, options=options)
    np.testing.assert_allclose(turned.force, plain.force, rtol=0, atol=1e-9 * plain.force[2])
    assert turned.travel == plain.travel


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_light_plate_settles_on_an_open_hand_that_its_mesh_feels_by_jumps() -> None:
    hand = qr.read_surface(hand_file("makehuman_male_right_13k"), unit="m")
    hand = hand.with_skin_mask(qr.skin_without_caps(hand))
    plate = qr.Obstacle.half_space([0.0, 0.0, -0.3], [0, 0, 1])
    about = np.array([0.0, 0.11, -0.3])
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=qr.HalfSpace())
    contact = qr.press(hand, plate, skin, [0, 0, 1], force=0.05, balance="tilt", tilt_point=about)
    assert contact.force[2] == pytest.approx(0.05, rel=1e-6)
    left, scale = moment(contact, about)
    assert np.linalg.norm(left[:2]) <= 1e-6 * scale


def test_a_plate_sinks_deeper_into_the_softer_ball() -> None:
    contact = tilted(balls([0.0] * 3, [RADIUS, RADIUS, RADIUS / 2]), force=3.0)
    left, scale = moment(contact)
    assert np.abs(left[:2]).max() < 1e-6 * scale
    # The plate rises towards the small ball, whose depth is 2^(1/3) times the others' (Hertz).
    assert normal(contact) @ places()[2] < 0.0


def test_one_axis_leaves_the_moment_about_the_other() -> None:
    contact = tilted(balls(HEIGHTS), force=3.0, tilt_axes=np.array([[0.0, 5.0, 0.0]]), options=None)
    left, scale = moment(contact)
    assert abs(left[1]) < 1e-6 * scale < 1e-2 * abs(left[0])
    assert normal(contact)[1] == pytest.approx(0.0, abs=1e-12)


def test_the_balance_does_not_depend_on_which_two_axes_are_given() -> None:
    slanted = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
    contacts = [
        tilted(balls(HEIGHTS), force=3.0, balance=qr.Balance.TILT, tilt_axes=axes) for axes in (None, slanted)
    ]
    # Forces to 1e-6 of the largest, and an angle that the arm turns to as much of the depth.
    np.testing.assert_allclose(contacts[0].force, contacts[1].force, atol=1e-5 * 3.0)
    np.testing.assert_allclose(normal(contacts[0]), normal(contacts[1]), atol=1e-5 * 1e-3 / ARM * 10)


def test_a_tilt_may_begin_where_the_obstacle_stands() -> None:
    surface = balls(HEIGHTS)
    from_afar, from_here = (tilted(surface, force=3.0, start=start) for start in qr.Start)
    assert from_here.travel == pytest.approx(from_afar.travel, rel=1e-6)
    assert from_here.depth == from_here.travel


@pytest.mark.parametrize(("goal", "value"), [("depth", 2.5e-3), ("force", 3.0)])
def test_a_plate_held_beside_everything_finds_no_balance(goal: str, value: float) -> None:
    beside = np.array([0.06, 0.0, -0.02])
    with pytest.raises(qr.ContactError, match="finds no balance about") as raised:
        tilted(balls(HEIGHTS), tilt_point=beside, **{goal: value})
    contact = raised.value.contact
    assert contact is not None
    left, scale = moment(contact, beside)
    assert np.linalg.norm(left[:2]) > 1e-2 * scale
    told = re.search(r"a moment of (\S+) N m is left .* under (\S+) N along", str(raised.value))
    assert told is not None
    figures = [np.linalg.norm(left[:2]), contact.force @ UP]
    np.testing.assert_allclose(list(map(float, told.groups())), figures, rtol=1e-6)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"balance": "tilt"}, "needs `tilt_point`"),
        ({"tilt_point": POINT}, 'go with `balance="tilt"`'),
        ({"balance": "turn"}, "balance is 'turn', expected one of"),
        ({"balance": "tilt", "tilt_point": [0, 0]}, "tilt_point.*shape"),
        ({"balance": "tilt", "tilt_point": [0, math.nan, 0]}, "tilt_point is .*, expected three finite"),
        ({"balance": "tilt", "tilt_point": POINT, "tilt_axes": [1, 0, 0]}, "tilt_axes.*shape"),
        ({"balance": "tilt", "tilt_point": POINT, "tilt_axes": np.eye(3)}, "tilt_axes has 3 rows"),
        (
            {"balance": "tilt", "tilt_point": POINT, "tilt_axes": [[0, 0, 0]]},
            "axis 0 of `tilt_axes` is .* cannot",
        ),
        ({"balance": "tilt", "tilt_point": POINT, "tilt_axes": [[1, 0, 0], [-2, 0, 0]]}, "are parallel"),
    ],
)
def test_what_a_tilt_cannot_be_is_named(given: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        qr.press(balls(HEIGHTS), PLATE, SKIN, UP, depth=1e-3, **given)  # type: ignore[arg-type]
