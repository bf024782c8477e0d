"""Joints of the built-in hand: where they lie and how their frames stand.

Frame: origin at the wrist joint, +y to the middle knuckle, +z out of the back, +x = y x z (right hand). The
frame of each joint has +y along the bone that starts there, +x along the axis of flexion and +z out of the
back; flexion is a negative turn about +x.

Where the numbers come from (adults):

* lengths of metacarpals and phalanges and of the soft tissue at the tips: Buryanov and Kotiuk 2010,
  "Proportions of hand segments", Int. J. Morphol. 28(3), 755-758 (radiographs of 66 adults, means).
* from the wrist joint to the base of the third metacarpal: 0.54 times that bone's length (Youm et al. 1978,
  "Kinematics of the wrist", J. Bone Joint Surg. Am. 60(4), 423-431, the carpal height ratio).

Together they make a hand of 192 mm. Places of the knuckles across the palm, the spread of the fingers, the
thumb's stance and the slight bend at rest are drawn after open hands, not measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..._arrays import Floats
from ...hand.rig.joints import DIGITS, JOINTS_OF, WEBXR_25
from ..phalanges import LENGTHS

__all__ = ["REFERENCE_BREADTH", "REFERENCE_LENGTH", "Digit", "Skeleton", "skeleton_of"]

METACARPALS = {"thumb": 46.22e-3, "index": 68.12e-3, "middle": 64.60e-3, "ring": 58.00e-3, "little": 53.69e-3}
CARPUS = 0.54 * METACARPALS["middle"]
REFERENCE_LENGTH = CARPUS + METACARPALS["middle"] + sum(LENGTHS["middle"])
REFERENCE_BREADTH = 0.085  # of the drawn hand (m)

# Bases of the metacarpals, then the knuckles (x, z); of a hand REFERENCE_BREADTH broad (m).
BASES = {
    "thumb": (-20.0e-3, 22.0e-3, -11.0e-3),
    "index": (-10.5e-3, 30.0e-3, -1.0e-3),
    "middle": (-1.0e-3, CARPUS, -1.0e-3),
    "ring": (9.0e-3, 33.5e-3, -1.5e-3),
    "little": (17.5e-3, 31.0e-3, -3.0e-3),
}
KNUCKLES = {
    "index": (-22.0e-3, -1.5e-3),
    "middle": (0.0, 0.0),
    "ring": (20.3e-3, -1.5e-3),
    "little": (39.2e-3, -5.5e-3),
}
# Degrees: spread towards +x, roll of the back towards +x, slope of the first phalanx below the plane z = 0,
# then the bend of the further joints.
STANCES = {
    "index": (-5.5, -3.0, 4.0, 9.0, 5.0),
    "middle": (1.0, 0.0, 5.0, 10.0, 6.0),
    "ring": (7.5, 1.0, 7.0, 11.0, 6.0),
    "little": (16.0, 3.0, 8.0, 11.0, 6.0),
}
THUMB_ALONG = (-0.60, 0.70, -0.38)  # of the first metacarpal
THUMB_BACK = (-0.70, -0.10, 0.60)  # roughly where the nail looks: opposed by some 45 degrees
THUMB_BENDS = (10.0, 8.0)  # degrees


@dataclass(frozen=True)
class Digit:
    """Joints of one digit, from the base of its metacarpal to its tip."""

    name: str
    first: int  # number of the metacarpal's joint
    joints: Floats  # (k, 3) m
    frames: Floats  # (k, 3, 3), columns x, y, z
    pulp: float  # soft tissue beyond the tip (m)


@dataclass(frozen=True)
class Skeleton:
    """The hand's joints; a right hand."""

    digits: tuple[Digit, ...]

    def rest(self) -> Floats:
        """Return the rest frames (25, 4, 4) in m, in the order of WebXR."""
        frames = np.tile(np.eye(4), (len(WEBXR_25), 1, 1))
        for digit in self.digits:
            own = slice(digit.first, digit.first + len(digit.joints))
            frames[own, :3, :3] = digit.frames
            frames[own, :3, 3] = digit.joints
        return frames


def skeleton_of(hand_length: float, hand_breadth: float) -> Skeleton:
    """Return the skeleton of a right hand: bones go with its length, places across with its breadth (m)."""
    along, across = hand_length / REFERENCE_LENGTH, hand_breadth / REFERENCE_BREADTH
    digits = []
    for name in DIGITS:
        first = WEBXR_25.index(JOINTS_OF[name][0])
        bones = along * np.array(LENGTHS[name])[:0:-1]
        base = np.array(BASES[name]) * (across, along, across)
        chain = _thumb if name == "thumb" else _finger
        joints, frames = chain(name, base, along * METACARPALS[name], bones, across)
        digits.append(Digit(name, first, joints, frames, along * LENGTHS[name][0]))
    return Skeleton(tuple(digits))


def _finger(
    name: str, base: Floats, metacarpal: float, bones: Floats, across: float
) -> tuple[Floats, Floats]:
    x, z = across * np.array(KNUCKLES[name])
    rise = np.sqrt(metacarpal**2 - (x - base[0]) ** 2 - (z - base[2]) ** 2)
    knuckle = np.array([x, base[1] + rise, z])
    spread, roll, slope, *bends = np.radians(STANCES[name])
    back = np.array([np.sin(roll), 0.0, np.cos(roll)])
    along = np.array([np.sin(spread) * np.cos(slope), np.cos(spread) * np.cos(slope), -np.sin(slope)])
    first = frame_along(along, back)
    return _chain(base, knuckle, first, bones, list(bends), back)


def _thumb(name: str, base: Floats, metacarpal: float, bones: Floats, across: float) -> tuple[Floats, Floats]:
    frame = frame_along(np.array(THUMB_ALONG), np.array(THUMB_BACK))
    knuckle = base + metacarpal * frame[:, 1]
    first, *bends = np.radians(THUMB_BENDS)
    return _chain(base, knuckle, frame @ bent(first), bones, list(bends), frame[:, 2])


def _chain(
    base: Floats, knuckle: Floats, frame: Floats, bones: Floats, bends: list[float], back: Floats
) -> tuple[Floats, Floats]:
    """Return joints (k, 3) and frames (k, 3, 3) of metacarpal, phalanges and tip."""
    joints, frames = [base, knuckle], [frame_along(knuckle - base, back), frame]
    for bone, bend in zip(bones, [*bends, 0.0], strict=True):
        joints.append(joints[-1] + bone * frames[-1][:, 1])
        frames.append(frames[-1] @ bent(bend))
    return np.array(joints), np.array(frames)


def frame_along(along: Floats, back: Floats) -> Floats:
    """Return the axes (3, 3) with y along `along` and z as near to `back` as that allows."""
    y = along / np.linalg.norm(along)
    x = np.cross(y, back)
    x /= np.linalg.norm(x)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def bent(angle: float) -> Floats:
    """Return the turn (3, 3) of a flexion by `angle` (rad): negative about x."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, sine], [0.0, -sine, cosine]])
