"""The product as Python sees it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import quasirigid as qr
from shapes import ball, tetrahedron


def test_primitives_answer_by_their_formulas() -> None:
    points = np.array([[0.0, 0.0, 3.0], [2.0, 0.0, 0.0]])
    cases = [
        (qr.Obstacle.half_space([0, 0, 1], [0, 0, 5]), [2.0, -1.0]),
        (qr.Obstacle.sphere([0, 0, 0], 1.0), [2.0, 1.0]),
        (qr.Obstacle.box([1, 1, 1]), [2.0, 1.0]),
        (qr.Obstacle.capsule([0, 0, -1], [0, 0, 1], 0.5), [1.5, 1.5]),
        (qr.Obstacle.cylinder(1.0, 0.5), [2.0, 1.5]),
    ]
    for obstacle, expected in cases:
        distance, closest, normal = obstacle.signed_distance(points)
        np.testing.assert_allclose(distance, expected, atol=1e-15)
        np.testing.assert_allclose(closest + distance[:, None] * normal, points, atol=1e-15)


def test_a_mesh_is_near_the_sphere_that_it_approximates() -> None:
    mesh = qr.Obstacle.mesh(*ball(1.0, 4))
    distance, _, normal = mesh.signed_distance([[0, 0, 1.0], [0, 0, 3.0]])
    # The facets lie within 1 - cos(half an edge's angle) of the sphere, about 0.4 % here.
    np.testing.assert_allclose(distance, [-1, 1], atol=4e-3)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, rtol=1e-14)


def test_beyond_the_maximum_distance_nothing_is_known() -> None:
    distance, closest, normal = qr.Obstacle.sphere([0, 0, 0], 1.0).signed_distance(
        [[5, 0, 0]], max_distance=1.0
    )
    assert np.isinf(distance[0])
    assert np.isnan(closest).all()
    assert np.isnan(normal).all()


def test_moving_turns_then_shifts_and_leaves_the_original_alone() -> None:
    rod = qr.Obstacle.capsule([0, 0, 0], [1, 0, 0], 0.1)
    moved = rod.moved([[0, -1, 0], [1, 0, 0], [0, 0, 1]], [0, 0, 2])
    assert moved.signed_distance([[0, 1, 2]])[0][0] == pytest.approx(-0.1, rel=1e-12)
    assert rod.signed_distance([[1, 0, 0]])[0][0] == pytest.approx(-0.1, rel=1e-12)
    np.testing.assert_allclose(moved.translation, [0, 0, 2])


TURN = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (
            lambda: qr.Obstacle.half_space([0, 0, 7], [1, 0, 0]).moved(translation=[1, 0, 0]),
            ["(1, 0, 7)", "(1, 0, 0)"],
        ),
        (lambda: qr.Obstacle.half_space([0, 0, 0], [0, 0, 2]).moved(TURN), ["(0, 0, 0)", "(0, -1, 0)"]),
        (lambda: qr.Obstacle.sphere([0, 0, 0.25], 0.02).moved(TURN), ["(0, -0.25, 0)", "radius 0.02 m"]),
        (lambda: qr.Obstacle.box([0.01, 0.02, 0.03]).moved(TURN), ["(0.01, 0.02, 0.03)", "(1.570796, 0, 0)"]),
        (
            lambda: qr.Obstacle.capsule([0, 0, 0], [0, 0, 0.1], 0.01).moved(TURN),
            ["(0, 0, 0)", "(0, -0.1, 0)", "0.01 m"],
        ),
        (lambda: qr.Obstacle.cylinder(0.06, 0.015).moved(TURN), ["(0, -1, 0)", "0.06 m", "0.015 m"]),
        (
            lambda: qr.models.rounded_box(size=(0.2, 0.1, 0.05)).moved(TURN, [0, 0, 0.5]),
            ["(0, 0, 0.5)", "(0.2, 0.05, 0.1)", "faces"],
        ),
    ],
    ids=["half-space", "turned half-space", "sphere", "box", "capsule", "cylinder", "mesh"],
)
def test_an_obstacle_is_shown_where_it_stands_and_how_large(
    made: Callable[[], qr.Obstacle], words: list[str]
) -> None:
    for word in words:
        assert word in repr(made())


def test_bad_obstacles_are_named() -> None:
    vertices, faces = tetrahedron()
    with pytest.raises(qr.ObstacleError, match="must be closed"):
        qr.Obstacle.mesh(vertices, faces[:3])
    with pytest.raises(qr.ObstacleError, match="inside out"):
        qr.Obstacle.mesh(vertices, faces[:, ::-1])
    with pytest.raises(qr.ObstacleError, match="face 0 refers to vertex -3"):
        qr.Obstacle.mesh(vertices, faces - 3)
    with pytest.raises(qr.ObstacleError, match="radius"):
        qr.Obstacle.sphere([0, 0, 0], -1.0)
    with pytest.raises(qr.ObstacleError, match="point 1 is"):
        qr.Obstacle.sphere([0, 0, 0], 1.0).signed_distance([[0, 0, 0], [np.nan, 0, 0]])


def test_crossing_faces_are_found_unless_told_not_to_look() -> None:
    vertices, faces = tetrahedron()
    both = np.concatenate([vertices, vertices + np.array([0.2, 0.2, -0.1])])
    twice = np.concatenate([faces, faces + 4])
    with pytest.raises(qr.ObstacleError, match="faces cross"):
        qr.Obstacle.mesh(both, twice)
    assert qr.Obstacle.mesh(both, twice, check_crossings=False).kind == "mesh"
