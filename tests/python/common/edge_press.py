"""A ball pressed by an edge that stands between its vertices."""

from __future__ import annotations

import warnings

import numpy as np
import quasirigid as qr
from shapes import AS_GIVEN, ball


def pressed_by_edge(response: qr.HalfSpace, depth: float) -> qr.Contact:
    """Press a ball as it is by an edge between the vertices of its pad."""
    turn, half = 2.79, np.sqrt(0.5)
    up_edge = np.array([[1, 0, 0], [0, half, -half], [0, half, half]])
    about_z = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    edge = qr.Obstacle.box([0.02, 0.02, 0.02]).moved(about_z @ up_edge, [7e-5, 4.1e-4, -0.06])
    return pressed_as_given(qr.Surface(*ball(8e-3, 2)), edge, response, depth)


def pressed_as_given(
    surface: qr.Surface, obstacle: qr.Obstacle, response: qr.HalfSpace, depth: float
) -> qr.Contact:
    """Press on the mesh as it is, with no word of how coarse it is."""
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", qr.QuasirigidWarning)
        return qr.press(surface, obstacle, skin, [0, 0, 1], depth=depth, options=AS_GIVEN)
