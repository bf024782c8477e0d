"""Gaps for contact problems of one's own."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr
from numpy.typing import NDArray
from shapes import AS_GIVEN, grid

SPACING, RADIUS, DEPTH = 1.25e-3, 0.2, 0.5e-3


def half_space(discretization: qr.Discretization) -> qr.Skin:
    response = qr.HalfSpace(discretization=discretization)
    return qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)


def parabola(points: NDArray[np.float64]) -> NDArray[np.float64]:
    gaps: NDArray[np.float64] = (points[:, 0] ** 2 + points[:, 1] ** 2) / (2 * RADIUS) - DEPTH
    return gaps


@pytest.mark.parametrize("discretization", qr.Discretization)
def test_a_contact_of_ones_own_has_the_force_of_hertz(discretization: qr.Discretization) -> None:
    # 8 cells per contact radius
    surface = qr.Surface(*grid(22, SPACING))
    skin, nodes = half_space(discretization), np.arange(len(surface.vertices))
    q = qr.initial_gaps(surface, skin, nodes, parabola)
    force = qr.solve_lcp(qr.response_matrix(surface, skin, nodes), q).z.sum()
    modulus = qr.reference.contact_modulus(shear_modulus=60e3, poisson_ratio=0.5)
    hertz = qr.reference.Hertz(radius=RADIUS, contact_modulus=modulus).force(DEPTH)
    # of the error of the gap at vertices, h^2/6R of the depth, 1.5 times as much would be left in the force
    assert force == pytest.approx(hertz, rel=0.5 * 1.5 * SPACING**2 / (6 * RADIUS) / DEPTH)


# Four middles of sides touch, 0.3 % to 0.5 % of the force.
@pytest.mark.filterwarnings("ignore:the contact reaches:quasirigid.QuasirigidWarning")
@pytest.mark.parametrize("discretization", qr.Discretization)
def test_gaps_of_an_obstacle_are_those_of_a_contact(discretization: qr.Discretization) -> None:
    surface = qr.Surface(*grid(16, SPACING))
    obstacle = qr.Obstacle.sphere([0, 0, RADIUS - DEPTH], RADIUS)
    skin = half_space(discretization)
    contact = qr.solve_contact(surface, obstacle, skin, options=AS_GIVEN)
    q = qr.initial_gaps(surface, skin, contact.candidates, obstacle)
    normals = obstacle.signed_distance(surface.vertices[contact.candidates])[2]
    response = qr.response_matrix(surface, skin, contact.candidates) * (normals @ normals.T)
    solution = qr.solve_lcp(response, q)
    np.testing.assert_allclose(solution.z, contact.node_force[contact.candidates], rtol=1e-8, atol=1e-12)


def test_averages_are_exact_for_quadratic_gaps() -> None:
    surface = qr.Surface(*grid(4, SPACING))
    middle = [int(np.argmin(np.linalg.norm(surface.vertices, axis=1)))]
    plane = qr.initial_gaps(
        surface, half_space(qr.Discretization.GALERKIN), middle, lambda p: 3.0 + 2.0 * p[:, 0]
    )
    assert plane == pytest.approx([3.0], rel=1e-14)
    square = qr.initial_gaps(surface, half_space(qr.Discretization.GALERKIN), middle, lambda p: p[:, 0] ** 2)
    corners = surface.vertices[surface.faces[np.any(surface.faces == middle[0], axis=1)]]
    edges = corners[:, 1:] - corners[:, :1]
    areas = 0.5 * np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0])
    others = np.array([row[np.abs(row).sum(axis=1) > 0] for row in corners])
    x, y = others[:, 0, 0], others[:, 1, 0]
    # int l_a (l_b x + l_c y)^2 dA = A (x^2 + x y + y^2) / 30, of the hat's A / 3 in all
    expected = np.sum(areas * (x * x + x * y + y * y) / 30) / np.sum(areas / 3)
    assert square == pytest.approx([expected], rel=1e-13)


@pytest.mark.parametrize("bad", [lambda p: p[:-1, 0], lambda p: np.full(len(p), np.nan)])
def test_a_function_that_returns_no_gaps_is_named(bad: object) -> None:
    surface = qr.Surface(*grid(4, SPACING))
    with pytest.raises(qr.ResponseError, match=r"distance\(points\) must return \d+ finite numbers"):
        qr.initial_gaps(surface, half_space(qr.Discretization.GALERKIN), [0], bad)  # type: ignore[arg-type]


def leaning_response(place: NDArray[np.float64], normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """n . G n of points on an incompressible half-space (Boussinesq 1885, Cerruti 1882), cells as squares."""
    apart = place[:, None, :2] - place[None, :, :2]
    distance = np.linalg.norm(apart, axis=2)
    np.fill_diagonal(distance, 1.0)
    along = apart / distance[..., None]
    # mean of 1/r over a square cell, seen from its middle: 4 asinh(1) / h; of cos^2 there: a half
    inverse = 1.0 / distance
    np.fill_diagonal(inverse, 4.0 * np.arcsinh(1.0) / (place[1, 1] - place[0, 1]))
    side, up = normals[:, :2], normals[:, 2]
    across = 0.5 * (side @ side.T)
    across += 0.5 * np.einsum("ia,ija->ij", side, along) * np.einsum("ja,ija->ij", side, along)
    across[np.diag_indices(len(place))] = 0.75 * (side**2).sum(axis=1)
    return inverse * (across + 0.5 * np.outer(up, up)) / (2 * np.pi * 60e3)


# The ridge is as long as the skin.
@pytest.mark.filterwarnings("ignore::quasirigid.CutWarning")
def test_skin_stays_on_both_sides_of_a_ridge_as_a_half_space_in_all_directions_does() -> None:
    cells, spacing, depth = 24, 0.625e-3, 3e-3
    surface = qr.Surface(*grid(cells, spacing))
    half = 0.5 * cells * spacing
    # a roof of 90 degrees, its ridge along a line of the mesh
    roof = np.array(
        [
            [0, y, z] if z == 0 else [x, y, z]
            for y in (-half, half)
            for x, z in ((0, 0), (0.05, 0.05), (-0.05, 0.05))
        ]
    )
    faces = [[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]]
    ridge = qr.Obstacle.mesh(roof * [1, 1.01, 1], np.array(faces))
    skin = half_space(qr.Discretization.COLLOCATION)
    contact = qr.press(surface, ridge, skin, [0, 0, -1], depth=depth, options=AS_GIVEN)
    nodes = contact.candidates
    place = surface.vertices[nodes]
    side = np.sign(np.where(np.abs(place[:, 0]) < 0.1 * spacing, 0.0, place[:, 0]))
    normals = np.stack([side, 0.0 * side, -np.ones(len(side))], axis=1)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    gaps = (np.abs(place[:, 0]) - depth) * np.where(side == 0.0, 1.0, np.sqrt(0.5))
    expected = qr.solve_lcp(leaning_response(place, normals), gaps).z @ normals[:, 2]
    assert contact.force[2] == pytest.approx(expected, rel=0.04)
