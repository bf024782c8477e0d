"""Contacts of odd extent: flat on flat, one node, at a border or a cut, thousands of patches, thin tissue."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from ... import models
from ..._arrays import Floats, Indices
from ...contact import Contact, press, solve_contact
from ...matrix import response_matrix
from ...obstacle import Obstacle
from ...skin import Body, HalfSpace, Layer, PreparedSkin, cut_out
from ...surface import Surface
from ..memo import remembered
from ..meshes import ball, lattice_faces
from .case import Case, Outcome, holds, near
from .flat import CELL, Form, flat_skin
from .scaling import AS_GIVEN, Build, Setting, off, rounding_limit, scaled_cases

__all__ = ["touch_cases"]

_UP, _DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
_DEPTH = 0.1e-3
_BUMPS = 32
_CELLS = 16  # of a side of a flat skin


def touch_cases() -> Iterator[Case]:
    """Make the cases of odd extents."""
    forms: tuple[Form, ...] = ("collocation", "galerkin")
    for form in forms:
        build: Build = partial(_flat_on_flat, form, _DEPTH)
        yield from scaled_cases("contact", f"flat on flat, {form}", build, smallest=_DEPTH)
        yield Case(
            group="contact",
            name=f"flat on flat, {form}: everything may touch",
            judge=partial(_everything_touches, build),
            quick=True,
        )
        for share in (1e-9, 1e-6, 1e-4):
            judge = partial(_punch_in_proportion, form, share)
            yield Case(group="contact", name=f"flat punch, {form}, {share:g} of its radius deep", judge=judge)
    for name, build in _odd_places().items():
        yield from scaled_cases("contact", name, build, smallest=_DEPTH)
    yield Case(group="contact", name="one node", judge=_one_node, quick=True)
    yield Case(group="contact", name="a thousand patches", judge=_thousand_patches)
    yield from scaled_cases(
        "contact", "a thousand patches", _bumps, smallest=_DEPTH, lengths=(1e-3,), quick=False
    )
    yield Case(group="contact", name="on the edge of a body's cut", judge=_on_a_cut, quick=True)
    for name, product in (("1,000 times coarser", _coarse_plate), ("1,000 times finer", _fine_plate)):
        judge = partial(_other_triangles, product)
        yield Case(group="product", name=f"triangles {name} than the skin's", judge=judge, quick=True)
    for name, build in {"layer": _thin_layer, "body": _thin_body}.items():
        yield from scaled_cases(
            "thin tissue", f"0.2 mm, {name}", build, smallest=0.02e-3, lengths=(1e-3,), quick=False
        )


def _flat(setting: Setting) -> Surface:
    return setting.surface(Surface(*flat_skin(_CELLS)))


def _flat_on_flat(form: Form, depth: float, setting: Setting) -> Contact:
    """Press a plate on the whole of a square."""
    plate = Obstacle.half_space(setting.placed(np.array([0.0, 0.0, 0.01])), _DOWN)
    skin = setting.skin(HalfSpace(discretization=form))
    return press(_flat(setting), plate, skin, _DOWN, depth=depth * setting.length, options=AS_GIVEN)


def _everything_touches(build: Build) -> Outcome:
    contact = build(Setting())
    count, nodes, residual = len(contact.pressure), len(contact.candidates), contact.natural_residual
    return holds(
        f"all {count} vertices in the problem, natural residual below 1e-8",
        f"{nodes}, natural residual {residual:.1e}",
        nodes == count and residual < 1e-8,
    )


def _punch(form: Form, share: float) -> Contact:
    radius = 5.3 * CELL
    punch = Obstacle.cylinder(radius, radius).moved(np.eye(3), [0.0, 0.0, radius * (1.0 - share)])
    return solve_contact(
        _flat(Setting()), punch, Setting().skin(HalfSpace(discretization=form)), options=AS_GIVEN
    )


def _punch_in_proportion(form: Form, share: float) -> Outcome:
    """A flat punch is a linear problem: the force over the depth does not change."""
    # Far less than the way from any vertex or middle of an edge to the rim: all gaps are those of the flat
    # end.
    deep = 1e-5
    here, there = _punch(form, deep), _punch(form, share)
    error = off(there, here, force=share / deep) if here.max_pressure > 0.0 else np.inf
    limit = rounding_limit(here, share * 5.3 * CELL)
    # Averages reach beyond the rim, where the gap is no multiple of the depth.
    averaged = max(share, deep)
    return near(
        "force in proportion to the depth", error, max(limit, averaged) if form == "galerkin" else limit
    )


def _odd_places() -> dict[str, Build]:
    """Return a sphere at the border of the mesh, at its corner, and one of few cells over a single vertex."""
    edge = 8 * CELL
    return {
        "at a border": partial(_sphere_at, (edge, 0.3 * CELL), 40 * CELL),
        "at a corner": partial(_sphere_at, (edge, edge), 40 * CELL),
        "smaller than a cell": partial(_sphere_at, (0.3 * CELL, 0.2 * CELL), 0.9 * CELL),
    }


def _sphere_at(place: tuple[float, float], radius: float, setting: Setting) -> Contact:
    sphere = Obstacle.sphere(setting.placed(np.array([*place, 2 * radius])), radius * setting.length)
    depth = _DEPTH * setting.length
    return press(_flat(setting), sphere, setting.skin(HalfSpace()), _DOWN, depth=depth, options=AS_GIVEN)


def _one_node() -> Outcome:
    """One vertex that touches carries the depth over its own compliance."""
    points, faces = flat_skin(_CELLS)
    middle = len(points) // 2
    points[middle, 2] += 2 * _DEPTH
    surface, skin = Surface(points, faces), Setting().skin(HalfSpace())
    plate = Obstacle.half_space([0, 0, 0.01], _DOWN)
    contact = press(surface, plate, skin, _DOWN, depth=_DEPTH, options=AS_GIVEN)
    compliance = float(response_matrix(surface, skin, [middle])[0, 0])
    error = abs(-contact.force[2] * compliance / _DEPTH - 1.0)
    # The diagonal's quadrature is the same in both.
    return near("depth over compliance", error, rounding_limit(contact, _DEPTH))


def _bumps(setting: Setting) -> Contact:
    """Press a plate on 32 x 32 bumps of four cells each."""
    cells = 4 * _BUMPS
    x = np.arange(cells + 1) * CELL
    across, along = np.meshgrid(x, x, indexing="ij")
    high = np.sin(np.pi * across / (4 * CELL)) ** 2 * np.sin(np.pi * along / (4 * CELL)) ** 2
    points = np.stack([across, along, CELL * high], -1).reshape(-1, 3)
    surface = setting.surface(Surface(points, lattice_faces(cells, cells)))
    plate = Obstacle.half_space(setting.placed(np.array([0.0, 0.0, 0.01])), _DOWN)
    depth = _DEPTH * setting.length
    return press(surface, plate, setting.skin(HalfSpace()), _DOWN, depth=depth, options=AS_GIVEN)


def _thousand_patches() -> Outcome:
    contact = _bumps(Setting())
    residual = contact.natural_residual
    return holds(
        f"{_BUMPS**2} patches, natural residual below 1e-8",
        f"{len(contact.patches)} patches, natural residual {residual:.1e}",
        len(contact.patches) == _BUMPS**2 and residual < 1e-8,
    )


def _on_a_cut() -> Outcome:
    """A body pressed beside the vertices that are held."""
    finger = models.finger(edge_length=3e-3)
    tip = int(np.argmax(finger.vertices[:, 1]))
    part = cut_out(finger, tip=tip, point=[0, 0.04, 0], normal=[0, 1, 0])
    plate = Obstacle.half_space([0.0, 0.0, -0.05], _UP).moved(_leaning(), [0.0, 0.0, 0.0])
    direction = _leaning() @ np.array(_UP)
    free = np.flatnonzero(~part.fixed)
    prepared = Setting().skin(part.body()).prepared(part.surface, free)
    pressed = press(part.surface, plate, prepared, direction, depth=1e-3, options=AS_GIVEN, throw=False)
    return holds("solved", str(pressed.status), pressed.status == "solved")


def _leaning() -> Floats:
    """Return the turn by which a plate comes down on the edge of the cut."""
    angle = np.radians(40.0)
    return np.array(
        [[1.0, 0.0, 0.0], [0.0, np.cos(angle), np.sin(angle)], [0.0, -np.sin(angle), np.cos(angle)]]
    )


def _coarse_plate() -> Obstacle:
    return Obstacle.box([1000 * CELL, 1000 * CELL, CELL]).moved(np.eye(3), [0, 0, 3 * CELL])


def _fine_plate() -> Obstacle:
    """Return a slab whose upper and lower faces have cells of a thousandth of the skin's in the middle."""
    steps = CELL * np.concatenate([np.linspace(0.0, 0.02, 21), np.geomspace(0.03, 20.0, 20)])
    line = np.concatenate([-steps[:0:-1], steps])
    count = len(line) - 1
    across, along = np.meshgrid(line, line, indexing="ij")
    flat = np.stack([across, along, np.zeros_like(across)], -1).reshape(-1, 3)
    faces = lattice_faces(count, count)
    return _slab(flat, faces, count)


