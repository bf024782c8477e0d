"""Vertices that a body is prepared for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..obstacle import Obstacle
from ..surface import Surface

__all__ = ["may_touch"]


def may_touch(surface: Surface, obstacle: Obstacle, depth: float) -> NDArray[np.int64]:
    """Return the skin vertices (k,) that a press may bring into contact, whatever the response.

    Parameters
    ----------
    surface : Surface
        The undeformed skin.
    obstacle : Obstacle
        The product where the press ends.
    depth : float
        Of the press (m). Vertices closer to the obstacle than half of it and two edges count.
    """
    reach = 0.5 * depth + 2.0 * surface.mean_edge_length
    distance = obstacle.signed_distance(surface.vertices, reach)[0]
    near: NDArray[np.int64] = np.flatnonzero(surface.skin_mask & (distance < reach))
    return near
