"""Lengths and breadths of adults' hands, and how the arguments of `hand` choose one.

Gordon et al. 2014, 2012 Anthropometric Survey of U.S. Army Personnel (ANSUR II), Natick/TR-15/007: hand
length (stylion at the wrist to the middle finger's tip) and hand breadth (across the knuckles) at the 5th,
50th and 95th percentile of its public data file, 1,986 women and 4,082 men, in whole mm.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..._check import as_number
from ...errors import SurfaceError

__all__ = ["PERCENTILES", "size_of"]

# Length and breadth (m).
PERCENTILES = {
    ("female", 5): (0.165, 0.072),
    ("female", 50): (0.180, 0.078),
    ("female", 95): (0.199, 0.085),
    ("male", 5): (0.177, 0.081),
    ("male", 50): (0.193, 0.088),
    ("male", 95): (0.210, 0.096),
}
DEFAULT = (0.190, 0.085)
LENGTHS = (0.09, 0.26)  # from an infant to beyond the largest adult (m)
SLENDERNESS = (1.7, 3.0)  # length over breadth that the drawing bears


def size_of(hand_length: Any, hand_breadth: Any, percentile: Any, sex: Any) -> tuple[float, float]:
    """Return length and breadth (m) from either pair of arguments.

    Raises
    ------
    SurfaceError
        An argument is out of range, or those of both pairs are given.
    """
    if percentile is None and sex is None:
        length = as_number("hand_length", hand_length, SurfaceError, *LENGTHS)
        breadth = as_number("hand_breadth", hand_breadth, SurfaceError)
        least, most = SLENDERNESS
        if not least <= length / breadth <= most:
            raise SurfaceError(
                f"hand_breadth is {breadth:g} m, expected {length / most:.3f} to {length / least:.3f} m "
                f"for a hand {length:g} m long"
            )
        return length, breadth
    if (hand_length, hand_breadth) != DEFAULT:
        raise SurfaceError("`percentile` and `sex` replace the hand's length and breadth: give one pair")
    if not isinstance(sex, str) or sex not in ("female", "male"):
        raise SurfaceError(f'sex is {sex!r}, expected "female" or "male" beside `percentile` (5, 50 or 95)')
    known = isinstance(percentile, (int, float, np.integer, np.floating)) and not isinstance(percentile, bool)
    if not known or (sex, percentile) not in PERCENTILES:
        raise SurfaceError(f"percentile is {percentile!r}, expected 5, 50 or 95 beside `sex`")
    return PERCENTILES[sex, percentile]
