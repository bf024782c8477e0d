"""What several functions ask of an argument; refusals name it, what was found, and what is expected."""

from __future__ import annotations

import operator
import sys
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import QuasirigidError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

Refusal = type[QuasirigidError]


def number_of(name: str, value: Any, refusal: Refusal, least: float = 0.0, most: float = np.inf) -> float:
    """A finite number above 0, at least `least` and at most `most`."""
    try:
        number = float("nan") if isinstance(value, (str, bytes)) else float(value)
    except (TypeError, ValueError):
        number = float("nan")
    if np.isfinite(number) and number > 0.0 and least <= number <= most:
        return number
    wanted = "above 0" if most == np.inf else f"from {least:g} to {most:g}"
    raise refusal(f"{name} is {value!r}, expected a number {wanted}")


def vector_of(name: str, value: Any, refusal: Refusal) -> NDArray[np.float64]:
    """Three finite numbers."""
    try:
        vector = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        vector = np.empty(0)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise refusal(f"{name} is {_short(value)}, expected three finite numbers")
    return vector


def direction_of(name: str, value: Any, refusal: Refusal) -> NDArray[np.float64]:
    """Three finite numbers that are not all 0, made a unit vector."""
    vector = vector_of(name, value, refusal)
    largest = np.abs(vector).max()
    if largest == 0.0:
        raise refusal(f"{name} is {_short(value)}, expected a direction")
    scaled: NDArray[np.float64] = vector / largest
    return scaled / np.linalg.norm(scaled)


def mask_of(name: str, value: Any, count: int, refusal: Refusal) -> NDArray[np.bool_]:
    """One boolean for each of `count` vertices.

    Raises
    ------
    TypeError
        If they are no booleans; a `refusal` if there are more or fewer.
    """
    try:
        mask = np.asarray(value)
    except ValueError:
        raise TypeError(f"`{name}` is {_short(value)}, expected an array of booleans") from None
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


def count_of(name: str, value: Any, refusal: Refusal) -> int | None:
    """A whole number that is not negative, or None; whether 0 will do is left to the core.

    Raises
    ------
    TypeError
        If it is no whole number; a `refusal` if it is negative.
    """
    if value is None:
        return None
    try:
        count = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}, expected a whole number or None") from None
    if count < 0:
        raise refusal(f"{name} is {count}, expected a number above 0 or None")
    return count


def integer_of(name: str, value: Any) -> int:
    """An integer >= 0; no boolean, and nothing that would have to be rounded."""
    is_boolean = isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b"
    try:
        number = None if is_boolean else operator.index(value)
    except TypeError:
        number = None
    if number is None:
        raise TypeError(f"{name} is {value!r}, expected an integer")
    if not 0 <= number <= sys.maxsize:
        raise ValueError(f"{name} is {number}, expected an integer of at least 0 and at most {sys.maxsize}")
    return number


def integers_of(name: str, values: Iterable[Any]) -> list[int]:
    """Integers >= 0, one after the other."""
    try:
        listed = list(values)
    except TypeError:
        raise TypeError(f"{name} is {values!r}, expected a sequence of integers") from None
    return [integer_of(f"{name}[{place}]", value) for place, value in enumerate(listed)]


def index_of(name: str, value: Any, count: int, refusal: Refusal) -> int:
    """The number of one of `count` vertices.

    Raises
    ------
    TypeError
        If it is no whole number; a `refusal` if there is no such vertex.
    """
    try:
        index = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {_short(value)}, expected the number of a vertex") from None
    if not 0 <= index < count:
        raise refusal(f"{name} vertex {index}: the skin has vertices 0 to {count - 1}")
    return index


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        value = value.tolist() if value.size <= 6 else f"an array of shape {value.shape}"
    text = str(value)
    return text if len(text) <= 80 else text[:77] + "..."
