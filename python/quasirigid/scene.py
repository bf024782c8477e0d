"""Surfaces and obstacles among arguments; what is neither is refused with what makes one of it."""

from __future__ import annotations

from os import PathLike
from typing import Any

from ._check import kind_of
from ._core import Obstacle, Surface

__all__ = ["as_obstacle", "as_surface", "check_scene"]


def as_surface(name: str, value: Any) -> Surface:
    """Return the surface.

    Raises
    ------
    TypeError
        If it is none; the message says how to make one of it.
    """
    if isinstance(value, Surface):
        return value
    if isinstance(value, Obstacle):
        remedy = "a product goes in the place of the obstacle"
    elif isinstance(getattr(value, "surface", None), Surface):
        remedy = "pass its `.surface`"
    else:
        remedy = _remedy(value, "qr.read_surface", "qr.Surface.from_mesh", "qr.Surface(vertices, faces)")
    raise TypeError(f"{name} is {kind_of(value)}, expected a Surface: {remedy}")


def as_obstacle(name: str, value: Any) -> Obstacle:
    """Return the obstacle, as `as_surface` does a surface."""
    if isinstance(value, Obstacle):
        return value
    if isinstance(value, Surface):
        remedy = "qr.Obstacle.mesh(surface.vertices, surface.faces) makes one of a closed surface"
    else:
        arrays = "qr.Obstacle.mesh(vertices, faces)"
        remedy = _remedy(value, "qr.read_obstacle", "qr.Obstacle.from_mesh", arrays)
    raise TypeError(f"{name} is {kind_of(value)}, expected an Obstacle: {remedy}")


def check_scene(surface: Any, obstacle: Any) -> None:
    """Refuse what is no surface or no obstacle, and the two of them swapped."""
    if isinstance(surface, Obstacle) and isinstance(obstacle, Surface):
        raise TypeError("surface is an Obstacle and obstacle a Surface: swap them, the skin comes first")
    as_surface("surface", surface)
    as_obstacle("obstacle", obstacle)


def _remedy(value: Any, read: str, convert: str, make: str) -> str:
    if isinstance(value, (str, PathLike)):
        return f"`{read}(path, unit=...)` reads it"
    pairs = ("vertices", "faces"), ("points", "cells"), ("points", "faces"), ("vertices", "triangles")
    if any(hasattr(value, one) and hasattr(value, other) for one, other in pairs):
        return f"`{convert}(mesh, unit=...)` takes it"
    return f"`{make}` makes one"
