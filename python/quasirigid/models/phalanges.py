"""Shape and place of the phalanges along a finger.

Where the numbers come from (adults, in mm):

* lengths of the phalanges and of the soft tissue beyond the tip of the last one: Buryanov and Kotiuk 2010,
  "Proportions of hand segments", Int. J. Morphol. 28(3), 755-758 (radiographs of 66 adults, means).
* distal phalanx: tuft about 7 broad (Mintalucci et al. 2014, J. Hand Surg. Am. 39(6), 1068-1074), narrowest
  height 3.6 (Wyrsch et al., 30 phalanges, as cited by Darowish et al. 2015, Hand 10(1), 100-104).
* heights of the joint surfaces, with the proximal phalanx 44.6 long: base of the middle phalanx 0.17 of that,
  7.6; its head that over 1.34, 5.7 (84 lateral radiographs, J. Hand Surg. Am. 2014, PubMed 24996675).
* share and place: beyond the distal crease a fingertip is by volume 56 % soft tissue on the pad's side, 18 %
  bone and 26 % soft tissue on the nail's side (Murai et al. 1997, "A cadaver study on volume and surface area
  of the fingertip", J. Hand Surg. Am. 22(5), 935-941). So the middle of the bone lies 26 + 18 / 2 = 35 % of
  the finger's depth below the nail's side.

The heights and the tuft are taken a tenth to a fifth above these means, and the breadths that no source gives
are drawn to match. That brings the bone of the built-in fingertip to 14 % of its volume, between the share
that the means alone would give (10 %) and the one measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from .._arrays import Floats, Indices
from ..errors import SurfaceError
from .fingers import REFERENCE_BREADTH
from .loft import loft, rings_on, rows_along

__all__ = ["LENGTHS", "Frame", "Phalanx", "as_text", "lengths_between", "phalanges_in"]

# Lengths (m) from the tip on: soft tissue, then the phalanges.
LENGTHS = {
    "thumb": (5.67e-3, 21.67e-3, 31.57e-3),
    "index": (3.84e-3, 15.82e-3, 22.38e-3, 39.78e-3),
    "middle": (3.95e-3, 17.40e-3, 26.33e-3, 44.63e-3),
    "ring": (3.95e-3, 17.30e-3, 25.65e-3, 41.37e-3),
    "little": (3.73e-3, 15.96e-3, 18.11e-3, 32.74e-3),
}
# (breadth, height) in m of head, waist and base, for a finger REFERENCE_BREADTH broad, from the tip on.
SECTIONS = (
    ((8.0e-3, 4.4e-3), (6.0e-3, 4.4e-3), (12.0e-3, 7.4e-3)),
    ((11.0e-3, 6.4e-3), (8.0e-3, 5.6e-3), (13.0e-3, 8.0e-3)),
    ((12.0e-3, 8.0e-3), (9.5e-3, 7.0e-3), (14.0e-3, 10.0e-3)),
)
JOINT_GAP = 1.0e-3  # cartilage of both sides and what the meshes need between them (m)
BELOW_THE_NAIL = 0.35  # of the finger's depth
SHORTEST = 3.0e-3  # a cut phalanx shorter than this is left out (m)


@dataclass(frozen=True)
class Frame:
    """A finger seen along its axis: stations count from the tip towards the cut (m)."""

    tip: Floats
    axis: Floats
    across: Floats
    dorsal: Floats
    length: float
    vertices: Floats
    edges: Indices

    def section(self, station: float) -> tuple[float, float, float, float]:
        """Return the least and greatest place (m) of the skin across and towards the nail, from the tip."""
        height = (self.vertices - self.tip) @ self.axis + station
        one, other = height[self.edges[:, 0]], height[self.edges[:, 1]]
        cut = (one > 0.0) != (other > 0.0)
        if not cut.any():
            raise SurfaceError(
                f"there is no skin {station * 1e3:.1f} mm behind the tip {as_text(self.tip)} m, against the "
                f"axis {as_text(self.axis)}: check `tip`, `axis` and the finger's unit"
            )
        share = (one[cut] / (one[cut] - other[cut]))[:, None]
        ends = self.vertices[self.edges[cut]]
        points = ends[:, 0] + share * (ends[:, 1] - ends[:, 0]) - self.tip
        x, z = points @ self.across, points @ self.dorsal
        return float(x.min()), float(x.max()), float(z.min()), float(z.max())


@dataclass(frozen=True)
class Phalanx:
    """A bone between two stations of a finger, on a straight axis."""

    frame: Frame
    number: int
    start: float
    end: float
    whole: float  # its length before the cut shortened it (m)
    girth: float  # relative to SECTIONS
    across_line: Floats  # place across as a polynomial of the station
    dorsal_line: Floats

    def half_widths(self, station: float) -> tuple[float, float]:
        """Return half breadth and half height (m), rounded off at both ends."""
        along = (station - self.start) / self.whole
        widths = np.array(SECTIONS[self.number]) * (0.5 * self.girth)
        # Level at head, waist and base.
        places = np.array([0.1, 0.45, 0.9])
        upper = int(np.clip(np.searchsorted(places, along), 1, 2))
        x = np.clip((along - places[upper - 1]) / (places[upper] - places[upper - 1]), 0.0, 1.0)
        blend = x * x * (3.0 - 2.0 * x)
        breadth, height = widths[upper - 1] + blend * (widths[upper] - widths[upper - 1])
        radius = min(height, 0.4 * (self.end - self.start))
        from_end = min(station - self.start, self.end - station)
        swell = 1.0 if from_end >= radius else float(np.sqrt(max(1.0 - (1.0 - from_end / radius) ** 2, 0.0)))
        return float(breadth) * swell, float(height) * swell

    def outline(self, station: float, angles: Floats) -> Floats:
        """Return points (k, 3) in m of the cross-section, an ellipse."""
        half_breadth, half_height = self.half_widths(station)
        frame = self.frame
        x = np.polyval(self.across_line, station) + half_breadth * np.cos(angles)
        z = np.polyval(self.dorsal_line, station) + half_height * np.sin(angles)
        points: Floats = (
            frame.tip - station * frame.axis + np.outer(x, frame.across) + np.outer(z, frame.dorsal)
        )
        return points

    def stations(self, samples: int = 400) -> Floats:
        """Return stations from end to end, denser towards the rounded ends."""
        turn = np.linspace(0.0, np.pi, samples)
        spread: Floats = self.start + (self.end - self.start) * 0.5 * (1.0 - np.cos(turn))
        return spread

    @property
    def area(self) -> float:
        """Area of the bone (m²), about."""
        stations = self.stations(60)
        angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        rings = np.stack([self.outline(float(station), angles) for station in stations])
        around = np.linalg.norm(rings - np.roll(rings, 1, axis=1), axis=2).sum(axis=1)
        steps = np.linalg.norm(np.diff(rings, axis=0), axis=2).mean(axis=1)
        return float((0.5 * (around[1:] + around[:-1]) * steps).sum())

    def mesh(self, element_size: float) -> tuple[Floats, Indices]:
        """Return vertices (m) and faces, edges of about `element_size` (m)."""
        stations = self.stations()
        angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        meridians = np.stack([self.outline(float(station), angles) for station in stations])
        steps = np.linalg.norm(np.diff(meridians, axis=0), axis=2).mean(axis=1)
        way = np.concatenate([[0.0], np.cumsum(steps)])
        rows = max(4, rows_along(way[-1], element_size))
        placed = np.interp(np.arange(1, rows) / rows * way[-1], way, stations)
        rings = rings_on((partial(self.outline, float(station)) for station in placed), element_size)
        poles = [self.outline(end, np.zeros(1))[0] for end in (self.start, self.end)]
        return loft(rings, poles[0], poles[1])


def lengths_between(frame: Frame, joints: Floats, beyond: float, scale: float) -> tuple[float, ...]:
    """Return what `LENGTHS` has (m, over `scale`), for bones between joints (k, 3) in m, the fingertip last.

    * `beyond`: soft tissue beyond the last bone (m)
    """
    stations = ((frame.tip - joints[:-1]) @ frame.axis)[::-1] / scale
    ends = np.concatenate([[beyond - 0.5 * JOINT_GAP], stations])
    lengths = np.diff(ends) - JOINT_GAP
    if (lengths <= 0.0).any():
        places = ", ".join(f"{station * scale * 1e3:.1f}" for station in stations)
        raise SurfaceError(
            f"the joints lie {places} mm behind the tip, from the last to the first: expected rising "
            "numbers, the joints from the root to the tip, the fingertip last"
        )
    return (beyond, *(float(length) for length in lengths[: len(SECTIONS)]))


def phalanges_in(
    frame: Frame, lengths: tuple[float, ...], scale: float, from_cut: float, *, is_thumb: bool
) -> list[Phalanx]:
    """Return the bones to `from_cut` (m) before the finger's cut, `lengths` as in `LENGTHS` over `scale`."""
    if frame.length < SHORTEST:
        return []
    joint = min((lengths[0] + lengths[1]) * scale, 0.75 * frame.length)
    left, right, _, _ = frame.section(joint)
    girth = (right - left) / REFERENCE_BREADTH
    phalanges = []
    start = lengths[0] * scale
    for number, length in enumerate(lengths[1:]):
        # The thumb has no middle phalanx.
        kind = 2 if is_thumb and number > 0 else number
        end = min(start + length * scale, frame.length - from_cut)
        if end - start < SHORTEST:
            break
        stations = np.linspace(start, end, 12)
        left, right, bottom, top = np.array([frame.section(float(station)) for station in stations]).T
        middle = top - BELOW_THE_NAIL * (top - bottom)
        phalanges.append(
            Phalanx(
                frame=frame,
                number=kind,
                start=start,
                end=end,
                whole=length * scale,
                girth=girth,
                across_line=np.polyfit(stations, 0.5 * (left + right), 1),
                dorsal_line=np.polyfit(stations, middle, 1),
            )
        )
        start += length * scale + JOINT_GAP * scale
    return phalanges


def as_text(vector: Floats) -> str:
    return "(" + ", ".join(f"{value + 0.0:.4g}" for value in vector.round(4)) + ")"
