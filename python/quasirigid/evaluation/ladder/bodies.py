"""Bodies with a bone: a sphere on a rigid core against finite elements, and the built-in fingertip."""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from ... import models, reference
from ...contact import Contact, ContactOptions, press
from ...obstacle import Obstacle
from ...skin import Body, PreparedSkin, Skin
from ...surface import Surface, skin_without_caps
from ..memo import remembered
from ..meshes import ball
from .kernels import AS_GIVEN, Task
from .rows import limit_of, make_row, timed

__all__ = ["body_tasks"]

_UP = np.array([0.0, 0.0, 1.0])
_PLATE = Obstacle.half_space([0, 0, -0.2], _UP)
_TARGET = 0.02
_FINGER_DEPTH = 1.12e-3
# Edges and target of the fingertip that stands for the truth.
_FINEST = (0.8e-3, 0.005)


def body_tasks(quick: bool) -> Iterator[Task]:
    """Make the cored sphere on one level and on two, then the fingertip on several meshes."""
    for known in reference.plate_on_cored_sphere()[: 1 if quick else None]:
        for levels, length in (("two", None),) if quick else (("one", 0.0), ("two", None)):
            for depth, force in list(known.indentations.items())[2 if quick else 1 :]:
                for target in (None, _TARGET):
                    name = f"cored sphere, nu = {known.poisson_ratio:g}, {levels} levels, {depth * 1e3:g} mm"
                    yield name, partial(_cored_sphere, known, depth, force, length, target)
    if quick:
        return
    for edge in (2.0e-3, 1.6e-3, 1.2e-3):
        for target in (None, _TARGET):
            yield f"fingertip, edges of {edge * 1e3:g} mm", partial(_fingertip, edge, target)


@remembered
def _prepared_sphere(
    radius: float, core_radius: float, nu: float, length: float | None
) -> tuple[Surface, PreparedSkin, float]:
    """Return sphere, prepared body and the time that took (s)."""
    skin, core = ball(radius, 3), ball(core_radius, 3)
    nodes = np.flatnonzero(skin.vertices[:, 2] < skin.vertices[:, 2].min() + 0.5 * radius)
    started = time.perf_counter()
    response = Body(bone=core, coarse_edge_length=length)
    prepared = Skin(
        shear_modulus=reference.plate_on_cored_sphere()[0].shear_modulus, poisson_ratio=nu, response=response
    ).prepared(skin, nodes)
    return skin, prepared, time.perf_counter() - started


def _cored_sphere(
    known: reference.CoredSphere, depth: float, true: float, length: float | None, target: float | None
) -> dict[str, Any]:
    skin, prepared, setup = _prepared_sphere(known.radius, known.core_radius, known.poisson_ratio, length)
    contact, seconds = _pressed(skin, prepared, depth, target)
    return _row(
        contact,
        seconds,
        scene=f"sphere with a core, nu = {known.poisson_ratio:g}",
        response="body on its own mesh" if length == 0.0 else "body",
        depth=depth,
        target=target,
        setup_seconds=setup,
        true=true,
        truth="axisymmetric finite elements and the series of the shell (quasirigid.reference)",
        accuracy=known.accuracy,
    )


@remembered
def _prepared_finger(edge: float) -> tuple[Surface, PreparedSkin, float]:
    """Return fingertip, prepared body and the time that took (s)."""
    finger = models.fingertip(edge_length=edge)
    finger = finger.with_skin_mask(skin_without_caps(finger))
    low = finger.vertices[:, 2].min()
    nodes = np.flatnonzero(finger.skin_mask & (finger.vertices[:, 2] < low + 2.5e-3))
    started = time.perf_counter()
    response = Body(bone=models.bone_of(finger), fixed=~finger.skin_mask)
    prepared = Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response).prepared(finger, nodes)
    return finger, prepared, time.perf_counter() - started


@remembered
def _finest_finger() -> tuple[float, float]:
    """Return force (N) on the finest fingertip, and how exact that is taken to be."""
    edge, target = _FINEST
    finger, prepared, _ = _prepared_finger(edge)
    contact, _ = _pressed(finger, prepared, _FINGER_DEPTH, target)
    return float(contact.force[2]), max(target, contact.accuracy.force_error or 0.0)


def _fingertip(edge: float, target: float | None) -> dict[str, Any]:
    finger, prepared, setup = _prepared_finger(edge)
    contact, seconds = _pressed(finger, prepared, _FINGER_DEPTH, target)
    true, accuracy = _finest_finger()
    return _row(
        contact,
        seconds,
        scene=f"built-in fingertip, edges of {edge * 1e3:g} mm",
        response="body",
        depth=_FINGER_DEPTH,
        target=target,
        setup_seconds=setup,
        true=true,
        truth=f"the same on edges of {_FINEST[0] * 1e3:g} mm, target {_FINEST[1]:g}",
        accuracy=accuracy,
        note=f"{len(finger.vertices)} vertices",
    )


def _pressed(
    skin: Surface, prepared: PreparedSkin, depth: float, target: float | None
) -> tuple[Contact, float]:
    options = AS_GIVEN if target is None else ContactOptions(target_error=target)
    return timed(partial(press, skin, _PLATE, prepared, _UP, depth=depth, options=options))


def _row(
    contact: Contact, seconds: float, *, target: float | None, true: float, accuracy: float, **given: Any
) -> dict[str, Any]:
    force, cells = float(contact.force[2]), contact.accuracy.cells_per_radius
    return make_row(
        discretization=contact.accuracy.discretization,
        solver=str(AS_GIVEN.method),
        mesh="as it is" if target is None else "refined",
        cells_per_radius=cells,
        target_error=target,
        nodes=len(contact.candidates),
        force=force,
        true_force=true,
        force_error=force / true - 1.0,
        estimated_force_error=contact.accuracy.force_error,
        seconds=seconds,
        truth_accuracy=accuracy,
        limit=limit_of(cells=cells, target=target, accuracy=accuracy),
        **given,
    )
