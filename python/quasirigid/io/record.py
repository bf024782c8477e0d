"""The scalars of a contact with their units, as plain dictionaries for JSON and reports."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .._core import __version__

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..contact.accuracy import Accuracy, Refinement
    from ..contact.parts import Part, Patch
    from ..contact.result import Contact
    from ..contact.warned import Warned
    from ..obstacle import Obstacle

__all__ = [
    "PATCH_UNITS",
    "as_plain",
    "contact_record",
    "figure",
    "figures",
    "inputs_record",
    "patch_figures",
    "warnings_record",
]

# Unit of each figure; "1" is dimensionless.
_CONTACT = {
    "force": "N",
    "moment": "N m",
    "center_of_pressure": "m",
    "contact_area": "m^2",
    "max_pressure": "Pa",
    "volume_change": "m^3",
    "max_penetration_before": "m",
    "max_penetration_after": "m",
    "obstacle_share": "1",
    "travel": "m",
    "depth": "m",
    "fade_distance": "m",
    "natural_residual": "1",
}
_REFINEMENT = {
    "force": "N",
    "contact_area": "m^2",
    "max_pressure": "Pa",
    "force_error": "1",
    "area_error": "1",
    "max_penetration": "m",
    "seconds": "s",
}
_ACCURACY = dict.fromkeys(
    (
        "natural_residual",
        "complementarity",
        "integration_tolerance",
        "condition",
        "cells_per_radius",
        "force_error",
        "mesh_error",
        "body_error",
        "area_error",
        "max_pressure_error",
    ),
    "1",
)
# Of patches and parts.
PATCH_UNITS = {
    name: _CONTACT[name] for name in ("force", "moment", "center_of_pressure", "contact_area", "max_pressure")
} | {"mean_pressure": "Pa"}
# What `Obstacle` makes each primitive of: its arguments, how many numbers each, and their units.
_SHAPES = {
    "half_space": (("point", 3, "m"), ("normal", 3, "1")),
    "sphere": (("center", 3, "m"), ("radius", 1, "m")),
    "box": (("half_extents", 3, "m"),),
    "capsule": (("a", 3, "m"), ("b", 3, "m"), ("radius", 1, "m")),
    "cylinder": (("half_height", 1, "m"), ("radius", 1, "m")),
}
# Areas (m²) over which the whole contact has its mean pressures.
MEAN_AREAS = {"1 cm²": 1e-4, "1 mm²": 1e-6}
NOT_REACHED = "not_reached"  # status of a contact that is the nearest to what was asked for


def contact_record(contact: Contact, *, unreached: str | None = None) -> dict[str, Any]:
    """Return everything about a contact but its arrays.

    Parameters
    ----------
    contact : Contact
        The contact.
    unreached : str, optional
        Of a contact that only comes nearest to what was asked for, why that is out of reach: the status is
        "not_reached" then, and this the advice.

    Returns
    -------
    dict
        Ready for JSON: figures in SI as ``{"value": ..., "unit": ...}``; what is not known (nan, no estimate)
        is None, an infinite error the word "Infinity", as `as_plain` writes it.
    """
    return {
        "quasirigid": __version__,
        "status": str(contact.status) if unreached is None else NOT_REACHED,
        "advice": contact.advice if unreached is None else unreached,
        **figures(contact, _CONTACT),
        "mean_pressure": [
            figure(mean_pressure(contact, area), "Pa") | {"area": figure(area, "m^2")}
            for area in MEAN_AREAS.values()
        ],
        "vertices": len(contact.pressure),
        "given_vertex_count": contact.given_vertex_count,
        "refinements": [_refinement(one) for one in contact.refinements],
        "candidates": len(contact.candidates),
        "active": len(contact.active),
        "patches": [{"vertices": len(patch.vertices)} | patch_figures(patch) for patch in contact.patches],
        "accuracy": _accuracy(contact.accuracy),
        "timings": {stage: figure(seconds, "s") for stage, seconds in contact.timings.items()},
        "warnings": warnings_record(contact.warnings),
        "left_out": [{"what": what, "why": why} for what, why in contact.left_out],
        "product": _product(contact),
    }


def mean_pressure(contact: Contact, area: float) -> float | None:
    """Return the largest mean pressure over an area (m²); None where the cells of the mesh are larger."""
    # One node force over the disc would be as high as the peak.
    is_within_cell = np.max(contact.node_force) > area * contact.max_pressure
    return None if is_within_cell else contact.mean_pressure(area)


def warnings_record(warnings: Iterable[Warned]) -> list[dict[str, str]]:
    """Return the category and the message of each warning."""
    return [{"category": category.__name__, "message": message} for category, message in warnings]


def inputs_record(inputs: Mapping[str, Any] | None) -> Any:
    """Return what a contact was computed from as what JSON holds.

    Raises
    ------
    TypeError
        If it is no mapping; a ValueError of one that holds itself.
    """
    if inputs is not None and not isinstance(inputs, Mapping):
        raise TypeError(f"inputs is a {type(inputs).__name__}, expected a mapping of names to values")
    try:
        return as_plain(inputs or {})
    except RecursionError:
        raise ValueError("inputs holds itself, or mappings and lists too deep in each other") from None


def _refinement(one: Refinement) -> dict[str, Any]:
    return {"kind": str(one.kind), "nodes": one.nodes, "reason": one.reason} | figures(one, _REFINEMENT)


def _accuracy(accuracy: Accuracy) -> dict[str, Any]:
    words = {"discretization": str(accuracy.discretization), "definite": accuracy.definite}
    return words | figures(accuracy, _ACCURACY)


def as_plain(value: Any) -> Any:
    """Return any value as what JSON holds: what is like an array as lists, nan as None, infinity as a word.

    The word is "Infinity" or "-Infinity", which ``float`` reads, and ``Number`` in JavaScript.
    """
    if value is None or isinstance(value, (bool, int)):
        return value
    if isinstance(value, float):
        if math.isinf(value):
            return "Infinity" if value > 0.0 else "-Infinity"
        return None if math.isnan(value) else value
    if isinstance(value, Mapping):
        return {str(key): as_plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [as_plain(entry) for entry in value]
    if hasattr(value, "__array__") and not isinstance(value, type):
        return as_plain(_listed(value if isinstance(value, np.ndarray) else np.asarray(value)))
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        public = (field.name for field in dataclasses.fields(value) if not field.name.startswith("_"))
        return {"type": type(value).__name__} | {name: as_plain(getattr(value, name)) for name in public}
    return str(value)


def _listed(array: NDArray[Any]) -> Any:
    """Return what an array holds as numbers and words of Python."""
    # Python has no such numbers, nor times to the nanosecond: `tolist` would leave them, or count.
    plain = {np.dtype(np.longdouble): np.float64, np.dtype(np.clongdouble): np.complex128}
    kind = np.str_ if array.dtype.kind in "mM" else plain.get(array.dtype)
    return (array if kind is None else array.astype(kind)).tolist()


def figure(value: Any, unit: str) -> dict[str, Any]:
    """Return a number or a list of numbers in SI with its unit, ready for JSON."""
    return {"value": as_plain(value), "unit": unit}


def figures(source: Any, units: Mapping[str, str]) -> dict[str, Any]:
    """Return attributes in SI with their units, ready for JSON."""
    return {name: figure(getattr(source, name), unit) for name, unit in units.items()}


def patch_figures(patch: Part | Patch) -> dict[str, Any]:
    """Return what a patch or a part of the skin holds, ready for JSON."""
    return figures(patch, PATCH_UNITS)


def _product(contact: Contact) -> dict[str, Any]:
    obstacle = contact.obstacle
    return {
        "kind": obstacle.kind,
        "shape": _shape(obstacle),
        "rotation": as_plain(obstacle.rotation),
        "translation": figure(obstacle.translation, "m"),
        "bounding_box": figure(obstacle.bounding_box, "m"),
        "material": _material(obstacle),
    }


def _shape(obstacle: Obstacle) -> dict[str, Any] | None:
    """Return the arguments that make a primitive, before rotation and translation; None of a mesh."""
    if obstacle.kind not in _SHAPES:
        return None
    _, numbers, *_ = obstacle.__reduce__()[1]
    shape, at = {}, 0
    for name, count, unit in _SHAPES[obstacle.kind]:
        shape[name] = figure(numbers[at] if count == 1 else numbers[at : at + count], unit)
        at += count
    return shape


def _material(obstacle: Obstacle) -> dict[str, Any] | None:
    if obstacle.material is None:
        return None
    shear_modulus, poisson_ratio, response = obstacle.material
    return {
        "shear_modulus": figure(shear_modulus, "Pa"),
        "poisson_ratio": figure(poisson_ratio, "1"),
        "response": repr(response),
    }
