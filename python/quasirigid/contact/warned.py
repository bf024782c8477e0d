"""What a contact warns of: a category and a message each."""

from __future__ import annotations

import warnings
from typing import NamedTuple

from ..errors import (
    CoarseMeshWarning,
    CutWarning,
    DepthWarning,
    DirectionWarning,
    MaskWarning,
    ModulusWarning,
    PenetrationWarning,
    QuasirigidWarning,
    RefinementWarning,
    ResponseRangeWarning,
    SizeWarning,
)

__all__ = ["Warned", "warn_of", "warned"]

_CATEGORIES: dict[str, type[QuasirigidWarning]] = {
    "size": SizeWarning,
    "direction": DirectionWarning,
    "depth": DepthWarning,
    "modulus": ModulusWarning,
    "coarse_mesh": CoarseMeshWarning,
    "cut": CutWarning,
    "response_range": ResponseRangeWarning,
    "mask": MaskWarning,
    "penetration": PenetrationWarning,
    "refinement": RefinementWarning,
}


class Warned(NamedTuple):
    """One warning of a contact.

    Attributes
    ----------
    category : type
        A `QuasirigidWarning`, such as `DepthWarning`.
    message : str
        The number found, what is usual, and what to do.
    """

    category: type[QuasirigidWarning]
    message: str

    def __str__(self) -> str:
        """Return the category's name and the message."""
        return f"{self.category.__name__}: {self.message}"


def warned(kinds_and_messages: list[tuple[str, str]]) -> tuple[Warned, ...]:
    """Return the warnings of a contact of the core."""
    return tuple(Warned(_CATEGORIES[kind], message) for kind, message in kinds_and_messages)


def warn_of(told: tuple[Warned, ...], stacklevel: int) -> None:
    """Hand warnings to Python's own, whose filters say which are shown."""
    for category, message in told:
        warnings.warn(message, category, stacklevel=stacklevel + 1)
