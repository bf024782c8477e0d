"""Refinement at edges, thin walls and small feet, which stand between the vertices of the given mesh."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest
import quasirigid as qr
from refined import MATERIAL, TARGET, UP, jittered_ball
from scipy.spatial.transform import Rotation
from shapes import AS_GIVEN, SKIN, ball, grid, slab

# Scenes are coarse on purpose, and taken as they are; some are metres wide.
pytestmark = [
    pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning"),
    pytest.mark.filterwarnings("ignore::quasirigid.SizeWarning"),
]


def turned_box(size: list[float], axis: list[float], degrees: float) -> qr.Obstacle:
    """A box beside the middle of the ball, turned about an axis through its own."""
    turn = Rotation.from_rotvec(np.radians(degrees) * np.array(axis) / np.linalg.norm(axis)).as_matrix()
    return qr.Obstacle.box(size).moved(turn, [0.13e-3, 0.07e-3, -50e-3])


EDGES = {
    "edge": turned_box([15e-3, 5e-3, 5e-3], [1, 0, 0], 45),
    "corner": turned_box([6e-3, 6e-3, 6e-3], [1, -1, 0], math.degrees(math.acos(3**-0.5))),
    "wall": turned_box([15e-3, 0.2e-3, 15e-3], [1, 0, 0], 0),
    "leaning wall": turned_box([0.2e-3, 15e-3, 15e-3], [1, 2, 3], 17),
}


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize(("target", "within"), [(None, 1e-9), (TARGET, 1e-6)])
@pytest.mark.parametrize("discretization", ["collocation", "galerkin"])
@pytest.mark.parametrize("edge", EDGES)
def test_neither_place_nor_numbering_matters_at_an_edge(
    edge: str, discretization: Literal["collocation", "galerkin"], target: float | None, within: float
) -> None:
    skin = qr.Skin(**MATERIAL, response=qr.HalfSpace(discretization=discretization))
    surface, options = jittered_ball(2), qr.ContactOptions(target_error=target)
    force = qr.press(surface, EDGES[edge], skin, UP, depth=0.6e-3, options=options).force

    random = np.random.default_rng(3)
    for turn in Rotation.random(3, random_state=4).as_matrix():
        shift = random.uniform(-0.3, 0.3, 3)
        moved, product = surface.moved(turn, shift), EDGES[edge].moved(turn, shift)
        turned = qr.press(moved, product, skin, turn @ UP, depth=0.6e-3, options=options)
        np.testing.assert_allclose(turned.force, turn @ force, atol=within * np.linalg.norm(force))

    order = random.permutation(len(surface.vertices))
    faces = np.argsort(order)[surface.faces][random.permutation(len(surface.faces))]
    renumbered = qr.Surface(surface.vertices[order], np.roll(faces, 1, axis=1))
    again = qr.press(renumbered, EDGES[edge], skin, UP, depth=0.6e-3, options=options)
    np.testing.assert_allclose(again.force, force, atol=within * np.linalg.norm(force))


@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
@pytest.mark.parametrize("place", [(5.1e-3, 0.25e-3), (5.4e-3, 0.25e-3)])
def test_a_small_foot_between_vertices_away_from_all_force_is_met(place: tuple[float, float]) -> None:
    vertices, faces = grid(16, 1.5e-3)
    skin = qr.Surface(vertices, faces).moved(np.diag([1.0, -1.0, -1.0]))
    # Two feet with round ends, of 8 and 1 mm radius, the small one 0.05 mm lower.
    points, triangles = grid(160, 0.1e-3)
    small, overlap = points[:, :2] - place, 0.05e-3
    large = np.sum(points[:, :2] ** 2, axis=1) / 16e-3
    points[:, 2] = -np.minimum(np.minimum(large, overlap + np.sum(small**2, axis=1) / 2e-3), 0.8e-3)
    product = qr.Obstacle.mesh(*slab((points, triangles), 3e-3)).moved(translation=-0.05 * UP)
    contact = qr.press(skin, product, SKIN, UP, depth=2 * overlap)
    assert len(contact.patches) == 2
    at_small = np.linalg.norm(contact.surface.vertices[:, :2] - place, axis=1) < 1e-3
    modulus = qr.reference.contact_modulus(**MATERIAL)
    alone = qr.reference.Hertz(radius=1e-3, contact_modulus=modulus).force(overlap)
    # The skin there gives way to the other foot too.
    assert 0.5 * alone < contact.part(at_small).force[2] < alone


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize("beside", [0.0, 0.1e-3])
@pytest.mark.parametrize("slope", [1.0, 1.7])
def test_a_ridge_of_skin_on_the_two_edges_of_a_thin_wall_is_solved(slope: float, beside: float) -> None:
    vertices, faces = grid(24, 0.5e-3)
    vertices[:, 2] = -slope * np.abs(vertices[:, 0])
    skin = qr.Surface(vertices, faces).moved(np.diag([1.0, -1.0, -1.0]))
    wall = qr.Obstacle.box([0.1e-3, 4e-3, 4e-3]).moved(translation=[beside, 0.0, -8e-3])
    contact = qr.press(skin, wall, SKIN, UP, depth=0.3e-3)
    assert contact.status == "solved"
    assert contact.force[2] > 0.0


@pytest.mark.filterwarnings("ignore::quasirigid.RefinementWarning")
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
def test_a_graze_that_averages_do_not_feel_on_the_given_mesh_is_refined_until_they_do() -> None:
    # An edge between the vertices of the pad.
    tip, turn, half = np.array([7e-5, 4.1e-4, -0.06]), 2.79, np.sqrt(0.5)
    up_edge = np.array([[1, 0, 0], [0, half, -half], [0, half, half]])
    about_z = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    edge = qr.Obstacle.box([0.02, 0.02, 0.02]).moved(about_z @ up_edge, tip)
    surface = qr.Surface(*ball(8e-3, 2))
    skin = qr.Skin(**MATERIAL, response=qr.HalfSpace(discretization="galerkin"))
    given = qr.press(surface, edge, skin, UP, depth=2e-5, options=AS_GIVEN)
    assert given.max_penetration_before > 0.0
    assert not given.force.any()
    assert given.accuracy.force_error == np.inf
    refined = qr.press(surface, edge, skin, UP, depth=2e-5)
    pointwise = qr.press(surface, edge, SKIN, UP, depth=2e-5)
    apart = sum(one.accuracy.force_error * one.force[2] for one in (refined, pointwise))
    assert refined.force[2] == pytest.approx(pointwise.force[2], abs=apart)
    # All force is on the edge, where the estimates are the largest.
    assert apart < 0.7 * pointwise.force[2]


@pytest.mark.filterwarnings("ignore::quasirigid.RefinementWarning")
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
@pytest.mark.parametrize("depth", [0.6e-3, 1.2e-3, 2.4e-3])
def test_the_estimate_on_a_sharp_edge_covers_what_finer_meshes_change(depth: float) -> None:
    half = np.sqrt(0.5)
    up_edge = np.array([[1, 0, 0], [0, half, -half], [0, half, half]])
    edge = qr.Obstacle.box([0.02, 0.02, 0.02]).moved(up_edge, [1e-3, 3e-4, -0.06])
    contact = qr.press(qr.Surface(*ball(8e-3, 3)), edge, SKIN, UP, depth=depth)
    assert contact.accuracy.max_pressure_error == np.inf
    meshes = [one for one in contact.refinements if one.kind == "mesh"]
    finest = meshes[-1].force[2]
    # The first three do not show how slowly the force settles.
    for one in meshes[3:]:
        assert one.force_error is not None
        assert abs(one.force[2] - finest) <= one.force_error * one.force[2]
    # The last is not the limit either: a mesh twice as fine is another 5 % off.
    assert contact.accuracy.force_error is not None
    assert contact.accuracy.force_error > 0.05


@pytest.mark.filterwarnings("ignore::quasirigid.RefinementWarning")
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
@pytest.mark.parametrize("depth", [0.6e-3, 1.2e-3, 2.4e-3])
def test_the_force_on_a_sharp_edge_is_nearly_that_of_a_wedge_as_broad(depth: float) -> None:
    upright = Rotation.from_rotvec([np.pi / 4, 0, 0]).as_matrix()
    edge = qr.Obstacle.box([0.02, 0.02, 0.02]).moved(upright, [1e-3, 3e-4, -0.06])
    contact = qr.press(qr.Surface(*ball(8e-3, 3)), edge, SKIN, UP, depth=depth)
    # Johnson 1985, section 5.2: P = E* a cot(alpha) by length, here of 45 degrees.
    plane_modulus = 2 * SKIN.shear_modulus / (1 - SKIN.poisson_ratio)
    # Triangles as broad as the contact press with twice that; finer ones come to it from above.
    assert 1 < contact.force[2] / (0.5 * plane_modulus * contact.contact_area) < 1.25


@pytest.mark.filterwarnings("ignore::quasirigid.RefinementWarning")
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
def test_the_force_on_a_sharp_edge_grows_steadily() -> None:
    pad, aslant = jittered_ball(1), math.sqrt(0.5) * np.array([[1, 0, 1], [0, math.sqrt(2), 0], [-1, 0, 1]])
    ridge = qr.Obstacle.box([0.02, 0.05, 0.02]).moved(aslant, [0.3e-3, 0, -0.05])
    curve = qr.sweep(pad, ridge, SKIN, UP, depths=np.geomspace(0.5e-3, 2e-3, 41))
    growth = np.diff(np.log(curve.normal_force))
    # Each triangle is halved at a depth of its own: all at once, one step came to 0.16.
    assert growth.min() > 0
    assert np.abs(growth - np.median(growth)).max() < 0.05


@pytest.mark.filterwarnings("ignore::quasirigid.RefinementWarning")
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
@pytest.mark.filterwarnings("ignore:.*steeper than 60 degrees:quasirigid.DepthWarning")
def test_gaps_at_the_shoulders_of_a_blunt_blade_vanish_by_shorter_steps() -> None:
    tip = qr.models.fingertip(edge_length=1.5e-3)
    lowest = tip.vertices[np.argmin(tip.vertices[:, 2])]
    # 1.5 mm thick, its edge of 120 degrees along x: pressed deeper than its bevels are high.
    half, height = 0.75e-3, 0.75e-3 / math.tan(math.radians(60))
    outline = [(0, 0), (half, -height), (half, -0.02), (-half, -0.02), (-half, -height)]
    corners = [(x, y, z) for x in (-0.02, 0.02) for y, z in outline]
    sides = [[i, (i + 1) % 5, (i + 1) % 5 + 5] for i in range(5)] + [
        [i, (i + 1) % 5 + 5, i + 5] for i in range(5)
    ]
    caps = [[0, i + 1, i] for i in range(1, 4)] + [[5, 5 + i, 6 + i] for i in range(1, 4)]
    blade = qr.Obstacle.mesh(np.add(corners, [0, lowest[1], -0.3]), np.array(sides + caps)[:, ::-1])
    contact = qr.press(tip, blade, SKIN, UP, depth=1.5e-3)
    left = [one.max_penetration for one in contact.refinements if one.kind == "linearization"]
    # A full step has no answer here; halves of it were given up with 13 % left.
    assert left[-1] < 0.01 * contact.max_penetration_before
