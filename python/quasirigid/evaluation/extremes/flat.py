"""Flat skin that is hard to compute on: slivers, very different edges, points that nearly coincide."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from typing import Literal

import numpy as np

from ..._arrays import Floats, Indices
from ...contact import Contact, solve_contact
from ...obstacle import Obstacle
from ...skin import HalfSpace
from ...surface import Surface
from ..meshes import lattice_faces
from .case import Case, Outcome, near
from .scaling import AS_GIVEN, Build, Setting, length_judge, modulus_judge, place_judge, scaled_cases

__all__ = ["CELL", "Form", "flat_skin", "mesh_cases", "sphere_over"]

Form = Literal["collocation", "galerkin"]
Mesh = tuple[Floats, Indices]
# Length of a cell (m), and depth and radius of the sphere, whose contact is four cells wide.
CELL = 1e-3
_DEPTH = 0.2e-3
_RADIUS = (4 * CELL) ** 2 / _DEPTH
_CELLS = 12
# Quadrature of slivers keeps the tolerance and no more, so its rounding may be as large.
_TO_THE_LAST_DIGIT = replace(AS_GIVEN, tolerance=1e-12)
# Of the edge's length.
_NEARLY_EQUAL = 1e-9
# Longest time (s) of a press, four times, with the interpreter's start.
_ALONE = 6.0
# Where corners are cut off: under the sphere, in its middle and near the rim of the contact.
_CUT = (2 * (6 * 12 + 6), 2 * (7 * 12 + 5) + 1, 2 * (9 * 12 + 6))


def flat_skin(cells: int) -> Mesh:
    """Return vertices (m) and faces of a square about the origin, its vertices moved a little."""
    x = (np.arange(cells + 1) - cells / 2) * CELL
    points = np.stack([*np.meshgrid(x, x, indexing="ij"), np.zeros((cells + 1, cells + 1))], -1).reshape(
        -1, 3
    )
    points[:, :2] += np.random.default_rng(0).uniform(-0.1 * CELL, 0.1 * CELL, (len(points), 2))
    faces = lattice_faces(cells, cells)
    # The two triangles of a cell one after the other.
    half = len(faces) // 2
    return points, np.stack([faces[:half], faces[half:]], 1).reshape(-1, 3)


def sphere_over(setting: Setting, mesh: Mesh, form: Form) -> Contact:
    """Return the contact of a sphere in place with flat skin."""
    surface = setting.surface(Surface(*mesh))
    center = setting.placed(np.array([0.0, 0.0, _RADIUS - _DEPTH]))
    sphere = Obstacle.sphere(center, _RADIUS * setting.length)
    skin = setting.skin(HalfSpace(discretization=form))
    options = _TO_THE_LAST_DIGIT if form == "collocation" else AS_GIVEN
    return solve_contact(surface, sphere, skin, options=options)


def mesh_cases() -> Iterator[Case]:
    """Make the cases of the meshes."""
    changes: dict[str, partial[Mesh]] = {
        "slivers of 0.01 degrees": partial(_with_points, np.radians(0.01) / 2, middle=True),
        "edges in the ratio 1e4": partial(_with_points, 1e-4, middle=False),
        "points 1e-9 edges apart": partial(_with_points, _NEARLY_EQUAL, middle=False),
    }
    for name, change in changes.items():
        build: Build = partial(_on, change, "collocation")
        judge: Callable[[], Outcome] = partial(_as_without, build, "collocation")
        yield Case(group="mesh", name=f"{name}: as without", judge=judge, quick=True)
        # How two points share the load depends on the way between them; a kilometre away the nearest are one.
        share = change.args[0]
        smallest = _DEPTH if change.keywords["middle"] else share * CELL
        far = share > _NEARLY_EQUAL
        yield from scaled_cases("mesh", name, build, smallest=smallest, far=far)
        judge = partial(_all_scaled, cache(partial(_on, change, "galerkin")), smallest, far=far)
        yield Case(group="mesh", name=f"{name}, galerkin", judge=judge, alone=_ALONE)


def _on(change: Callable[[], Mesh], form: Form, setting: Setting) -> Contact:
    return sphere_over(setting, change(), form)


def _with_points(share: float, *, middle: bool) -> Mesh:
    """Return the square with a point added in some of its triangles.

    Near the middle of an edge, so that thin triangles stand on it, or near a corner; `share` is the distance
    over the edge.
    """
    points, faces = flat_skin(_CELLS)
    added, kept = [], np.ones(len(faces), dtype=bool)
    news = []
    for face in _CUT:
        a, b, c = faces[face]
        start = 0.5 * (points[a] + points[b]) if middle else points[a]
        inward = points[c] - start if middle else 0.5 * (points[b] + points[c]) - start
        news.append(start + share * np.linalg.norm(points[b] - points[a]) * inward / np.linalg.norm(inward))
        new = len(points) + len(news) - 1
        kept[face] = False
        added += [(a, b, new), (b, c, new), (c, a, new)]
    return np.vstack([points, news]), np.vstack([faces[kept], added])


def _as_without(build: Build, form: Form) -> Outcome:
    """A point more changes the contact by no more than the mesh is off at all."""
    with_points, without = build(Setting()), sphere_over(Setting(), flat_skin(_CELLS), form)
    error = float(np.linalg.norm(with_points.force - without.force) / np.linalg.norm(without.force))
    mesh = without.accuracy.force_error
    assert mesh is not None, "a contact of several cells has an estimate"
    return near("the force of the mesh without them, to what its cells cost", error, mesh)


def _all_scaled(build: Build, smallest: float, *, far: bool) -> Outcome:
    """Return the worst of the scaled answers and of the one without these points."""
    outcomes = [
        _as_without(build, "galerkin"),
        modulus_judge(build, smallest, 60e9),
        length_judge(build, smallest, 1e-3),
    ]
    if far:
        outcomes.append(place_judge(build, smallest))
    # Of an error that is no number no order says that it is the largest.
    return max(outcomes, key=lambda one: (not one.ok, (one.error or 0.0) / (one.limit or 1.0)))
