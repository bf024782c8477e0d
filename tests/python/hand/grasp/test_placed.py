"""Products laid across the palm, and where their mass is."""

import copy
import pickle

import numpy as np
import pytest
import quasirigid as qr
from handles import ENDS, RADIUS, skin
from shapes import AS_GIVEN

# Meshes as coarse as these leave penetration between their vertices, and say so.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")


def check_touches(palm, product):
    way = -np.array(palm)[:3, 2]
    for start in ("infinity", "current"):
        contact = qr.press(palm.surface, product, skin(), way, depth=0.0, start=start, options=AS_GIVEN)
        assert contact.travel == pytest.approx(0.0, abs=1e-12)


def test_a_product_is_laid_across_the_palm_in_touch(hand):
    palm = hand.posed("flat").palm
    rod = qr.Obstacle.cylinder(half_height=0.06, radius=0.01).placed(palm)
    inwards = np.array(palm[:3, :3]).T @ rod.rotation[:, 2]
    np.testing.assert_allclose(np.abs(inwards), [1.0, 0.0, 0.0], atol=1e-12)
    check_touches(palm, rod)
    # Turned as it lies, it comes down onto the palm all the same, with its center of mass over the origin.
    for turn in (
        np.diag([1.0, -1.0, -1.0]),
        [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
        [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
    ):
        turned = rod.placed(palm, rotation=turn)
        axes = np.array(palm[:3, :3])
        np.testing.assert_allclose(turned.rotation, axes @ turn @ axes.T @ rod.rotation, atol=1e-9)
        over = axes.T @ (turned.center_of_mass - palm[:3, 3])
        np.testing.assert_allclose(over[:2], 0.0, atol=1e-12)
        assert over[2] > 0.0
        check_touches(palm, turned)
    # Its edge meets the skin between vertices.
    check_touches(palm, qr.Obstacle.box([0.04, 0.02, 0.004]).placed(palm))
    # A frame without a skin: on its plane.
    flat = qr.Obstacle.box([0.01, 0.03, 0.02]).placed(np.eye(4))
    np.testing.assert_allclose(flat.bounding_box, [[-0.03, -0.02, 0.0], [0.03, 0.02, 0.02]], atol=1e-12)
    with pytest.raises(qr.ObstacleError, match="half-space"):
        qr.Obstacle.half_space([0, 0, 0], [0, 0, 1]).placed(palm)
    with pytest.raises(qr.ContactError, match="never meets the skin"):
        rod.placed(np.eye(4), qr.Surface(hand.surface.vertices + 9.0, hand.surface.faces))


@pytest.mark.parametrize(
    "copied",
    [lambda palm: palm.copy(), copy.copy, copy.deepcopy, lambda palm: pickle.loads(pickle.dumps(palm))],
)
def test_a_copy_of_a_palm_lays_a_product_as_the_palm_does(hand, copied):
    palm = hand.posed("relaxed").palm
    frame = copied(palm)
    rod = qr.Obstacle.capsule(*ENDS, RADIUS)
    np.testing.assert_array_equal(rod.placed(frame).translation, rod.placed(palm).translation)
    # It is a frame of its own, and keeps its skin where it is changed.
    frame[:3, 3] += 1e-3
    frame += 0.0
    assert frame.surface is not None
    np.testing.assert_allclose(frame[:3, 3] - palm[:3, 3], 1e-3, atol=1e-15)


@pytest.mark.parametrize(
    "part",
    [lambda palm: palm[:3, 2], lambda palm: np.eye(4) @ palm, np.linalg.inv, lambda palm: next(iter(palm))],
)
def test_parts_of_a_palm_and_what_is_computed_of_it_are_plain_arrays(hand, part):
    assert type(part(hand.posed("relaxed").palm)) is np.ndarray


@pytest.mark.parametrize(
    "solid",
    [
        qr.Obstacle.sphere([0.1, 0.2, 0.3], 0.02),
        qr.Obstacle.capsule([0.0, 0.0, 0.0], [0.2, 0.4, 0.6], 0.1),
        qr.Obstacle.box([0.1, 0.1, 0.1]).moved(translation=[0.1, 0.2, 0.3]),
    ],
)
def test_a_center_of_mass_is_the_middle_of_what_is_symmetric(solid):
    np.testing.assert_allclose(solid.center_of_mass, [0.1, 0.2, 0.3], atol=1e-15)


def test_the_center_of_mass_of_a_cone_is_a_quarter_up():
    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(60)])
    vertices = np.vstack([rim, [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]]]) + np.array([3.0, 0.0, 0.0])
    turn = np.arange(60)
    after = np.roll(turn, -1)
    base = np.column_stack([after, turn, np.full(60, 60)])
    side = np.column_stack([turn, after, np.full(60, 61)])
    cone = qr.Obstacle.mesh(vertices, np.vstack([base, side]))
    np.testing.assert_allclose(cone.center_of_mass, [3.0, 0.0, 0.5], atol=1e-12)
