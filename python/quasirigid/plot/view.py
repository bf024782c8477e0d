"""From where a contact is looked at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .._check import as_direction, short
from ..contact.result import ContactError
from .raster import Floats

if TYPE_CHECKING:
    from ..contact.result import Contact

__all__ = ["View", "pad_view"]

_OPPOSED = 0.5  # resultant over the sum of the forces, below which patches push against each other


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """Directions of a parallel view, orthonormal.

    Attributes
    ----------
    right, up : (3,) float64
        In the picture.
    toward : (3,) float64
        Towards the viewer.
    """

    right: Floats
    up: Floats
    toward: Floats

    @classmethod
    def along(cls, sight: Floats, up: Floats) -> View:
        """Return the view along `sight` (3,), with `up` (3,), made perpendicular to it, upwards.

        Raises
        ------
        ContactError
            If one of them has no direction, or both have the same.
        """
        toward, wanted = -as_direction("sight", sight, ContactError), as_direction("up", up, ContactError)
        upward = wanted - (wanted @ toward) * toward
        length = np.linalg.norm(upward)
        if length < 1e-9:
            raise ContactError(f"up is {short(up)}, along the sight: expected a direction across it")
        upward /= length
        return cls(right=np.cross(upward, toward), up=upward, toward=toward)

    def project(self, points: Floats) -> Floats:
        """Return points (n, 3) as (n, 3): right, up, towards the viewer, in the same unit."""
        return points @ np.stack([self.right, self.up, self.toward], axis=1)


def pad_view(contact: Contact) -> View:
    """Return the view from the product onto the skin: along the force, the skin's long axis upwards.

    Where patches push against each other it is along the force of the largest.

    Parameters
    ----------
    contact : Contact
        Where it has no force the view runs along +z.

    Returns
    -------
    View
        An axis of the scene, where force or long axis come close to one.
    """
    force = contact.force
    if np.linalg.norm(force) < _OPPOSED * np.linalg.norm(contact.force_vectors, axis=1).sum():
        force = max((patch.force for patch in contact.patches), key=np.linalg.norm)
    pressed = np.isfinite(force).all() and np.any(force)
    sight = force / np.linalg.norm(force) if pressed else np.array([0.0, 0.0, 1.0])
    # A press along an axis of the scene is drawn square to that axis.
    axis = int(np.argmax(np.abs(sight)))
    if abs(sight[axis]) > 0.95:
        sight = np.sign(sight[axis]) * np.eye(3)[axis]
    vertices = contact.surface.vertices
    spread = vertices - vertices.mean(axis=0)
    flat = spread - np.outer(spread @ sight, sight)
    longest = np.linalg.eigh(flat.T @ flat)[1][:, -1]
    # Towards the larger coordinates: fingertips are on top where fingers lie along +y, as most hands have it.
    axis = int(np.argmax(np.abs(longest)))
    up = longest * np.sign(longest[axis])
    if abs(up[axis]) > 0.95:
        up = np.eye(3)[axis]
    return View.along(sight, up)
