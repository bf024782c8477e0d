"""The product: a closed mesh or a primitive at a rigid pose."""

from __future__ import annotations

from ._core import Obstacle as Obstacle

__all__ = ["Obstacle"]
