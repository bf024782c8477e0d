"""The product: a closed mesh or a primitive at a pose, rigid or with a material."""

from __future__ import annotations

from ._core import Obstacle as Obstacle
from .skin.product import Material as Material

__all__ = ["Material", "Obstacle"]
