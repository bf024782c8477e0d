"""The built-in fingertip in every response: moduli, Poisson's ratios, lengths, places and depths."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial
from itertools import pairwise
from typing import Any

import numpy as np

from ... import models
from ...contact import Contact, press
from ...errors import PenetrationWarning
from ...obstacle import Obstacle
from ...skin import Body, GaussianCorrected, HalfSpace, Layer, PreparedSkin
from ...surface import Surface, skin_without_caps
from ..memo import remembered
from ..meshes import ball
from .case import Case, Outcome, holds, near
from .scaling import (
    AS_GIVEN,
    Build,
    Setting,
    length_judge,
    modulus_judge,
    off,
    place_judge,
    rounding_limit,
    scaled_cases,
)

__all__ = ["finger_cases"]

_DEPTH = 1.12e-3
_EXTENT = 0.03
_RADIUS = 9e-3
_UP = (0.0, 0.0, 1.0)
_BELOW = (0.0, 0.0, -0.05)
_MODULI = (1.0, 1e3, 1e6, 1e9, 1e12)
_EXTENTS = (1e-6, 1e-3, 1.0, 1e3)
_RATIOS = (0.0, 0.3, 0.49, 0.4999, 0.5 - 1e-12)
_SHALLOW = (1e-12, 1e-10, 1e-8)
_DEEP = (3e-3, 5e-3, 7e-3)


@remembered
def _finger() -> Surface:
    tip = models.fingertip(edge_length=1.6e-3)
    return tip.with_skin_mask(skin_without_caps(tip))


@remembered
def _phone() -> tuple[Any, Any]:
    triangles = models.rounded_box(size=(0.04, 0.04, 0.02), edge_radius=0.004, edge_length=4e-3).triangles()
    assert triangles is not None, "a box of triangles has some"
    return triangles


def _plate(setting: Setting) -> Obstacle:
    return Obstacle.half_space(setting.placed(np.array(_BELOW)), _UP)


def _box(setting: Setting) -> Obstacle:
    vertices, faces = _phone()
    return Obstacle.mesh(setting.placed(vertices + np.array(_BELOW)), faces)


def _half_space(setting: Setting) -> HalfSpace:
    return HalfSpace()


def _galerkin(setting: Setting) -> HalfSpace:
    return HalfSpace(discretization="galerkin")


def _layer(setting: Setting) -> Layer:
    return Layer(thickness=5e-3 * setting.length)


def _gaussian(setting: Setting) -> GaussianCorrected:
    return GaussianCorrected.balanced(width=8e-3 * setting.length, cutoff=15e-3 * setting.length)


def _pressed(
    response: Callable[[Setting], Any], product: Callable[[Setting], Obstacle], depth: float, setting: Setting
) -> Contact:
    surface, skin = setting.surface(_finger()), setting.skin(response(setting))
    return press(surface, product(setting), skin, _UP, depth=depth * setting.length, options=AS_GIVEN)


def _soft(depth: float, setting: Setting) -> Contact:
    """Press a box as soft as the finger."""
    skin = setting.skin(HalfSpace())
    box = _box(setting).with_material(shear_modulus=setting.modulus, poisson_ratio=0.4)
    return press(setting.surface(_finger()), box, skin, _UP, depth=depth * setting.length, options=AS_GIVEN)


def _body(depth: float, setting: Setting) -> Contact:
    """Press a sphere of 8 mm with a core of 3 mm on a plate."""
    skin, prepared = _prepared(setting)
    return press(skin, _plate(setting), prepared, _UP, depth=depth * setting.length, options=AS_GIVEN)


@remembered
def _prepared(setting: Setting) -> tuple[Surface, PreparedSkin]:
    skin, core = setting.surface(ball(8e-3, 2, 2.0)), setting.surface(ball(3e-3, 1, 2.0))
    body = Body(bone=core, coarse_edge_length=0.0)
    nodes = np.flatnonzero(ball(8e-3, 2, 2.0).vertices[:, 2] < 0.0)
    return skin, setting.skin(body).prepared(skin, nodes)


@remembered
def _finger_bone() -> Surface:
    return models.bone_of(_finger())


def _finger_body(setting: Setting) -> Contact:
    """Press the fingertip with its bone, solved on a coarse mesh as is usual."""
    finger, given = setting.surface(_finger()), _finger()
    body = Body(bone=setting.surface(_finger_bone()), fixed=~finger.skin_mask)
    nodes = np.flatnonzero(given.skin_mask & (given.vertices[:, 2] < given.vertices[:, 2].min() + 2e-3))
    prepared = setting.skin(body).prepared(finger, nodes)
    return press(finger, _plate(setting), prepared, _UP, depth=_DEPTH * setting.length, options=AS_GIVEN)


def _ball_body(setting: Setting) -> Contact:
    """Press an icosphere with a core, on a coarse mesh too; its equal edges leave the coarsening ties."""
    shell = ball(8e-3, 2, 3.0)
    skin, core = setting.surface(shell), setting.surface(ball(3e-3, 2))
    nodes = np.flatnonzero(shell.vertices[:, 2] < -6e-3)
    prepared = setting.skin(Body(bone=core)).prepared(skin, nodes)
    return press(skin, _plate(setting), prepared, _UP, depth=0.6e-3 * setting.length, options=AS_GIVEN)


@remembered
def _builds(depth: float) -> dict[str, Build]:
    """Return each way to press to a depth (m); each setting is pressed once."""
    builds: dict[str, Build] = {
        "half-space": partial(_pressed, _half_space, _plate, depth),
        "half-space, mesh product": partial(_pressed, _half_space, _box, depth),
        "half-space, galerkin": partial(_pressed, _galerkin, _plate, depth),
        "layer": partial(_pressed, _layer, _plate, depth),
        "Gaussian, balanced": partial(_pressed, _gaussian, _plate, depth),
        "body": partial(_body, depth),
    }
    return {name: cache(build) for name, build in builds.items()}


def finger_cases() -> Iterator[Case]:
    """Make the cases of the fingertip."""
    for name, build in _builds(_DEPTH).items():
        is_quick = name in ("half-space", "body")
        for modulus in _MODULI:
            judge: Callable[[], Outcome] = partial(modulus_judge, build, _DEPTH, modulus)
            quick = is_quick and modulus in (1.0, 1e12)
            yield Case(group="modulus", name=f"{name}, G = {modulus:g} Pa", judge=judge, quick=quick)
        for extent in _EXTENTS:
            judge = partial(length_judge, build, _DEPTH, extent / _EXTENT)
            quick = is_quick and extent in (1e-6, 1e3)
            yield Case(group="length", name=f"{name}, {extent:g} m long", judge=judge, quick=quick)
        judge = partial(place_judge, build, _DEPTH)
        yield Case(group="place", name=f"{name}, 1 km from the origin", judge=judge, quick=is_quick)
        for nu in _RATIOS:
            scalar = name not in ("layer", "body")
            judge = partial(_half_space_ratio if scalar else _thick_ratio, build, nu)
            quick = is_quick and nu in (0.0, _RATIOS[-1])
            yield Case(
                group="Poisson's ratio", name=f"{name}, nu = {_ratio_name(nu)}", judge=judge, quick=quick
            )
    yield from scaled_cases("elastic product", "box", partial(_soft, _DEPTH), smallest=_DEPTH)
    for name, build in {"fingertip with its bone": _finger_body, "sphere with a core": _ball_body}.items():
        yield from scaled_cases("two levels", name, build, smallest=_DEPTH, quick=False)
    for name in _builds(_DEPTH):
        for share in _SHALLOW:
            judge = partial(_shallow, name, share)
            quick = name == "half-space" and share == _SHALLOW[0]
            yield Case(group="depth", name=f"{name}, {share:g} of the radius deep", judge=judge, quick=quick)
        for depth in _DEEP:
            judge = partial(_deep, name, depth)
            yield Case(group="depth", name=f"{name}, {depth * 1e3:g} mm deep", judge=judge)


def _ratio_name(nu: float) -> str:
    return f"{nu:g}" if nu < 0.4999999 else "0.5 - 1e-12"


def _half_space_ratio(build: Build, nu: float) -> Outcome:
    """On a half-space, and with a Gaussian in proportion to it, ``F (1 - nu)`` does not change."""
    here, there = build(Setting()), build(Setting(nu=nu))
    error = off(there, here, force=(1.0 - Setting().nu) / (1.0 - nu))
    return near("force by 1 / (1 - nu)", error, rounding_limit(here, _DEPTH))


def _thick_ratio(build: Build, nu: float) -> Outcome:
    """Tissue on bone is stiffer the nearer nu is to 1/2, without a jump there."""
    here, there = build(Setting()), build(Setting(nu=nu))
    if nu > 0.4999999:
        # A thin layer changes by some percent from 0.495 to 0.5: a relative 1e-11 for 1e-12.
        return near("the force of nu = 0.5", off(there, here), rounding_limit(here, _DEPTH))
    softer = build(Setting(nu=nu - 0.01)) if nu > 0.0 else None
    forces = [float(np.linalg.norm(one.force)) for one in (softer, there, here) if one is not None]
    return holds(
        "force between its neighbours'",
        " < ".join(f"{force:.6g} N" for force in forces),
        all(a < b for a, b in pairwise(forces)),
    )


def _shallow(name: str, share: float) -> Outcome:
    """So shallow that a single vertex or two of one height touch, the force is in proportion to the depth.

    In Galerkin form a contact smaller than the triangles is no contact, and a warning says what it leaves.
    """
    depth, deeper = share * _RADIUS, 1e-7 * _RADIUS
    here, there = _builds(deeper)[name](Setting()), _builds(depth)[name](Setting())
    size = float(np.linalg.norm(here.force))
    if size == 0.0:
        warned = any(issubclass(one.category, PenetrationWarning) for one in here.warnings)
        found = f"{here.status}, no force at {deeper:g} m, {'' if warned else 'not '}warned of"
        return holds("force in proportion to the depth, or a warning of the penetration", found, warned)
    error = float(np.linalg.norm(there.force / (depth / deeper) - here.force)) / size
    return near("force in proportion to the depth", error, rounding_limit(here, depth))


def _deep(name: str, depth: float) -> Outcome:
    """Up to half the finger: solved, and the deeper the more force."""
    less, more = _builds(0.9 * depth)[name](Setting()), _builds(depth)[name](Setting())
    forces = [float(one.force[2]) for one in (less, more)]
    return holds(
        "solved, and more force than 10 % less deep",
        f"{more.status}, {forces[1]:.4g} N after {forces[0]:.4g} N",
        more.status == "solved" and forces[1] > forces[0] > 0.0,
    )
