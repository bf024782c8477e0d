"""Skin and product as they look under the forces of a contact, computed when somebody asks."""

from __future__ import annotations

from dataclasses import dataclass
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from .._frozen import Frozen
from ..surface import Surface

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..obstacle import Obstacle

__all__ = ["Drawing", "DrawnObstacle", "DrawnSkin"]


@dataclass(frozen=True, eq=False)
class DrawnSkin(Frozen):
    """Displacement (n, 3) in m, where it has faded (m), volume change (m³) and deformed skin."""

    displacement: NDArray[np.float64]
    fade_distance: float
    volume_change: float
    deformed: Surface


@dataclass(frozen=True, eq=False)
class DrawnObstacle(Frozen):
    """Displacement (n, 3) in m of the product opposite each vertex, and its moved mesh, if it has one."""

    displacement: NDArray[np.float64]
    deformed: Surface | None


class Drawing:
    """A drawn skin, the mesh that it is drawn on, the product that it meets, or what computes them."""

    def __init__(
        self,
        source: _core.Drawing | DrawnSkin,
        surface: Surface | None,
        obstacle: DrawnObstacle | None = None,
    ) -> None:
        self._source = source
        self._surface = surface
        self._obstacle = obstacle
        self._lock = Lock()

    def surface(self) -> Surface:
        """Return the mesh that was solved; built once, when it is first asked for."""
        with self._lock:
            return self._built_surface()

    def skin(self) -> DrawnSkin:
        """Return the drawn skin; computed once, whichever threads ask, and its source is let go."""
        with self._lock:
            self._built_surface()
            self._moved_obstacle()
            if isinstance(self._source, _core.Drawing):
                self._source = DrawnSkin(*self._source.draw())
            return self._source

    def obstacle(self, obstacle: Obstacle, vertex_count: int) -> DrawnObstacle:
        """Return the moved product; a rigid one where it stands, its displacement 0."""
        with self._lock:
            drawn = self._moved_obstacle()
            if drawn is None:
                displacement = np.zeros((vertex_count, 3))
                triangles = obstacle.triangles()
                drawn = DrawnObstacle(displacement, None if triangles is None else Surface(*triangles))
                self._obstacle = drawn
            return drawn

    def _moved_obstacle(self) -> DrawnObstacle | None:
        """Return the product as far as it was moved; None of a rigid one."""
        if self._obstacle is None and isinstance(self._source, _core.Drawing):
            moved = self._source.draw_obstacle()
            self._obstacle = None if moved is None else DrawnObstacle(*moved)
        return self._obstacle

    def _built_surface(self) -> Surface:
        if self._surface is None:
            assert isinstance(self._source, _core.Drawing)
            self._surface = self._source.surface()
            assert self._surface is not None
        return self._surface

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the drawn skin, its mesh and the moved product."""
        return Drawing, (self.skin(), self.surface(), self._obstacle)
