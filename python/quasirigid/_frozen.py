"""What nobody can change."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Frozen", "read_only"]

_Array = TypeVar("_Array", bound="NDArray[Any]")


class Frozen:
    """Base of what is made once: no attribute is set, arrays and dicts are read-only, after a pickle too."""

    def __post_init__(self) -> None:
        """Make arrays and dicts read-only."""
        self._freeze()

    def _freeze(self) -> None:
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                read_only(value)
            elif isinstance(value, dict):
                vars(self)[name] = MappingProxyType(value)

    def __setattr__(self, name: str, value: Any) -> NoReturn:
        """Refuse to set an attribute; a `cached_property` does not ask."""
        raise FrozenInstanceError(f"cannot assign to {name!r} of a {type(self).__name__}")

    def __delattr__(self, name: str) -> NoReturn:
        """Refuse to delete an attribute."""
        raise FrozenInstanceError(f"cannot delete {name!r} of a {type(self).__name__}")

    def __getstate__(self) -> dict[str, Any]:
        """Return the attributes; pickle knows no `MappingProxyType`."""
        return {
            name: dict(value) if isinstance(value, MappingProxyType) else value
            for name, value in vars(self).items()
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take the attributes, read-only again."""
        vars(self).update(state)
        self._freeze()


def read_only(array: _Array) -> _Array:
    """Return the array, which nobody can change."""
    array.flags.writeable = False
    return array
