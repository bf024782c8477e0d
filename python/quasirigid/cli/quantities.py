"""Quantities as people write them on the command line: a number and its unit, `1.12mm` or `0,0,90deg`."""

from __future__ import annotations

import math
import re

from ..errors import QuasirigidError

__all__ = [
    "QuantityError",
    "parse_goal",
    "parse_not_negative",
    "parse_numbers",
    "parse_positive",
    "parse_quantities",
    "parse_steps",
]

# One of each unit, in SI.
LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "inch": 0.0254}
FORCE = {"N": 1.0, "kN": 1e3, "mN": 1e-3}
STRESS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6}
MASS = {"kg": 1.0, "g": 1e-3}
ANGLE = {"rad": 1.0, "deg": math.pi / 180.0}
COMPLIANCE = {"m/N": 1.0, "mm/N": 1e-3}

_EXAMPLES = (("1.12", "mm"), ("5", "N"), ("60", "kPa"), ("0.3", "kg"), ("90", "deg"), ("0.8", "mm/N"))
_STEPS_EXAMPLE = "1:5:9"

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")

_STEPS = re.compile(
    rf"(?P<first>{_NUMBER.pattern})\s*:\s*(?P<last>{_NUMBER.pattern})\s*:\s*(?P<count>\d+)\s*(?P<unit>[^\d:]*)"
)
_MOST_STEPS = 10_000


class QuantityError(QuasirigidError, ValueError):
    """A quantity on the command line is not understood; the message names the units it may have."""


def parse_positive(text: str, units: dict[str, float], what: str) -> float:
    """Read one number above 0 with its unit, in SI."""
    (value,) = parse_quantities(text, 1, units, what)
    if not value > 0.0:
        raise QuantityError(f"{what}: '{text}' is not above 0")
    return value


def parse_not_negative(text: str, units: dict[str, float], what: str) -> float:
    """Read one number from 0 on with its unit, in SI."""
    (value,) = parse_quantities(text, 1, units, what)
    if value < 0.0:
        raise QuantityError(f"{what}: '{text}' is below 0")
    return value


def parse_quantities(text: str, count: int, units: dict[str, float], what: str) -> list[float]:
    """Read `count` numbers parted by commas, in SI; one unit at the end counts for all before it.

    `what` is the option's name, for messages.

    Examples
    --------
    >>> parse_quantities("0,0,-20mm", 3, LENGTH, "--translate")
    [0.0, 0.0, -0.02]
    """
    parts = _parts(text, count, what)
    values: list[float] = []
    factor: float | None = None
    # From the last one, so that a unit reaches back over the bare numbers before it.
    for part in reversed(parts):
        match = _NUMBER.match(part)
        unit = part[match.end() :].strip() if match else ""
        if match is None or (unit and unit not in units):
            raise QuantityError(f"{what}: '{part}' is not a number with a unit, {_expected(units)}")
        if unit:
            factor = units[unit]
        if factor is None:
            raise QuantityError(f"{what}: '{text}' has no unit, {_expected(units)}")
        values.append(_finite(match.group(), what) * factor)
    return values[::-1]


def parse_steps(text: str, units: dict[str, float], what: str) -> list[float]:
    """Read quantities parted by commas, or `first:last:count` with the unit after it, ends included.

    Examples
    --------
    >>> parse_steps("0.5,1,2mm", LENGTH, "--depths")
    [0.0005, 0.001, 0.002]
    >>> parse_steps("1:5:3N", FORCE, "--forces")
    [1.0, 3.0, 5.0]
    """
    if ":" not in text:
        return parse_quantities(text, text.count(",") + 1, units, what)
    match = _STEPS.fullmatch(text.strip())
    if match is None or int(match["count"]) < 2:
        raise QuantityError(
            f"{what}: '{text}' is not of the form first:last:count with a unit and a count of 2 or more,"
            f" as in {_STEPS_EXAMPLE}{_example(units)[1]}"
        )
    count = int(match["count"])
    if count > _MOST_STEPS:
        raise QuantityError(f"{what}: '{text}' has {count} steps, expected at most {_MOST_STEPS}")
    unit = match["unit"]
    if unit not in units:
        found = f"the unit '{unit}'" if unit else "no unit"
        raise QuantityError(f"{what}: '{text}' has {found}, {_expected(units, _STEPS_EXAMPLE)}")
    ends = f"{match['first']},{match['last']}{unit}"
    first, last = parse_quantities(ends, 2, units, what)
    return [first + (last - first) * (step / (count - 1)) for step in range(count)]


def parse_goal(depth: str | None, force: str | None, overlap: str | None) -> dict[str, float]:
    """Return the one that is given of depth (m), force (N) and overlap (m), under its name."""
    words = {"depth": depth, "force": force, "overlap": overlap}
    given = {name: text for name, text in words.items() if text is not None}
    if len(given) != 1:
        found = " and ".join(f"--{name}" for name in given) or "none of them"
        raise QuantityError(f"give one of --depth, --force and --overlap; given: {found}")
    ((name, text),) = given.items()
    parse = parse_not_negative if name == "depth" else parse_positive
    return {name: parse(text, FORCE if name == "force" else LENGTH, f"--{name}")}


def parse_numbers(text: str, count: int, what: str) -> list[float]:
    """Read `count` plain numbers parted by commas.

    Examples
    --------
    >>> parse_numbers("0,0,1", 3, "--direction")
    [0.0, 0.0, 1.0]
    """
    values = []
    for part in _parts(text, count, what):
        if _NUMBER.fullmatch(part) is None:
            raise QuantityError(f"{what}: '{part}' is not a plain number")
        values.append(_finite(part, what))
    return values


def _parts(text: str, count: int, what: str) -> list[str]:
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != count:
        wanted = "one value" if count == 1 else f"{count} values parted by commas"
        raise QuantityError(f"{what}: '{text}' has {len(parts)} values, expected {wanted}")
    return parts


def _finite(text: str, what: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise QuantityError(f"{what}: '{text}' is too large")
    return value


def _expected(units: dict[str, float], sample: str | None = None) -> str:
    """Return the allowed units and an example: not of the number given, which may be meant in SI."""
    *names, last = units
    number, unit = _example(units)
    return f"expected {', '.join(names)} or {last} after it, as in {sample or number}{unit}"


def _example(units: dict[str, float]) -> tuple[str, str]:
    """Return a number and its unit as they are usual of fingers."""
    return next(example for example in _EXAMPLES if example[1] in units)
