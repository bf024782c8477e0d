"""Checks of arguments; a refusal names the argument, what was found and what is expected."""

from __future__ import annotations

import operator
import sys
from enum import StrEnum
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from .errors import QuasirigidError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

Refusal = type[QuasirigidError]
_Choice = TypeVar("_Choice", bound=StrEnum)
_Kind = TypeVar("_Kind")


def as_number(name: str, value: Any, refusal: Refusal, least: float = 0.0, most: float = np.inf) -> float:
    """Return a finite number above 0, at least `least` and at most `most`."""
    number = real_or_nan(value)
    if np.isfinite(number) and number > 0.0 and least <= number <= most:
        return number
    wanted = "above 0" if most == np.inf else f"from {least:g} to {most:g}"
    raise refusal(f"{name} is {value!r}, expected a number {wanted}")


def as_share(name: str, value: Any, refusal: Refusal) -> float:
    """Return a number from 0 to 1."""
    share = real_or_nan(value)
    if not 0.0 <= share <= 1.0:
        raise refusal(f"{name} is {short(value)}, expected a number from 0 to 1")
    return share


def real_or_nan(value: Any) -> float:
    """Return a float; nan of what is no number, as for `as_float`."""
    try:
        return as_float("", value)
    except TypeError:
        return float("nan")


def as_float(name: str, value: Any) -> float:
    """Return a float, whatever it is; the core says which are allowed.

    Raises
    ------
    TypeError
        If it is no number, as words and booleans are none, or one that no float holds.
    """
    try:
        if not isinstance(value, (str, bytes, bool, np.bool_)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise TypeError(f"{name} is {short(value)}, expected a number")


def as_float_or_none(name: str, value: Any) -> float | None:
    """Return a float; None stays."""
    return None if value is None else as_float(name, value)


def as_length(name: str, value: Any, refusal: Refusal) -> float:
    """Return a finite length (m) above 0."""
    try:
        return as_number(name, value, refusal)
    except refusal:
        raise refusal(f"{name} is {short(value)} m, expected a length above 0") from None


def as_array(name: str, value: Any) -> NDArray[Any]:
    """Return what NumPy makes of a value.

    Raises
    ------
    TypeError
        If it makes none, as of rows of different lengths, or a masked array hides an entry.
    """
    # Masked arrays alone have a mask; one that hides nothing is like any other.
    mask = getattr(value, "mask", False) if isinstance(value, np.ndarray) else False
    if np.any(mask):
        hidden = f"{np.count_nonzero(mask)} of its {value.size} entries"
        raise TypeError(f"`{name}` is a masked array that hides {hidden}: fill them or leave them out")
    try:
        return np.asarray(value)
    except (TypeError, ValueError) as error:
        raise TypeError(f"`{name}` cannot be read as an array of numbers: {error}") from None


def as_reals(name: str, value: Any) -> NDArray[np.float64]:
    """Return real numbers; a TypeError of others, as words, booleans and complex numbers are none."""
    array = as_array(name, value)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"`{name}` has dtype {array.dtype}, expected real numbers")
    return array.astype(np.float64, copy=False)


def reals_or_empty(value: Any) -> NDArray[np.float64]:
    """Return a copy of real numbers; an empty row where some are none, as for `as_reals`."""
    try:
        reals = as_reals("", value)
    except TypeError:
        return np.empty(0)
    # NumPy would take True among numbers for 1.
    entries = () if isinstance(value, np.ndarray) else np.array(value, dtype=object).flat
    has_boolean = any(isinstance(entry, (bool, np.bool_)) for entry in entries)
    return np.empty(0) if has_boolean else np.array(reals)


def as_path(name: str, value: Any) -> Path:
    """Return a path; a TypeError of what is none, as the number of an open file."""
    try:
        return Path(fspath(value))
    except TypeError:
        raise TypeError(f"{name} is {short(value)}, expected a path") from None


def as_vector(name: str, value: Any, refusal: Refusal) -> NDArray[np.float64]:
    """Return three finite numbers."""
    vector = reals_or_empty(value)
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


