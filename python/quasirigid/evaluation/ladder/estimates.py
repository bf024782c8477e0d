"""How often the errors of random contacts of Hertz are within their estimates, and by how much."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from ...contact import ContactOptions, solve_contact
from .kernels import AS_GIVEN, FORMS, Form, Task, flat_skin
from .rows import make_row
from .scenes import sphere_scene

__all__ = ["CASES", "FIGURES", "estimate_tasks"]

CASES = 60
FIGURES = ("force", "area", "max_pressure")


def estimate_tasks(quick: bool) -> Iterator[Task]:
    """Make the rows for meshes as they are and refined, both forms; a quick run has none."""
    if quick:
        return
    for refined in (False, True):
        for form in FORMS:
            mesh = "refined" if refined else "as it is"
            yield f"estimates, {mesh}, {form}", partial(_estimates, refined, form)


def _estimates(refined: bool, form: Form) -> dict[str, Any]:
    """Return, for each figure, the share of errors within the estimate and the median of their ratio."""
    scene, random = sphere_scene(), np.random.default_rng(1)
    errors, known = np.empty((2, CASES, len(FIGURES)))
    for case in range(CASES):
        cells = math.exp(random.uniform(math.log(2), math.log(8)))
        surface = scene.surface(random, cells, random.uniform(0.0, 0.3), random.uniform(60.0, 120.0))
        target = math.exp(random.uniform(math.log(0.005), math.log(0.05)))
        options = ContactOptions(target_error=target) if refined else AS_GIVEN
        contact = solve_contact(surface, scene.obstacle, flat_skin(scene, form), options=options)
        found, true = scene.figures(contact)
        errors[case] = [abs((a or 0.0) / (b or 1.0) - 1.0) for a, b in zip(found, true, strict=True)]
        known[case] = [getattr(contact.accuracy, f"{figure}_error") for figure in FIGURES]
    within, ratio = (errors <= known).mean(axis=0), np.median(known / errors, axis=0)
    return make_row(
        scene="estimates",
        response="half-space",
        discretization=form,
        mesh="refined" if refined else "as it is",
        nodes=CASES,
        truth=scene.truth,
        truth_accuracy=scene.truth_accuracy,
        within=dict(zip(FIGURES, within.tolist(), strict=True)),
        ratio=dict(zip(FIGURES, ratio.tolist(), strict=True)),
    )
