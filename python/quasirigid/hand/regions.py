"""Regions of a hand's skin: which part of the hand each vertex belongs to."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .._geometry import distance_to_segment
from .pieces import in_one_piece, largest_piece
from .rig.frames import unit
from .rig.joints import DIGITS, JOINTS_OF

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .._arrays import Floats
    from .hand import Hand

_SEGMENTS = dict.fromkeys(DIGITS, ("proximal", "middle", "distal")) | {"thumb": ("proximal", "distal")}
_NEIGHBOURS = (("thumb", "index"), ("index", "middle"), ("middle", "ring"), ("ring", "little"))
_LEAST_WEIGHT = 0.15  # of a digit's joints, for a vertex to be the digit's
_BASES = (0.65, 0.35, 0.35)  # of the way to the knuckle across, along and out, where metacarpals begin
_HEADS = 0.75  # of the way from wrist to knuckles, where the pads under the knuckles begin
_HYPOTHENAR = 0.6  # of the way across the palm, from the index to the little finger
_THENAR = (0.35, 0.55)  # across the palm and from wrist to knuckles, where the ball of the thumb ends
_WEB_REACH = 0.17  # of the skin between two digits beyond their knuckles, over the hand's length
_WEB_SHARE = 0.3  # of the way from one digit to the next, on both sides of the middle
_WEB_NORMAL = 0.45  # least part of a web's normal along the digits


def regions_of(hand: Hand) -> NDArray[np.str_]:
    """Return the region (n,) of each vertex of a hand's skin.

    The skin of a digit lies beyond the plane that halves the angle at its knuckle; such planes at the other
    joints part its phalanges, and normals their sides. Between two digits, where the skin faces along them
    in one piece, is their web. The rest is the wrist behind the wrist's joint, the back where the skin faces
    dorsally, and on the palm what lies below it. Pieces that do not hang together with the largest one of
    their region go to the region around them.
    """
    skin = _Skin(hand)
    labels = skin.palm()
    for digit in DIGITS:
        rows = np.flatnonzero((skin.digit == DIGITS.index(digit)) & skin.past(digit, 1))
        labels[rows] = skin.phalanges(digit, rows)
    for pair in _NEIGHBOURS:
        # Creases of a digit face along it too.
        web = largest_piece(hand.surface.faces, skin.web(*pair))
        labels[web] = f"web-{pair[0]}-{pair[1]}"
    return in_one_piece(hand.surface.faces, labels)


def metacarpal_base(hand: Hand, digit: str) -> Floats:
    """Return where the metacarpal of a digit begins (3,) (m).

    The thumb's at its joint. Those of fingers between wrist and knuckles: rigs place them anywhere.
    """
    if digit == "thumb":
        return hand.frame_of(JOINTS_OF[digit][0])[:3, 3]
    wrist = hand.frame_of("wrist")
    way = hand.frame_of(JOINTS_OF[digit][1])[:3, 3] - wrist[:3, 3]
    place: Floats = wrist[:3, 3] + wrist[:3, :3] @ (np.array(_BASES) * (wrist[:3, :3].T @ way))
    return place


class _Skin:
    """The skin beside its bones."""

    def __init__(self, hand: Hand) -> None:
        self.hand = hand
        self.points, self.normals = hand.surface.vertices, hand.surface.vertex_normals
        self.length = hand.length
        wrist = hand.frame_of("wrist")
        self.wrist = wrist[:3, 3]
        knuckle = self.joint("middle", 1)
        self.distal = unit(knuckle - self.wrist)
        self.dorsal = unit(wrist[:3, 2] - (wrist[:3, 2] @ self.distal) * self.distal)
        self.away = np.column_stack([self._distance_to(digit) for digit in DIGITS])
        self.digit = np.argmin(np.where(self._is_moved_by(), self.away, np.inf), axis=1)

    def joint(self, digit: str, link: int) -> Floats:
        """Return the place (3,) of a joint of a digit, the metacarpal's the first."""
        return self.hand.frame_of(JOINTS_OF[digit][link])[:3, 3]

    def chain(self, digit: str) -> Floats:
        """Return the ends (k, 3) of a digit's bones, from the base of its metacarpal to its tip."""
        places = np.array([self.joint(digit, link) for link in range(len(JOINTS_OF[digit]))])
        places[0] = metacarpal_base(self.hand, digit)
        return places

    def phalanges(self, digit: str, rows: NDArray[np.intp]) -> NDArray[np.str_]:
        """Return the regions of vertices of a digit."""
        segments = _SEGMENTS[digit]
        joints = range(2, len(segments) + 1)
        number = np.array([self.past(digit, link)[rows] for link in joints]).sum(axis=0)
        sign = 1.0 if self.hand.side == "right" else -1.0
        frames = np.array([self.hand.frame_of(name) for name in JOINTS_OF[digit][1:-1]])[number]
        across, out = (np.einsum("ki,ki->k", self.normals[rows], frames[:, :3, axis]) for axis in (0, 2))
        side = np.where(
            np.abs(out) >= np.abs(across),
            np.where(out > 0.0, "dorsal", "palmar"),
            np.where(sign * across > 0.0, "ulnar", "radial"),
        )
        words = [f"{digit}-{segments[at]}-{one}" for at, one in zip(number, side, strict=True)]
        return np.array(words, dtype="<U24")

    def web(self, first: str, second: str) -> NDArray[np.bool_]:
        """Return which vertices (n,) lie between two digits."""
        a, b = self.chain(first), self.chain(second)
        is_thumb = first == "thumb"
        # Between the knuckles of two fingers, and between the middle of the thumb's metacarpal and the
        # index's.
        root_a, root_b = (a[1], 0.5 * (b[0] + b[1])) if is_thumb else (a[1], b[1])
        along = unit(unit(a[2] - a[1]) + unit((b[1] - b[0]) if is_thumb else (b[2] - b[1])))
        step = root_b - root_a
        if not is_thumb:
            # In the plane of the palm: rigs bend fingers at rest and place knuckles at different depths.
            along, step = (way - (way @ self.dorsal) * self.dorsal for way in (along, step))
            along = unit(along)
        across = step - (step @ along) * along
        share = (self.points - root_a) @ across / (across @ across)
        reach = (self.points - 0.5 * (root_a + root_b)) @ along
        between = np.abs(share - 0.5) < _WEB_SHARE
        near = (np.abs(reach) < _WEB_REACH * self.length) & (self.normals @ along > _WEB_NORMAL)
        pair = [DIGITS.index(first), DIGITS.index(second)]
        nearest = np.isin(np.argmin(self.away, axis=1), pair)
        # Not the tip of a digit that bends into the way.
        low = self.away[:, pair].min(axis=1) < 0.12 * self.length
        tips = [~self.past(digit, 2) for digit in (first, second)]
        result: NDArray[np.bool_] = between & near & nearest & low & tips[0] & tips[1]
        return result

    def palm(self) -> NDArray[np.str_]:
        """Return the region (n,) of each vertex as if none were a digit's."""
        ulnar = np.cross(self.distal, self.dorsal) * (1.0 if self.hand.side == "right" else -1.0)
        knuckles = np.array([self.joint(digit, 1) for digit in DIGITS[1:]]) - self.wrist
        beside, ahead = knuckles @ ulnar, knuckles @ self.distal
        across, along = (self.points - self.wrist) @ ulnar, (self.points - self.wrist) @ self.distal
        # 0 at the wrist and 1 at the knuckles; 0 under the index and 1 under the little finger.
        along = along / np.interp(across, beside, ahead)
        across = (across - beside[0]) / (beside[-1] - beside[0])
        is_thumbs = np.argmin(self.away, axis=1) == DIGITS.index("thumb")
        labels = np.full(len(self.points), "palm-center", dtype="<U24")
        labels[across > _HYPOTHENAR] = "hypothenar"
        labels[is_thumbs | (across < _THENAR[0]) & (along < _THENAR[1])] = "thenar"
        heads = np.abs(np.subtract.outer((self.points - self.wrist) @ ulnar, beside)).argmin(axis=1)
        for at, digit in enumerate(DIGITS[1:]):
            labels[(along > _HEADS) & (heads == at) & ~is_thumbs] = f"{digit}-metacarpal-head"
        labels[self.normals @ self.dorsal > 0.0] = "back"
        labels[(self.points - self.wrist) @ self.distal < 0.0] = "wrist"
        return labels

    def past(self, digit: str, link: int) -> NDArray[np.bool_]:
        """Return which vertices (n,) lie beyond the plane that halves the angle at a joint."""
        chain = self.chain(digit)
        normal = unit(chain[link] - chain[link - 1]) + unit(chain[link + 1] - chain[link])
        past: NDArray[np.bool_] = (self.points - chain[link]) @ normal > 0.0
        return past

    def _is_moved_by(self) -> NDArray[np.bool_]:
        """Return which digits (n, 5) move a vertex; all where none does."""
        share = np.empty((len(self.points), len(DIGITS)))
        for at, digit in enumerate(DIGITS):
            own = [self.hand.joint_names.index(name) for name in JOINTS_OF[digit]]
            share[:, at] = np.where(np.isin(self.hand.joints, own), self.hand.weights, 0.0).sum(axis=1)
        moved: NDArray[np.bool_] = share > _LEAST_WEIGHT
        moved[~moved.any(axis=1)] = True
        return moved

    def _distance_to(self, digit: str) -> Floats:
        """Return the distance (n,) to the bones of a digit (m)."""
        chain = self.chain(digit)
        distances = [distance_to_segment(self.points, a, b) for a, b in pairwise(chain)]
        least: Floats = np.min(distances, axis=0)
        return least


def digit_of_vertices(labels: NDArray[np.str_]) -> NDArray[np.str_]:
    """Return the digit (n,) of each vertex by its region, phalanges alone; ``"palm"`` for the rest."""
    words = np.char.partition(labels, "-")
    on_digit = np.isin(words[:, 0], DIGITS) & (labels != "")
    on_digit &= ~np.char.endswith(labels, "metacarpal-head")
    return np.where(on_digit, words[:, 0], "palm")
