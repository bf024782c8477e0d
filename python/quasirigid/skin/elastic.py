"""What a contact asks of a skin, whether it is plain, prepared or combined."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from .. import _core
    from ..surface import Surface

__all__ = ["ElasticSkin", "core_skin"]


class ElasticSkin(Protocol):
    """What goes into a contact as its skin: a `Skin`, `PreparedSkin` or `CombinedSkin`."""

    def _core_on(self, surface: Surface, num_threads: int | None) -> _core.Skin:
        """Return the core's skin for a surface, prepared by so many threads where it has to be."""


def core_skin(skin: ElasticSkin, surface: Surface, num_threads: int | None = None) -> _core.Skin:
    """Return the core's skin for a surface; refuse what is no skin, a bare response above all."""
    if not hasattr(skin, "_core_on"):
        raise TypeError(
            f"skin is a {type(skin).__name__}, expected a Skin, PreparedSkin or CombinedSkin: a response "
            "goes into `Skin(shear_modulus=..., poisson_ratio=..., response=...)`"
        )
    return skin._core_on(surface, num_threads)
