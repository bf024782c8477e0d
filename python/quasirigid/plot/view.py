"""From where a contact is looked at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .._arrays import Floats
from .._check import as_direction, as_kind, as_vector, short
from ..contact.parts import Patch
from ..contact.result import Contact, ContactError

__all__ = ["View", "pad_view"]

_SQUARE = 1e-6  # largest dot product of two directions that are square, of unit vectors
_OPPOSED = 0.5  # resultant over the sum of the forces, below which patches push against each other
_INTO = 0.5  # cosine between force and inward skin normal, below which the force runs along the skin


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

    def __post_init__(self) -> None:
        """Refuse what is no right-handed set of unit vectors."""
        names = ("right", "up", "toward")
        axes = np.array([as_vector(name, getattr(self, name), ContactError) for name in names])
        if not np.allclose(axes @ axes.T, np.eye(3), rtol=0.0, atol=_SQUARE) or np.linalg.det(axes) < 0.0:
            found = ", ".join(f"{name} {short(getattr(self, name))}" for name in names)
            raise ContactError(
                f"{found}: expected unit vectors with right x up = toward; View.along makes them"
            )

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


def view_of(contact: Contact, view: View | None) -> View:
    """Return the view of a contact, `pad_view` where none is given.

    Raises
    ------
    TypeError
        If one of them is something else.
    """
    as_contact("contact", contact)
    if view is None:
        return pad_view(contact)
    return as_kind("view", view, View, "View.along(sight, up) makes one")


def as_contact(name: str, value: Any) -> Contact:
    """Return the contact; a TypeError of what is none."""
    return as_kind(name, value, Contact, "press and solve_contact return one")


def pad_view(contact: Contact) -> View:
    """Return the view from the product onto the skin: along the force, the skin's long axis upwards.

    Where patches push against each other it is along the force of the largest, and where that runs along the
    skin, as from the sides of a thin product deep in it, into the skin.

    Parameters
    ----------
    contact : Contact
        Where it has no force the view runs along +z.

    Returns
    -------
    View
        An axis of the scene, where force or long axis come close to one.
    """
    sight = _sight(as_contact("contact", contact))
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


def _sight(contact: Contact) -> Floats:
    """Return the direction in which the skin is pressed, +z where it is not."""
    force, loaded = contact.force, contact.active
    if np.linalg.norm(force) < _OPPOSED * np.linalg.norm(contact.force_vectors, axis=1).sum():
        largest = largest_patch(contact)
        force, loaded = largest.force, largest.vertices
    if not (np.isfinite(force).all() and np.any(force)):
        return np.array([0.0, 0.0, 1.0])
    inward = -contact.node_force[loaded] @ contact.surface.vertex_normals[loaded]
    if force @ inward < _INTO * np.linalg.norm(force) * np.linalg.norm(inward):
        force = inward
    return force / np.linalg.norm(force)


def largest_patch(contact: Contact) -> Patch:
    """Return that with the largest force."""
    return max(contact.patches, key=lambda patch: float(np.linalg.norm(patch.force)))
