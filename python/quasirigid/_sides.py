"""The sides of triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["sides_of"]


def sides_of(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return both ends (3 m, 2) of each side of faces (m, 3), in the order of its face."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