def as_mask(name: str, value: Any, count: int | tuple[int, int], refusal: Refusal) -> NDArray[np.bool_]:
    """Return one boolean for each of `count` vertices, of the given mesh or of the one that was solved.

    Raises
    ------
    TypeError
        If they are no booleans; a `refusal` if there are more or fewer.
    """
    mask = as_array(name, value)
    if mask.dtype != np.bool_:
        first = count if isinstance(count, int) else count[0]
        remedy = f": np.isin(np.arange({first}), numbers) makes them of vertex numbers"
        raise TypeError(
            f"`{name}` has dtype {mask.dtype}, expected booleans, {_one_a_vertex(count)}"
            + remedy * np.issubdtype(mask.dtype, np.integer)
        )
    _check_length(name, mask, count, refusal)
    return mask


def as_vertex_labels(name: str, value: Any, counts: tuple[int, int], refusal: Refusal) -> NDArray[Any]:
    """Return an integer or a word for each vertex, of the given mesh or of the one that was solved.

    Raises
    ------
    TypeError
        If they are neither integers nor words; a `refusal` if there are more or fewer, or some are nan or
        integers of more than 64 bits.
    """
    # Of a list as its members are: NumPy would make words of a mixture.
    entries = as_array(name, value) if isinstance(value, np.ndarray) else np.asarray(value, dtype=object)
    _check_length(name, entries, counts, refusal)
    if entries.dtype.kind in "iuU":
        return entries
    expected = f"expected integers or words, {_one_a_vertex(counts)}"
    missing = [at for at, entry in enumerate(entries) if entry is None or entry != entry]
    if missing:
        raise refusal(f"`{name}[{missing[0]}]` is {entries[missing[0]]!r}, {expected}")
    if all(isinstance(entry, str) for entry in entries):
        return np.array(entries.tolist(), dtype=np.str_)
    whole = [isinstance(entry, (int, np.integer)) and not isinstance(entry, bool) for entry in entries]
    if entries.dtype.kind == "O" and all(whole):
        bounds = np.iinfo(np.int64)
        large = [at for at, entry in enumerate(entries) if not bounds.min <= entry <= bounds.max]
        if large:
            found = f"`{name}[{large[0]}]` is {short(entries[large[0]])}"
            raise refusal(f"{found}, expected integers of 64 bits or words, {_one_a_vertex(counts)}")
        return entries.astype(np.int64)
    kinds = ", ".join(sorted({type(entry).__name__ for entry in entries}))
    raise TypeError(f"`{name}` holds {kinds}, {expected}")


def _check_length(name: str, entries: Any, count: int | tuple[int, int], refusal: Refusal) -> None:
    """Raise a `refusal` where there is not one entry a vertex."""
    counts = (count,) if isinstance(count, int) else count
    if entries.ndim != 1:
        shapes = " or ".join(f"({one},)" for one in dict.fromkeys(counts))
        raise refusal(f"`{name}` has shape {entries.shape}, expected {shapes}")
    if len(entries) in counts:
        return
    if isinstance(count, int):
        raise refusal(f"`{name}` has {len(entries)} entries, but the skin has {count} vertices")
    raise refusal(f"`{name}` has {len(entries)} entries, expected {_one_a_vertex(count)}")


def _one_a_vertex(count: int | tuple[int, int]) -> str:
    if isinstance(count, int):
        return "one per vertex"
    given, solved = count
    return f"one per vertex: {given} of the given mesh or {solved} of the contact's surface"


def as_boolean(name: str, value: Any) -> bool:
    """Return a boolean; a TypeError if it is none."""
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise TypeError(f"{name} is {short(value)}, expected True or False")


def as_place(name: str, value: Any, count: int, where: str) -> int:
    """Return the number of one of so many steps or the like; negative ones count from the end."""
    number = _index_or_none(value)
    if number is None:
        raise TypeError(f"{name} is {short(value)}, expected an integer")
    if not -count <= number < count:
        raise IndexError(f"there is no {name} {number} in {where} of {count} {name}s")
    return number % count


def as_integer(name: str, value: Any, refusal: type[ValueError] = ValueError, least: int = 0) -> int:
    """Return an integer >= `least`.

    Raises
    ------
    TypeError
        If it is a boolean or would have to be rounded; a `refusal` if it is out of range.
    """
    number = _index_or_none(value)
    if number is None:
        raise TypeError(f"{name} is {value!r}, expected an integer")
    if number < least:
        raise refusal(f"{name} is {number}, expected an integer of at least {least}")
    if number > sys.maxsize:
        raise refusal(f"{name} is {number}, expected an integer of at most {sys.maxsize}")
    return number