def _slab(flat: Floats, faces: Indices, count: int) -> Obstacle:
    """Return a closed slab, `flat` below and above, 2 mm thick."""
    index = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    lift = np.array([0.0, 0.0, 2 * CELL])
    rim = np.concatenate([index[:-1, 0], index[-1, :-1], index[:0:-1, -1], index[0, :0:-1]])
    after, upper = np.roll(rim, -1), len(flat)
    sides = np.concatenate(
        [np.stack([rim, after, after + upper], 1), np.stack([rim, after + upper, rim + upper], 1)]
    )
    points = np.vstack([flat + lift, flat + 2 * lift])
    every = np.concatenate([faces[:, ::-1], faces + upper, sides])
    return Obstacle.mesh(points, every, check_crossings=False)


def _other_triangles(product: Any) -> Outcome:
    """The triangles of a flat product change nothing."""
    skin, surface = Setting().skin(HalfSpace()), Surface(*_dome())
    plate = Obstacle.half_space([0, 0, 0.01], _DOWN)
    here = press(surface, plate, skin, _DOWN, depth=_DEPTH, options=AS_GIVEN)
    there = press(surface, product(), skin, _DOWN, depth=_DEPTH, options=AS_GIVEN)
    return near("the contact with a plate", off(there, here), rounding_limit(here, _DEPTH))


