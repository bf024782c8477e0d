"""Joints of a hand: their names, their order, and the names that others give them."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...errors import HandError

if TYPE_CHECKING:
    from ..._arrays import Floats

__all__ = ["DIGITS", "JOINTS_16", "JOINTS_21", "OPENXR_26", "PARENTS", "WEBXR_25"]

DIGITS = ("thumb", "index", "middle", "ring", "little")
"""The digits, radial to ulnar."""

_STEMS = {
    "thumb": "thumb",
    "index": "index-finger",
    "middle": "middle-finger",
    "ring": "ring-finger",
    "little": "pinky-finger",
}
_FINGER = ("metacarpal", "proximal", "intermediate", "distal", "tip")
_LINKS: dict[str, tuple[str, ...]] = dict.fromkeys(DIGITS, _FINGER)
_LINKS["thumb"] = ("metacarpal", "proximal", "distal", "tip")


def _name(digit: str, link: str) -> str:
    is_phalanx = link not in ("metacarpal", "tip")
    return f"{_STEMS[digit]}-{'phalanx-' if is_phalanx else ''}{link}"


JOINTS_OF: dict[str, tuple[str, ...]] = {
    digit: tuple(_name(digit, link) for link in _LINKS[digit]) for digit in DIGITS
}
"""WebXR names of the joints of each digit, from its metacarpal to its tip."""

WEBXR_25: tuple[str, ...] = ("wrist", *(name for digit in DIGITS for name in JOINTS_OF[digit]))
"""The joints of WebXR Hand Input, in its order (W3C, WebXR Hand Input Module - Level 1)."""

OPENXR_26: tuple[str | None, ...] = (None, *WEBXR_25)
"""WebXR names in the order of ``XrHandJointEXT`` (OpenXR 1.0, XR_EXT_hand_tracking); None is its palm."""

JOINTS_16: tuple[str, ...] = (
    "wrist",
    *(name for digit in ("index", "middle", "little", "ring") for name in JOINTS_OF[digit][1:4]),
    *JOINTS_OF["thumb"][:3],
)
"""WebXR names in the order of MANO's 16 joints (Romero, Tzionas, Black 2017, ACM Trans. Graph. 36(6),
245)."""

JOINTS_21: tuple[str, ...] = (
    "wrist",
    *JOINTS_OF["thumb"],
    *(name for digit in DIGITS[1:] for name in JOINTS_OF[digit][1:]),
)
"""WebXR names in the order of 21 key points (Simon, Joo, Matthews, Sheikh 2017, CVPR, 1145-1153)."""

PARENTS: dict[str, str | None] = {"wrist": None}
"""The joint that each joint of WebXR hangs on."""
for _chain in JOINTS_OF.values():
    PARENTS |= zip(_chain, ("wrist", *_chain), strict=False)

DIGIT_OF: dict[str, str] = {name: digit for digit in DIGITS for name in JOINTS_OF[digit]}
"""The digit of each joint but the wrist."""

REFERENCE_LENGTH = 0.19
"""`length_of` a hand (m) for which distances along its skin are given; others have them in proportion."""

EACH_DIGIT = "each digit needs skin and joints; `press` takes a finger alone, its skin without joints"
"""What to do where there are fewer digits."""


def length_of(rest: Floats, names: Sequence[str]) -> float:
    """Return the way along the joints from the wrist to the tip joint of the middle finger (m)."""
    way = [names.index(name) for name in ("wrist", *JOINTS_OF["middle"][1:])]
    return float(np.linalg.norm(np.diff(rest[way, :3, 3], axis=0), axis=1).sum())


def lacking(names: Iterable[str]) -> str:
    """Return the first of WebXR's 25 joints that names lack, how many they are and what to do; or ""."""
    known = list(names)
    missing = [name for name in WEBXR_25 if name not in known]
    if not missing:
        return ""
    others = [name for name in known if name not in WEBXR_25]
    lower = {name.lower(): name for name in others}
    near = difflib.get_close_matches(missing[0], lower, n=1, cutoff=0.7)
    advice = f"; is {lower[near[0]]!r} meant?" if near else ""
    digits = {DIGIT_OF[name] for name in known if name in DIGIT_OF}
    if not near and 0 < len(digits) < len(DIGITS):
        advice = f": {EACH_DIGIT}"
    return f"joint {missing[0]!r} ({len(missing)} of WebXR's 25 are missing){advice}"


def index_of(name: str, known: Iterable[str], what: str, offered: Iterable[str] | None = None) -> int:
    """Return the place of a name among those known; a refusal offers the nearest one, of some where given.

    A refusal lists all where they are few, as poses and digits are.
    """
    names = list(known)
    if name in names:
        return names.index(name)
    names = names if offered is None else list(offered)
    # WebXR's word for a finger that is the little one here.
    meant = "little" if name == "pinky" and "little" in names else str(name)
    near = difflib.get_close_matches(meant, names, n=1, cutoff=0.0)
    every = f", of {', '.join(names)}" if 1 < len(names) < 10 else ""
    raise HandError(f"{what} {name!r} is not known; the nearest is {near[0]!r}{every}")
