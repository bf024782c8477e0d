"""Smooth fingers of human proportions.

Frame: origin in the middle of the flat cut, +y along the finger to the tip, nail to +z, pad to -z.

Where the numbers come from (middle finger of an adult, rounded):

* lengths: distal phalanx about 17.4 mm and the pulp beyond it about 4 mm, middle phalanx about 26.3 mm
  (Buryanov and Kotiuk 2010, Int. J. Morphol. 28(3), 755-758, radiographs of 66 adults). The free finger, from
  the crease at its root to the tip, is about 76 mm long: hand length less palm length in ANSUR II (2012).
* breadths: men's middle finger about 20 mm broad and 58 mm round at the distal (DIP) joint, about 22.5 mm and
  70 mm at the proximal (PIP) joint (Greiner 1991, Hand Anthropometry of U.S. Army Personnel, TR-92/011).
  So the PIP joint is about 1.14 times as broad as the DIP joint, and ellipses of those breadths and girths
  are about 0.86 (DIP) and 0.95 (PIP) times as deep as broad. The default of 18 mm is a middle-sized adult's.

The round of the tip, the bulge of the pad and the flat of the nail are drawn after hand models, not measured.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from .._arrays import Floats, Indices
from .._check import as_length
from ..errors import SurfaceError
from ..surface import Surface
from .loft import check_vertex_count, loft, rings_on, rows_along

__all__ = ["REFERENCE_BREADTH", "finger", "fingertip"]

# All relative to the breadth at the DIP joint, 18 mm by default; distances are counted from the tip.
REFERENCE_BREADTH = 0.018
REFERENCE_LENGTH = 0.076
DIP_FROM_TIP = 0.0213
PIP_FROM_TIP = 0.0476
TIP_EXPONENT = 2.3  # of the superellipse that rounds the tip: 2 is an ellipsoid, more is blunter


def fingertip(
    *, length: float = 0.030, breadth: float = 0.018, depth: float | None = None, edge_length: float = 1.2e-3
) -> Surface:
    """Return the end of a finger: distal phalanx and a piece of the middle one.

    Parameters
    ----------
    length : float
        From the flat cut to the tip (m).
    breadth : float
        Breadth at the distal joint (m); everything but `length` scales with it.
    depth : float, optional
        Depth at the distal joint (m); 0.86 times the breadth when left out.
    edge_length : float
        Mean edge of the mesh (m).

    Returns
    -------
    Surface
        Closed; about 1,400 vertices by default, 5,600 at 0.6 mm.

    Raises
    ------
    SurfaceError
        A length is not above 0, the finger is shorter than 0.8 breadths, or the mesh too coarse to show it.

    Examples
    --------
    >>> import quasirigid as qr
    >>> tip = qr.models.fingertip(edge_length=2e-3)
    >>> tip.is_closed, round(float(tip.vertices[:, 1].max()), 3)
    (True, 0.03)
    """
    return Surface(*_build(length, breadth, depth, edge_length, stretch=breadth / REFERENCE_BREADTH))


def finger(
    *, length: float = 0.076, breadth: float = 0.018, depth: float | None = None, edge_length: float = 1.85e-3
) -> Surface:
    """Return a whole straight finger, from its root to the tip, with the girth of its two joints.

    Parameters
    ----------
    length : float
        From the flat cut at the root to the tip (m); the joints keep their place in proportion.
    breadth : float
        Breadth at the distal joint (m).
    depth : float, optional
        Depth at the distal joint (m); 0.86 times the breadth when left out.
    edge_length : float
        Mean edge of the mesh (m).

    Returns
    -------
    Surface
        Closed; about 1,500 vertices by default, 50,000 at 0.32 mm.

    Raises
    ------
    SurfaceError
        A length is not above 0, the finger is shorter than 0.8 breadths, or the mesh too coarse to show it.

    References
    ----------
    Buryanov and Kotiuk 2010, Int. J. Morphol. 28(3), 755-758 (lengths of the phalanges); Greiner 1991, Hand
    Anthropometry of U.S. Army Personnel, Natick/TR-92/011 (breadths and girths at the joints).

    Examples
    --------
    >>> import quasirigid as qr
    >>> finger = qr.models.finger(length=0.080, breadth=0.020)
    >>> round(float(finger.vertices[:, 1].max()), 3)
    0.08
    """
    return Surface(*_build(length, breadth, depth, edge_length, stretch=length / REFERENCE_LENGTH))


def _build(
    length: float, breadth: float, depth: float | None, edge_length: float, stretch: float
) -> tuple[Floats, Indices]:
    """Return vertices (n, 3) in m and faces (m, 3); `stretch`: the phalanges' length over the reference's."""
    _check(length, breadth, depth, edge_length)
    check_vertex_count(np.pi * breadth * length, edge_length, SurfaceError)
    shape = _Shape(length, breadth, 0.86 * breadth if depth is None else depth, stretch)
    # Rows at equal steps of the mean meridian, from the tip to the rim of the cut.
    parameters = np.concatenate([np.linspace(0.0, 1.0, 400), np.linspace(1.0, 2.0, 400)[1:]])
    angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    meridians = np.stack([shape.section(parameter, angles) for parameter in parameters])
    steps = np.linalg.norm(np.diff(meridians, axis=0), axis=2).mean(axis=1)
    way = np.concatenate([[0.0], np.cumsum(steps)])
    rows = rows_along(way[-1], edge_length)
    stations = np.interp(np.arange(1, rows + 1) / rows * way[-1], way, parameters)
    stations[-1] = 2.0

    # Each row, and the cap as its last section drawn in towards the middle of the cut.
    rim_radius = float(np.linalg.norm(shape.section(2.0, angles), axis=1).mean())
    cap_rows = rows_along(rim_radius, edge_length)
    outlines = [partial(shape.section, station) for station in stations]
    outlines += [partial(shape.cap_section, 1.0 - row / cap_rows) for row in range(1, cap_rows)]
    rings = rings_on(outlines, edge_length)
    for ring in rings[rows - 1 :]:
        ring[:, 1] = 0.0
    return loft(rings, shape.section(0.0, np.zeros(1))[0], np.zeros(3))


class _Shape:
    """Skin as a map of (parameter, angle): parameter 0 the tip, 1 the end of its round, 2 the cut."""

    def __init__(self, length: float, breadth: float, depth: float, stretch: float) -> None:
        self.length, self.breadth, self.stretch = length, breadth, stretch
        self.flatness = depth / (0.86 * breadth)
        self.round = min(0.62 * breadth, 0.5 * length)
        self.cut_middle = self._middle(length)

    def section(self, parameter: float, angles: Floats) -> Floats:
        """Return points (k, 3) in m of the cross-section at `angles` (rad), counted from +x towards +z."""
        if parameter < 1.0:
            turn = 0.5 * np.pi * parameter
            swell = np.sin(turn) ** (2.0 / TIP_EXPONENT)
            from_tip = self.round * (1.0 - max(np.cos(turn), 0.0) ** (2.0 / TIP_EXPONENT))
        else:
            swell = 1.0
            from_tip = self.round + (parameter - 1.0) * (self.length - self.round)
        half_breadth = 0.5 * self._breadth(from_tip) * swell
        half_depth = 0.5 * self._depth(from_tip) * swell
        # The cos^2 term flattens the nail side and sharpens the pad by the same amount.
        nail = 0.16 * half_depth * self._nail(from_tip)
        sine, cosine = np.sin(angles), np.cos(angles)
        middle = self._middle(from_tip) - self.cut_middle
        x = half_breadth * cosine
        z = middle + half_depth * sine + nail * (cosine**2 - 0.5)
        return np.stack([x, np.full_like(x, self.length - from_tip), z], axis=1)

    def cap_section(self, share: float, angles: Floats) -> Floats:
        """Return the cut's outline shrunk to `share` of its size."""
        return share * self.section(2.0, angles)

    def _joint(self, from_tip: float, at: float, width: float) -> float:
        return float(np.exp(-(((from_tip - at * self.stretch) / (width * self.stretch)) ** 2)))

    def _breadth(self, from_tip: float) -> float:
        along = from_tip / (REFERENCE_LENGTH * self.stretch)
        dip, pip = self._joint(from_tip, DIP_FROM_TIP, 0.006), self._joint(from_tip, PIP_FROM_TIP, 0.009)
        return self.breadth * (0.91 + 0.19 * along + 0.037 * dip + 0.10 * pip)

    def _depth(self, from_tip: float) -> float:
        along = from_tip / (REFERENCE_LENGTH * self.stretch)
        pad = 0.05 * self._joint(from_tip, 0.011, 0.007)
        dip, pip = self._joint(from_tip, DIP_FROM_TIP, 0.006), self._joint(from_tip, PIP_FROM_TIP, 0.009)
        return self.breadth * self.flatness * (0.75 + 0.30 * along + pad + 0.02 * dip + 0.10 * pip)

    def _middle(self, from_tip: float) -> float:
        # The pad hangs below the axis, the creases under the joints and the tip lie above it.
        tip, pad = self._joint(from_tip, 0.0, 0.006), self._joint(from_tip, 0.0095, 0.0075)
        creases = self._joint(from_tip, DIP_FROM_TIP, 0.005) + self._joint(from_tip, PIP_FROM_TIP, 0.006)
        return self.breadth * (0.07 * tip - 0.075 * pad + 0.015 * creases)

    def _nail(self, from_tip: float) -> float:
        return 0.4 + 0.6 * self._joint(from_tip, 0.008, 0.010)


def _check(length: float, breadth: float, depth: float | None, edge_length: float) -> None:
    given = {"length": length, "breadth": breadth, "depth": depth, "edge_length": edge_length}
    for name, value in given.items():
        if value is not None:
            as_length(name, value, SurfaceError)
    if length < 0.8 * breadth:
        raise SurfaceError(f"length is {length} m, expected at least 0.8 times the breadth of {breadth} m")
    if edge_length > 0.25 * min(breadth, breadth if depth is None else depth):
        raise SurfaceError(
            f"edge_length is {edge_length} m, expected at most a quarter of the finger's breadth and depth"
        )