def _dome() -> tuple[Floats, Indices]:
    points, faces = flat_skin(_CELLS)
    points[:, 2] -= (points[:, 0] ** 2 + points[:, 1] ** 2) / (2 * 40 * CELL)
    return points, faces


def _thin_layer(setting: Setting) -> Contact:
    surface = setting.surface(Surface(*_dome()))
    plate = Obstacle.half_space(setting.placed(np.array([0.0, 0.0, 0.01])), _DOWN)
    skin = setting.skin(Layer(thickness=0.2e-3 * setting.length))
    return press(surface, plate, skin, _DOWN, depth=0.02e-3 * setting.length, options=AS_GIVEN)


def _thin_body(setting: Setting) -> Contact:
    surface, prepared = _thin_prepared(setting)
    plate = Obstacle.half_space(setting.placed(np.array([0.0, 0.0, -0.05])), _UP)
    return press(surface, plate, prepared, _UP, depth=0.02e-3 * setting.length, options=AS_GIVEN)


@remembered
def _thin_prepared(setting: Setting) -> tuple[Surface, PreparedSkin]:
    """Return a sphere of 8 mm with 0.2 mm of tissue on its core, on meshes drawn towards the pole."""
    shell, core = ball(8e-3, 2, 12.0), ball(7.8e-3, 2, 12.0)
    surface, bone = setting.surface(shell), setting.surface(core)
    nodes = np.flatnonzero(shell.vertices[:, 2] < -7.9e-3)
    return surface, setting.skin(Body(bone=bone, coarse_edge_length=0.0)).prepared(surface, nodes)
