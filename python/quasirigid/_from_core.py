"""Results of the core as those of the package."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

__all__ = ["from_core"]

_Result = TypeVar("_Result", bound="DataclassInstance")


def from_core(kind: type[_Result], core: object, /, **other: Any) -> _Result:
    """Return a dataclass with the fields of these names of a core's object, and others as they are given."""
    names = {field.name for field in fields(kind)} - other.keys()
    return kind(**{name: getattr(core, name) for name in names}, **other)
