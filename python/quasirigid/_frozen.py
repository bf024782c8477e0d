"""What nobody can change."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, Self, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Frozen", "Made", "ReadOnlyDict", "read_only"]

_Array = TypeVar("_Array", bound="NDArray[Any]")
_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


class ReadOnlyDict(dict[_Key, _Value]):
    """A dict that nobody can change, nor a copy or pickle of it."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("this dict is read-only: change a copy, dict(...)")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how it is made; a copy would set its entries one by one."""
        return ReadOnlyDict, (dict(self),)


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
                vars(self)[name] = ReadOnlyDict(value)

    def __setattr__(self, name: str, value: Any) -> NoReturn:
        """Refuse to set an attribute; a `cached_property` does not ask."""
        raise FrozenInstanceError(f"cannot assign to {name!r} of a {type(self).__name__}")

    def __delattr__(self, name: str) -> NoReturn:
        """Refuse to delete an attribute."""
        raise FrozenInstanceError(f"cannot delete {name!r} of a {type(self).__name__}")

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take the attributes, read-only again."""
        vars(self).update(state)
        self._freeze()


class Made(Frozen):
    """Base of what functions alone make, as its parts belong together: `dataclasses.replace` swaps none."""

    _makers: ClassVar[str]

    def __init__(self, *_: Any, **__: Any) -> None:
        """Refuse to be called."""
        raise TypeError(f"a {type(self).__name__} is made by {self._makers}: its parts belong together")

    @classmethod
    def _of(cls, **parts: Any) -> Self:
        made = object.__new__(cls)
        vars(made).update(parts)
        made._freeze()
        return made


def read_only(array: _Array) -> _Array:
    """Return the array, which nobody can change."""
    array.flags.writeable = False
    return array
