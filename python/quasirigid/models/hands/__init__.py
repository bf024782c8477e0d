"""The built-in hand: sizes, skeleton, shape, weights, and how they are put together."""

from .build import hand as hand

__all__ = ["hand"]
