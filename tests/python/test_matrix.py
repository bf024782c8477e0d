"""Response matrices: what a contact uses, volume, definiteness, memory."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, PLATE, SKIN, ball, grid


def test_the_response_matrix_is_what_the_contact_uses() -> None:
    surface = qr.Surface(*ball(8e-3, 4))
    contact = qr.press(surface, PLATE, SKIN, [0, 0, 2], depth=0.5e-3, options=AS_GIVEN)
    matrix = qr.response_matrix(surface, SKIN, contact.candidates)
    rise = matrix @ contact.node_force[contact.candidates]
    start = surface.vertices[contact.candidates, 2] - contact.travel
    # Entries hold to 1e-6 relative and are all positive.
    np.testing.assert_allclose(start + rise, contact.gap[contact.candidates], atol=2e-6 * rise.max())


def test_a_balanced_gaussian_keeps_volume_on_a_wide_flat_mesh() -> None:
    cells, spacing = 60, 1e-3
    surface = qr.Surface(*grid(cells, spacing))
    middle = (cells + 1) * cells // 2 + cells // 2
    response = qr.GaussianCorrected.balanced(width=10e-3, cutoff=15e-3)
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    volume = qr.net_volume(surface, skin, middle)
    # The mesh sums the kernel's peak and its jump at the cutoff with an error of spacing / cutoff.
    assert abs(volume.net) < 0.02 * volume.gross
    half_space = qr.net_volume(surface, SKIN, middle)
    assert half_space.net == pytest.approx(half_space.gross)


@pytest.mark.parametrize("cells", [44, 50, 60])
def test_an_incompressible_layer_keeps_volume_on_a_wide_flat_mesh(cells: int) -> None:
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.Layer(thickness=1e-3))
    surface = qr.Surface(*grid(cells, 1e-3))
    volume = qr.net_volume(surface, skin, (cells + 1) * cells // 2 + cells // 2)
    # The kernel fades as exp(-0.76 r / h): what lies beyond 22 thicknesses is some 2e-7 of all.
    assert abs(volume.net) < 1e-6 * volume.gross


def test_a_galerkin_layer_is_symmetric_and_positive_definite_up_to_its_border() -> None:
    surface = qr.Surface(*grid(6, 1e-3))
    nodes = np.arange(len(surface.vertices))
    response = qr.Layer(thickness=0.3e-3, discretization="galerkin")
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    matrix = qr.response_matrix(surface, skin, nodes)
    np.testing.assert_array_equal(matrix, matrix.T)
    assert np.linalg.eigvalsh(matrix)[0] > 0


def test_condition_and_definiteness_are_known_when_cheap_or_asked_for() -> None:
    surface = qr.Surface(*ball(8e-3, 4))
    small = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=0.2e-3, options=AS_GIVEN)
    assert len(small.candidates) <= 64
    assert small.accuracy.definite is True
    matrix = qr.response_matrix(surface, SKIN, small.candidates)
    assert small.accuracy.condition == pytest.approx(qr.definiteness(matrix).condition, rel=1e-4)
    asked = qr.press(
        surface, PLATE, SKIN, [0, 0, 1], depth=1.12e-3, options=qr.ContactOptions(condition=True)
    )
    assert len(asked.candidates) > 64
    assert asked.accuracy.condition is not None
    assert 1 < asked.accuracy.condition < 1e3
    assert asked.accuracy.definite is not None
    unasked = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=1.12e-3, options=AS_GIVEN)
    assert len(unasked.candidates) > 64
    assert (unasked.accuracy.condition, unasked.accuracy.definite) == (None, None)


def test_a_matrix_that_memory_does_not_hold_is_refused_before_it_is_made() -> None:
    # 202,500 vertices that all touch: 328 GB.
    side = np.arange(450) * 1e-3
    x, y = (axis.ravel() for axis in np.meshgrid(side, side))
    cell = (np.arange(449)[:, None] * 450 + np.arange(449)).ravel()
    low, high = [cell, cell + 1, cell + 451], [cell, cell + 451, cell + 450]
    faces = np.concatenate([np.column_stack(low), np.column_stack(high)])
    sheet = qr.Surface(np.column_stack([x, y, np.zeros(len(x))]), faces)
    plate = qr.Obstacle.half_space([0, 0, 1], [0, 0, -1])
    with pytest.raises(qr.ResponseError, match=r"over 202500 nodes needs 328050000000 bytes, more than"):
        qr.press(sheet, plate, SKIN, [0, 0, -1], depth=1e-3, options=AS_GIVEN)
