"""Contacts that several tests look at."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr
from shapes import SKIN, ball


@pytest.fixture(scope="session")
def fingertip() -> qr.Surface:
    tip = qr.models.fingertip(edge_length=1.6e-3)
    return tip.with_skin_mask(qr.skin_without_caps(tip))


@pytest.fixture(scope="session")
def pressed(fingertip: qr.Surface) -> qr.Contact:
    """The fingertip pressed 1.12 mm deep by a plate from below."""
    plate = qr.Obstacle.half_space([0.0, 0.0, -0.05], [0.0, 0.0, 1.0])
    return qr.press(fingertip, plate, SKIN, [0.0, 0.0, 1.0], depth=1.12e-3)


@pytest.fixture(scope="session")
def apart(fingertip: qr.Surface) -> qr.Contact:
    """The fingertip and a plate that does not reach it."""
    plate = qr.Obstacle.half_space([0.0, 0.0, -0.05], [0.0, 0.0, 1.0])
    return qr.solve_contact(fingertip, plate, SKIN)


@pytest.fixture(scope="session")
def by_depth() -> qr.Sweep:
    """A ball of skin under a plate at three depths, out of order, one of them nothing."""
    plate = qr.Obstacle.half_space([0.0, 0.0, -0.05], [0.0, 0.0, 1.0])
    return qr.sweep(qr.Surface(*ball(8e-3, 2)), plate, SKIN, [0.0, 0.0, 3.0], depths=[1e-3, 0.0, 0.4e-3])


@pytest.fixture(scope="session")
def unsolved(fingertip: qr.Surface) -> qr.Contact:
    """The paper's Gaussian constants at a depth at which they have no solution."""
    response = qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3)
    with pytest.warns(qr.QuasirigidWarning, match="not well posed"):
        skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    plate = qr.Obstacle.half_space([0.0, 0.0, -0.05], [0.0, 0.0, 1.0])
    contact = qr.press(fingertip, plate, skin, [0.0, 0.0, 1.0], depth=2e-3, throw=False)
    assert contact.status != "solved"
    assert np.isnan(contact.force).all()
    return contact