def _index_or_none(value: Any) -> int | None:
    """Return an integer; None of what would have to be rounded and of booleans."""
    is_boolean = isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b"
    try:
        return None if is_boolean else operator.index(value)
    except TypeError:
        return None


def as_integer_or_none(
    name: str, value: Any, refusal: type[ValueError] = ValueError, least: int = 0
) -> int | None:
    """Return None, or what `as_integer` does."""
    return None if value is None else as_integer(name, value, refusal, least)


def as_integers(name: str, values: Iterable[Any], refusal: type[ValueError] = ValueError) -> list[int]:
    """Return a list of integers >= 0; a `refusal` of others."""
    try:
        listed = list(values)
    except TypeError:
        raise TypeError(f"{name} is {values!r}, expected a sequence of integers") from None
    return [as_integer(f"{name}[{place}]", value, refusal) for place, value in enumerate(listed)]


def as_index(name: str, value: Any, count: int, refusal: Refusal) -> int:
    """Return the number of one of `count` vertices.

    Raises
    ------
    TypeError
        If it is no whole number; a `refusal` if there is no such vertex.
    """
    index = _index_or_none(value)
    if index is None:
        raise TypeError(f"{name} is {short(value)}, expected the number of a vertex")
    if not 0 <= index < count:
        raise refusal(f"{name} vertex {index}: the skin has vertices 0 to {count - 1}")
    return index


def as_nodes(name: str, value: Any, count: int, refusal: Refusal) -> NDArray[np.int64]:
    """Return numbers of some of `count` vertices.

    Raises
    ------
    TypeError
        If they are no integers; a `refusal` if they are no row, or there is no such vertex.
    """
    nodes = as_array(name, value)
    if nodes.size > 0 and nodes.dtype.kind not in "iu":
        hint = ": of a mask take np.flatnonzero(mask)" if nodes.dtype.kind == "b" else ""
        raise TypeError(f"`{name}` has dtype {nodes.dtype}, expected integers{hint}")
    if nodes.ndim != 1:
        raise refusal(f"`{name}` has shape {nodes.shape}, expected (k,)")
    wrong = np.flatnonzero((nodes < 0) | (nodes >= count))
    if wrong.size > 0:
        raise refusal(f"`{name}[{wrong[0]}]` is {nodes[wrong[0]]}, but there are {count} vertices")
    return nodes.astype(np.int64)


def as_choice(name: str, value: Any, kind: type[_Choice], refusal: Refusal) -> _Choice:
    """Return a member of an enumeration, given itself or by its word."""
    try:
        return kind(value)
    except ValueError:
        known = ", ".join(f'"{member}"' for member in kind)
        raise refusal(f"{name} is {value!r}, expected one of {known}") from None


def as_kind(name: str, value: Any, kind: type[_Kind], remedy: str) -> _Kind:
    """Return a value of a class; a TypeError of any other, with what makes one."""
    if isinstance(value, kind):
        return value
    raise TypeError(f"{name} is {kind_of(value)}, expected {_with_article(kind.__name__)}: {remedy}")


def kind_of(value: Any) -> str:
    """Return what a value is in words: a path, a word, or its class."""
    if isinstance(value, PathLike) or (isinstance(value, str) and any(mark in value for mark in "./\\")):
        return f"the path {short(str(value))}"
    if isinstance(value, str):
        return f"the word {short(value)}"
    return _with_article(type(value).__name__)


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'AEIOUaeiou' else 'a'} {name}"


def short(value: Any) -> str:
    """Return what a value is on one short line."""
    if isinstance(value, np.ndarray):
        kind = "a masked array" if np.any(getattr(value, "mask", False)) else "an array"
        dtype = "" if value.dtype.kind in "iuf" else f" and dtype {value.dtype}"
        if value.size > 6 or dtype or kind == "a masked array":
            return f"{kind} of shape {value.shape}{dtype}"
        value = value.tolist()
    text = repr(str(value) if isinstance(value, StrEnum) else value)
    return text if len(text) <= 80 else text[:77] + "..."
