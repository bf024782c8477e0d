"""The skin as it looks under the forces of a contact, computed when somebody asks."""

from __future__ import annotations

from threading import Lock
from typing import TYPE_CHECKING, Any, NamedTuple

from .. import _core

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..surface import Surface

__all__ = ["Drawing", "DrawnSkin"]


class DrawnSkin(NamedTuple):
    """Displacement (n, 3) in m, where it has faded (m), volume change (m^3) and deformed skin."""

    displacement: NDArray[np.float64]
    fade_distance: float
    volume_change: float
    deformed: Surface


class Drawing:
    """A drawn skin and the mesh that it is drawn on, or what computes them."""

    def __init__(self, source: _core.Drawing | DrawnSkin, surface: Surface | None) -> None:
        self._source = source
        self._surface = surface
        self._lock = Lock()
        if isinstance(source, DrawnSkin):
            source.displacement.flags.writeable = False

    def surface(self) -> Surface:
        """Return the mesh that was solved; built once, when it is first asked for."""
        with self._lock:
            return self._built_surface()

    def skin(self) -> DrawnSkin:
        """Return the drawn skin; computed once, whichever threads ask, and its source is let go."""
        with self._lock:
            self._built_surface()
            if isinstance(self._source, _core.Drawing):
                self._source = DrawnSkin(*self._source.draw())
            return self._source

    def _built_surface(self) -> Surface:
        if self._surface is None:
            assert isinstance(self._source, _core.Drawing)
            self._surface = self._source.surface()
            assert self._surface is not None
        return self._surface

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the drawn skin and its mesh."""
        return Drawing, (self.skin(), self.surface())
