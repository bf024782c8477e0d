"""The scalars of a contact with their units, as plain dictionaries for JSON, tables and reports."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ..contact.result import Contact

__all__ = ["contact_summary"]

# Unit of each figure of a contact; "1" is dimensionless.
UNITS = {
    "force": "N",
    "moment": "N m",
    "center_of_pressure": "m",
    "contact_area": "m^2",
    "max_pressure": "Pa",
    "volume_change": "m^3",
    "max_penetration_before": "m",
    "max_penetration_after": "m",
    "travel": "m",
    "fade_distance": "m",
    "natural_residual": "1",
}
ACCURACY_UNITS = {"area_resolution": "m^2"}
PATCH_UNITS = {
    "force": "N",
    "moment": "N m",
    "center_of_pressure": "m",
    "contact_area": "m^2",
    "max_pressure": "Pa",
}


def contact_summary(contact: Contact) -> dict[str, Any]:
    """Everything about a contact but its arrays.

    Parameters
    ----------
    contact : Contact
        What to sum up.

    Returns
    -------
    dict
        Ready for JSON: figures as {"value", "unit"}, numbers that are not finite as None.
    """
    return {
        "status": str(contact.status),
        "advice": contact.advice,
        **{name: _figure(getattr(contact, name), unit) for name, unit in UNITS.items()},
        "vertices": len(contact.pressure),
        "candidates": len(contact.candidates),
        "active": len(contact.active),
        "patches": [
            {"vertices": len(patch.vertices)}
            | {name: _figure(getattr(patch, name), unit) for name, unit in PATCH_UNITS.items()}
            for patch in contact.patches
        ],
        "accuracy": {
            name: value if isinstance(value, bool) else _figure(value, ACCURACY_UNITS.get(name, "1"))
            for name, value in plain(contact.accuracy).items()
        },
        "timings": {stage: _figure(seconds, "s") for stage, seconds in contact.timings.items()},
        "left_out": [{"what": what, "why": why} for what, why in contact.left_out],
    }


def plain(value: Any) -> Any:
    """Any value as what JSON holds; arrays become lists and numbers that are not finite None."""
    if value is None or isinstance(value, (bool, str)):
        return value if not isinstance(value, str) else str(value)
    if isinstance(value, (np.bool_, np.integer, np.floating)):
        return plain(value.item())
    if isinstance(value, (int, float)):
        return value if math.isfinite(value) else None
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    return str(value)


def _figure(value: Any, unit: str) -> dict[str, Any]:
    return {"value": plain(value), "unit": unit}
