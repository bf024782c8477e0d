"""Checks of arguments; a refusal names the argument, what was found and what is expected."""

from __future__ import annotations

import operator
import sys
from enum import StrEnum
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from .errors import QuasirigidError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

Refusal = type[QuasirigidError]
_Choice = TypeVar("_Choice", bound=StrEnum)


def as_number(name: str, value: Any, refusal: Refusal, least: float = 0.0, most: float = np.inf) -> float:
    """Return a finite number above 0, at least `least` and at most `most`."""
    try:
        number = float("nan") if isinstance(value, (str, bytes)) else float(value)
    except (TypeError, ValueError):
        number = float("nan")
    if np.isfinite(number) and number > 0.0 and least <= number <= most:
        return number
    wanted = "above 0" if most == np.inf else f"from {least:g} to {most:g}"
    raise refusal(f"{name} is {value!r}, expected a number {wanted}")


def as_vector(name: str, value: Any, refusal: Refusal) -> NDArray[np.float64]:
    """Return three finite numbers."""
    try:
        vector = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        vector = np.empty(0)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise refusal(f"{name} is {short(value)}, expected three finite numbers")
    return vector


def as_direction(name: str, value: Any, refusal: Refusal) -> NDArray[np.float64]:
    """Return the unit vector along three finite numbers that are not all 0."""
    vector = as_vector(name, value, refusal)
    largest = np.abs(vector).max()
    if largest == 0.0:
        raise refusal(f"{name} is {short(value)}, expected a direction")
    scaled: NDArray[np.float64] = vector / largest
    return scaled / np.linalg.norm(scaled)


def as_mask(name: str, value: Any, count: int, refusal: Refusal) -> NDArray[np.bool_]:
    """Return one boolean for each of `count` vertices.

    Raises
    ------
    TypeError
        If they are no booleans; a `refusal` if there are more or fewer.
    """
    try:
        mask = np.asarray(value)
    except ValueError:
        raise TypeError(f"`{name}` is {short(value)}, expected an array of booleans") from None
    if mask.dtype != np.bool_:
        remedy = f": np.isin(np.arange({count}), numbers) makes them of vertex numbers"
        raise TypeError(
            f"`{name}` has dtype {mask.dtype}, expected booleans, one per vertex"
            + remedy * np.issubdtype(mask.dtype, np.integer)
        )
    if mask.ndim != 1:
        raise refusal(f"`{name}` has shape {mask.shape}, expected ({count},)")
    if len(mask) != count:
        raise refusal(f"`{name}` has {len(mask)} entries, but the skin has {count} vertices")
    return mask


def as_integer(name: str, value: Any, refusal: type[ValueError] = ValueError) -> int:
    """Return an integer >= 0.

    Raises
    ------
    TypeError
        If it is a boolean or would have to be rounded; a `refusal` if it is out of range.
    """
    is_boolean = isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b"
    try:
        number = None if is_boolean else operator.index(value)
    except TypeError:
        number = None
    if number is None:
        raise TypeError(f"{name} is {value!r}, expected an integer")
    if not 0 <= number <= sys.maxsize:
        raise refusal(f"{name} is {number}, expected an integer of at least 0 and at most {sys.maxsize}")
    return number


def as_integer_or_none(name: str, value: Any, refusal: type[ValueError] = ValueError) -> int | None:
    """Return None, or what `as_integer` does."""
    return None if value is None else as_integer(name, value, refusal)


def as_integers(name: str, values: Iterable[Any]) -> list[int]:
    """Return a list of integers >= 0."""
    try:
        listed = list(values)
    except TypeError:
        raise TypeError(f"{name} is {values!r}, expected a sequence of integers") from None
    return [as_integer(f"{name}[{place}]", value) for place, value in enumerate(listed)]


def as_index(name: str, value: Any, count: int, refusal: Refusal) -> int:
    """Return the number of one of `count` vertices.

    Raises
    ------
    TypeError
        If it is no whole number; a `refusal` if there is no such vertex.
    """
    try:
        index = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {short(value)}, expected the number of a vertex") from None
    if not 0 <= index < count:
        raise refusal(f"{name} vertex {index}: the skin has vertices 0 to {count - 1}")
    return index


def as_choice(name: str, value: Any, kind: type[_Choice], refusal: Refusal) -> _Choice:
    """Return a member of an enumeration, given itself or by its word."""
    try:
        return kind(value)
    except ValueError:
        known = ", ".join(f'"{member}"' for member in kind)
        raise refusal(f"{name} is {value!r}, expected one of {known}") from None


def short(value: Any) -> str:
    """Return what a value is on one short line."""
    if isinstance(value, np.ndarray):
        if value.size > 6:
            return f"an array of shape {value.shape}"
        value = value.tolist()
    text = repr(str(value) if isinstance(value, StrEnum) else value)
    return text if len(text) <= 80 else text[:77] + "..."
