"""Vertices that a body is prepared for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..contact import Contact
from ..skin import Body

__all__ = ["free_nodes", "may_touch"]


def may_touch(contact: Contact, depth: float) -> NDArray[np.int64]:
    """Return the skin vertices (k,) that a press like this one may bring into contact, whatever the response.

    Parameters
    ----------
    contact : Contact
        The press with a response that costs little; where its obstacle stands counts.
    depth : float
        Of the press (m). Vertices closer to the obstacle than half of it and two edges count.
    """
    surface = contact.deformed
    before = surface.vertices - contact.displacement
    reach = 0.5 * depth + 2.0 * surface.mean_edge_length
    distance = contact.obstacle.signed_distance(before, reach)[0]
    near: NDArray[np.int64] = np.flatnonzero(surface.skin_mask & (distance < reach))
    return near


def free_nodes(nodes: NDArray[np.int64], body: Body) -> NDArray[np.int64]:
    """Return the nodes that can be loaded: those that are not fixed."""
    return nodes if body.fixed is None else nodes[~np.asarray(body.fixed)[nodes]]
