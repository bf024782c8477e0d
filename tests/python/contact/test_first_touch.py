"""What meets the skin first, from afar or between its vertices, and is not let through."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, SKIN, ball, grid


@pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")
@pytest.mark.parametrize("away", [0.1, 1.0, 10.0, 1000.0])
def test_a_small_ball_from_afar_touches_where_a_near_one_does(fingertip: qr.Surface, away: float) -> None:
    x, y, z = fingertip.vertices[fingertip.vertices[:, 2].argmin()]
    near, far = (
        qr.press(
            fingertip,
            qr.Obstacle.sphere([x, y, z - start], 1e-5),
            SKIN,
            [0, 0, 1],
            depth=5e-6,
            options=AS_GIVEN,
        )
        for start in (1e-3, away)
    )
    # Coordinates are rounded by 1e-16 of the way, a share of the depth.
    share = 1e-15 * (1.0 + away) / 5e-6
    np.testing.assert_allclose(far.force, near.force, rtol=10 * share, atol=10 * share * near.force[2])
    np.testing.assert_allclose(far.travel - away, near.travel - 1e-3, atol=1e-15 * (1 + away))


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_thin_box_from_afar_presses_as_hard(fingertip: qr.Surface) -> None:
    forces = []
    for away in (0.1, 100.0):
        box = qr.Obstacle.box([0.02, 0.02, 1e-4]).moved(np.eye(3), [0, 0, -away])
        forces.append(qr.press(fingertip, box, SKIN, [0, 0, 1], depth=1e-3, options=AS_GIVEN).force[2])
    assert forces[1] == pytest.approx(forces[0], rel=1e-9)


# Poses at which a linearization puts all skin that was inside on the far side of the obstacle.
PASSED_BY = {
    "pin": (
        (2, qr.Obstacle.cylinder(1.51e-3, 1.01e-3), 2.64e-3),
        [[-0.105, -0.317, -0.943], [0.98, 0.128, -0.152], [0.169, -0.94, 0.297]],
        [-6.5e-4, -2.74e-3, -0.05],
    ),
    "disc": (
        (1, qr.Obstacle.cylinder(1.62e-3, 1.09e-3), 2.44e-3),
        [[0.0415, -0.419, 0.907], [0.35, 0.856, 0.38], [-0.936, 0.302, 0.182]],
        [6e-5, 3.1e-3, -0.05],
    ),
    "plate": (
        (1, qr.Obstacle.box([7.88e-3, 8.15e-3, 2.62e-4]), 4.61e-3),
        [[0.443, 0.872, 0.208], [-0.374, -0.0309, 0.927], [0.815, -0.488, 0.313]],
        [1.08e-3, -3.61e-3, -0.05],
    ),
}


@pytest.mark.parametrize("by", [qr.press, qr.solve_contact])
def test_a_ball_between_the_vertices_of_the_skin_is_felt_as_a_mesh_too(by: Any) -> None:
    flat = qr.Surface(*grid(6, 6e-3))
    # Over the middle of a triangle.
    middle = flat.vertices[flat.faces[len(flat.faces) // 2]].mean(axis=0)
    depth = 2e-4
    how = {"direction": [0, 0, -1], "depth": depth} if by is qr.press else {}
    forces = []
    for tip in (qr.Obstacle.mesh(*ball(1.5e-3, 4)), qr.Obstacle.sphere([0, 0, 1.5e-3], 1.5e-3)):
        placed = tip.moved(translation=middle - [0, 0, depth])
        contact = by(flat, placed, SKIN, **how)
        assert contact.status == "solved"
        forces.append(contact.force[2])
        apart = qr.solve_contact(flat, placed.moved(translation=[0, 0, 2 * depth]), SKIN, options=AS_GIVEN)
        assert (apart.status, apart.max_penetration_after, apart.warnings) == ("no_contact", 0.0, ())
    # Its facets lie within the ball by up to 1 % of the depth.
    assert forces[0] == pytest.approx(forces[1], rel=0.03)


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize(("scene", "turn", "place"), PASSED_BY.values(), ids=PASSED_BY.keys())
def test_skin_that_was_inside_is_not_let_through(
    scene: tuple[int, qr.Obstacle, float], turn: list[list[float]], place: list[float]
) -> None:
    subdivisions, obstacle, depth = scene
    left, _, right = np.linalg.svd(turn)
    obstacle = obstacle.moved(left @ right, place)
    surface = qr.Surface(*ball(8e-3, subdivisions))
    contact = qr.press(surface, obstacle, SKIN, [0, 0, 1], depth=depth, options=AS_GIVEN)
    assert contact.max_penetration_before > 0.0
    assert contact.force[2] > 0.0
    assert contact.candidates.size


def test_a_product_that_slid_past_the_skin_presses_no_more() -> None:
    surface = qr.Surface(*ball(8e-3, 4))
    center = surface.vertices.mean(axis=0)
    # 0.3 mm of overlap at the lowest point.
    start = qr.Obstacle.sphere(center + np.array([-30e-3, 0, -10.7e-3]), 3e-3)
    # Each begins from gaps of its own; they meet where linearizations end.
    options = qr.ContactOptions(gap_tolerance=1e-9, max_linearizations=100)
    grazing = qr.press(surface, start, SKIN, [1, 0, 0], depth=3e-3, options=options)
    there = qr.solve_contact(surface, grazing.obstacle, SKIN, options=options)
    assert grazing.force[2] > 0.05
    assert np.linalg.norm(grazing.force - there.force) < 1e-6 * np.linalg.norm(there.force)
    assert qr.press(surface, start, SKIN, [1, 0, 0], depth=6e-3).status == "no_contact"


@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")  # of skin beside the rim
@pytest.mark.filterwarnings("ignore::quasirigid.RefinementWarning")  # of the area, which ends at a sharp edge
def test_a_flat_face_that_leans_a_little_presses_as_one_that_does_not() -> None:
    rng = np.random.default_rng(1)
    vertices, faces = grid(60, 0.5e-3)
    inner = np.abs(vertices[:, :2]).max(axis=1) < 14.8e-3
    vertices[inner, :2] += rng.uniform(-1e-4, 1e-4, (inner.sum(), 2))
    surface = qr.Surface(vertices, faces)
    radius, depth = 5e-3, 0.2e-3
    punch = qr.Obstacle.cylinder(half_height=20e-3, radius=radius)
    for lean in (0.0, 1e-5, 1e-4):
        turned = np.array([[1, 0, lean], [0, 1, 0], [-lean, 0, 1]]) / np.sqrt([1 + lean**2, 1, 1 + lean**2])
        there = punch.moved(turned, [20e-3 * lean, 0, 20e-3 - depth])
        contact = qr.solve_contact(surface, there, SKIN)
        assert contact.accuracy.force_error is not None
        assert -contact.force[2] == pytest.approx(8 * 60e3 * radius * depth, rel=0.005)
        assert abs(contact.center_of_pressure[0]) < 0.1e-3


# Of the tip, between the vertices.
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
def test_a_blunt_tip_between_the_vertices_of_the_skin_touches_first() -> None:
    # Sneddon (1948): F = 2/pi E* tan(half angle) d^2
    sides, height, half = 100, 1e-3, np.tan(np.radians(89.5))
    around = 2 * np.pi * np.arange(sides) / sides
    rim = np.stack([half * np.cos(around), half * np.sin(around), np.ones(sides)], axis=1)
    corners = np.vstack([[0, 0, 0], height * rim, [0, 0, height]])
    pairs = [(1 + k, 1 + (k + 1) % sides) for k in range(sides)]
    faces = [t for a, b in pairs for t in ([0, b, a], [sides + 1, a, b])]
    cone = qr.Obstacle.mesh(corners, np.array(faces)).moved(None, [0.4e-3, 0.2e-3, 10e-3])
    vertices, flat = grid(30, 1.3e-3)
    depth = 5.8e-3 * np.pi / 2 / half
    contact = qr.press(qr.Surface(vertices, flat), cone, SKIN, [0, 0, -1], depth=depth, options=AS_GIVEN)
    assert contact.travel == pytest.approx(10e-3 + depth, rel=1e-12)


def test_penetration_left_beside_a_sharp_edge_is_told() -> None:
    half, third, sixth = np.sqrt([1 / 2, 1 / 3, 1 / 6])
    on_edge = [[1, 0, 0], [0, half, -half], [0, half, half]]
    on_corner = [[half, -half, 0], [sixth, sixth, -2 * sixth], [third, third, third]]
    shares = []
    for turn in (on_edge, on_corner):
        bar = qr.Obstacle.box([10e-3, 10e-3, 10e-3]).moved(turn, [2e-3, 1e-3, -50e-3])
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            contact = qr.press(qr.models.fingertip(), bar, SKIN, [0, 0, 1], depth=1.2e-3)
        shares.append(contact.max_penetration_after / contact.max_penetration_before)
        texts = [str(one.message) for one in told if one.category is qr.PenetrationWarning]
        assert (shares[-1] > 0.02) == any("still penetrates" in text for text in texts), (shares[-1], texts)
    assert min(shares) <= 0.02 < max(shares)
