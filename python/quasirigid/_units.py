"""Units at the borders of the package: mesh files, tables and pictures. Everything within is SI."""

from __future__ import annotations

from typing import Literal, TypeAlias

from .errors import QuasirigidError

__all__ = ["KPA", "MM", "UNITS", "LengthUnit", "metres_in"]

LengthUnit: TypeAlias = Literal["m", "cm", "mm", "inch"]
"""A unit that a mesh file may have."""

#: Metres in one of each unit that a mesh file may have.
UNITS: dict[LengthUnit, float] = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "inch": 0.0254}

MM = 1e3  # millimetres in a metre
KPA = 1e-3  # kilopascals in a pascal


def metres_in(unit: LengthUnit, refusal: type[QuasirigidError]) -> float:
    """Return the metres in one of `unit`; a `refusal` names the units there are."""
    if not isinstance(unit, str) or unit not in UNITS:
        *others, last = map(repr, UNITS)
        raise refusal(f"unit is {unit!r}, expected {', '.join(others)} or {last}")
    return UNITS[unit]
