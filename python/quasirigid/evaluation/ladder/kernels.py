"""Half-space and layer on the reference problems: mesh, discretization, target and solver."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from ...contact import Contact, ContactOptions, solve_contact
from ...lcp import LcpMethod
from ...skin import Layer, Skin
from .rows import limit_of, make_row, timed
from .scenes import G, Scene, scenes, sphere_scene

__all__ = ["AS_GIVEN", "FORMS", "SOLVERS", "Form", "Task", "flat_skin", "kernel_tasks", "solver_tasks"]

Form = Literal["collocation", "galerkin"]
FORMS: tuple[Form, ...] = ("collocation", "galerkin")
AS_GIVEN = ContactOptions(target_error=None)
# How the scene of the solvers' rows ends.
SOLVERS = ", by each solver"
_GIVEN_CELLS = 3
_USUAL_TARGET = 0.02

# What a run is made of: a name, and the work that makes one row.
Task = tuple[str, Callable[[], dict[str, Any]]]


@dataclass(frozen=True, kw_only=True)
class _Ladder:
    """Which meshes and targets a problem is solved on, and at how many places."""

    cells: tuple[float, ...]
    targets: tuple[float, ...]
    places: int
    forms: tuple[Form, ...] = FORMS


_WHOLE = _Ladder(cells=(3, 6), targets=(0.05, 0.02, 0.01), places=4)
_LADDERS = {
    "sphere": _Ladder(cells=(2, 3, 4, 6, 8, 12), targets=(0.05, 0.02, 0.01, 0.005, 0.002), places=12),
    "cylinder": _Ladder(cells=(3, 4), targets=(0.02,), places=1),
    "sphere on a layer of 2 contact radii": _Ladder(cells=(3, 6), targets=(0.05, 0.02, 0.01), places=2),
    "sphere on a layer of 3.3 contact radii": _Ladder(cells=(), targets=(0.02,), places=2),
    "sphere on a layer of 1.4 contact radii": _Ladder(cells=(), targets=(0.02,), places=2),
}
_QUICK = _Ladder(cells=(4,), targets=(0.02,), places=1, forms=("collocation",))
_QUICK_LADDERS = {
    "sphere": _Ladder(cells=(2, 4, 6), targets=(0.02, 0.005), places=3),
    "cylinder": _Ladder(cells=(3,), targets=(), places=1, forms=("collocation",)),
}


def flat_skin(scene: Scene, form: Form | None) -> Skin:
    """Return the skin of a scene; its form is the package's choice where None."""
    return Skin(shear_modulus=G, poisson_ratio=0.5, response=scene.response(form))


def kernel_tasks(quick: bool) -> Iterator[Task]:
    """Make the ladder of every reference problem on flat skin."""
    ladders, usual = (_QUICK_LADDERS, _QUICK) if quick else (_LADDERS, _WHOLE)
    for scene in scenes():
        ladder = ladders.get(scene.name, usual)
        for form in ladder.forms:
            for cells in ladder.cells:
                work = partial(_over_places, scene, ladder.places, form=form, cells=cells)
                yield f"{scene.name}, {form}, {cells:g} cells", work
        for target in ladder.targets:
            work = partial(_over_places, scene, ladder.places, cells=_GIVEN_CELLS, target=target)
            yield f"{scene.name}, target {target:g}", work
        if not quick:
            # In the form that the package does not take on a refined mesh.
            work = partial(_over_places, scene, 1, form="galerkin", cells=_GIVEN_CELLS, target=_USUAL_TARGET)
            yield f"{scene.name}, galerkin, target {_USUAL_TARGET:g}", work


def solver_tasks(quick: bool) -> Iterator[Task]:
    """Make the solvers of each complementarity problem on one mesh; Galerkin's matrices suit all of them."""
    for scene in (sphere_scene(),) if quick else scenes():
        is_sphere = scene.name == sphere_scene().name
        cells, places = (8, 4) if is_sphere and not quick else (4, 1)
        for method in LcpMethod:
            work = partial(_over_places, scene, places, form="galerkin", cells=cells, method=method)
            yield f"{scene.name}, {method}", work


def _over_places(
    scene: Scene,
    places: int,
    *,
    cells: float,
    form: Form | None = None,
    target: float | None = None,
    method: LcpMethod | None = None,
) -> dict[str, Any]:
    """Return the root mean square errors over places of the product, nodes and time in the median."""
    options = ContactOptions(target_error=target)
    if method is not None:
        options = ContactOptions(target_error=target, method=method)
    skin = flat_skin(scene, form)
    rows = []
    for place in range(places):
        surface = scene.surface(np.random.default_rng(place), cells)
        contact, seconds = timed(partial(solve_contact, surface, scene.obstacle, skin, options=options))
        rows.append(_numbers(scene, contact) | {"seconds": seconds})
    numbers = {name: [row[name] for row in rows] for name in rows[0]}
    errors = ("force_error", "area_error", "max_pressure_error")
    means = {name: _known(_root_mean_square, numbers[name]) for name in errors}
    medians = {name: _known(np.median, values) for name, values in numbers.items() if name not in errors}
    return make_row(
        scene=scene.name if method is None else scene.name + SOLVERS,
        response="layer" if isinstance(skin.response, Layer) else "half-space",
        discretization=contact.accuracy.discretization,
        solver=str(options.method),
        mesh="as it is" if target is None else "refined",
        cells_per_radius=cells,
        target_error=target,
        truth=scene.truth,
        truth_accuracy=scene.truth_accuracy,
        limit=limit_of(cells=cells, target=target, accuracy=scene.truth_accuracy),
        **means,
        **medians,
    )


def _numbers(scene: Scene, contact: Contact) -> dict[str, float | None]:
    """Return the figures of one contact, and their errors."""
    found, true = scene.figures(contact)
    errors = [None if a is None or b is None else a / b - 1.0 for a, b in zip(found, true, strict=True)]
    names = ("force_error", "area_error", "max_pressure_error")
    return {
        "nodes": float(len(contact.candidates)),
        "force": found[0],
        "true_force": true[0],
        "estimated_force_error": contact.accuracy.force_error,
        **dict(zip(names, errors, strict=True)),
    }


def _known(mean: Callable[[Any], Any], values: list[float | None]) -> float | None:
    numbers = [value for value in values if value is not None]
    return float(mean(numbers)) if numbers else None


def _root_mean_square(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
