"""The scenes of `quasirigid demo`: the built-in fingertip over a handle and over a phone-sized box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import models
from ..contact.result import Contact
from ..obstacle import Obstacle
from ..surface import Surface, flat_cap_mask

__all__ = ["Scene", "demo_scenes", "may_touch", "under_the_pad"]


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A finger and a product below its pad.

    Attributes
    ----------
    name : str
        For folders and tables.
    surface : Surface
        The finger, its cut face no skin.
    bone : Surface
        Its phalanges.
    obstacle : Obstacle
        The product, where it starts.
    direction : (3,) float64
        The way it comes, a unit vector.
    """

    name: str
    surface: Surface
    bone: Surface
    obstacle: Obstacle
    direction: NDArray[np.float64]


def demo_scenes(edge_length: float) -> list[Scene]:
    """The two scenes; finger and handle have a mean edge of `edge_length` (m)."""
    finger = models.fingertip(edge_length=edge_length)
    finger = finger.with_skin_mask(flat_cap_mask(finger))
    bone = models.bone_of(finger)
    # The bar lies across the finger: its axis z turned to x.
    across = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    place = under_the_pad(finger.vertices, below=0.04)
    upwards = np.array([0.0, 0.0, 1.0])
    handle = models.cylinder_handle(edge_length=edge_length).moved(across, place)
    phone = models.rounded_box().moved(np.eye(3), place)
    return [
        Scene(name="handle", surface=finger, bone=bone, obstacle=handle, direction=upwards),
        Scene(name="phone", surface=finger, bone=bone, obstacle=phone, direction=upwards),
    ]


def under_the_pad(vertices: NDArray[np.float64], below: float) -> NDArray[np.float64]:
    """The point (3,) in m that lies `below` (m) the lowest point of a finger's pad."""
    point: NDArray[np.float64] = vertices[np.argmin(vertices[:, 2])] - np.array([0.0, 0.0, below])
    return point


def may_touch(contact: Contact, depth: float) -> NDArray[np.int64]:
    """Skin vertices (k,) that a press like this one may bring into contact, whatever the response.

    Parameters
    ----------
    contact : Contact
        The press with a response that costs little; where its obstacle stands counts.
    depth : float
        Of the press (m). Vertices closer to the obstacle than half of it and two edges are told.
    """
    surface = contact.deformed
    before = surface.vertices - contact.displacement
    reach = 0.5 * depth + 2.0 * surface.mean_edge_length
    distance = contact.obstacle.signed_distance(before, reach)[0]
    near: NDArray[np.int64] = np.flatnonzero(surface.skin_mask & (distance < reach))
    return near
