"""What the rows of one run share, such as a prepared body; the next run makes it anew."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar, cast

__all__ = ["forget", "remembered"]

_Made = TypeVar("_Made", bound=Callable[..., Any])
_kept: list[Any] = []


def remembered(make: _Made) -> _Made:
    """Return a function that makes each thing once, until `forget`."""
    kept = cache(make)
    _kept.append(kept)
    return cast(_Made, kept)


def forget() -> None:
    """Leave nothing for the next run."""
    for kept in _kept:
        kept.cache_clear()
