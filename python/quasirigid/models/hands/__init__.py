"""The built-in hand: sizes, skeleton, shape, weights, and how they are put together."""

from .build import hand as hand
from .model import HandModel as HandModel

__all__ = ["HandModel", "hand"]
