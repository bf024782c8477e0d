"""Frames of joints as this package has them, from those of a file."""

from __future__ import annotations

from itertools import pairwise, permutations, product
from typing import TYPE_CHECKING

import numpy as np

from .joints import DIGITS, JOINTS_OF, PARENTS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..._arrays import Floats
    from ..hand import Side

_AS_MADE_HERE = 0.8  # least cosine between the axes of a file's frames and what they are to follow here


def uniform_frames(names: Sequence[str], frames: Floats) -> tuple[Floats, Side]:
    """Return frames (J, 4, 4) with +y along the bone and +z dorsal, and which hand it is.

    Bones lead from joint to joint. Which axes of the file's frames are dorsal is what fits all fingers best,
    as they are bent; the thumb's follow the same axes. Frames that are so in the file stay as they are.

    Parameters
    ----------
    names : sequence of str
        WebXR's 25 among them.
    frames : (J, 4, 4) float64
        As the file has them (m).
    """
    place = {name: frames[names.index(name), :3, 3] for name in PARENTS}
    bones = _bones(place)
    distal = unit(place[JOINTS_OF["middle"][1]] - place["wrist"])
    across = place[JOINTS_OF["little"][1]] - place[JOINTS_OF["index"][1]]
    dorsal = unit(np.cross(across - (across @ distal) * distal, distal))
    # The thumb lies on the palm's side of the knuckles.
    thumb = np.mean([place[name] for name in JOINTS_OF["thumb"]], axis=0)
    side: Side = "right"
    if (thumb - place["wrist"]) @ dorsal > 0.0:
        side, dorsal = "left", -dorsal
    upwards = _dorsal(bones, dorsal)
    turns = {name: frames[names.index(name), :3, :3] for name in PARENTS}

    def cosines(one: str, axes: Floats) -> tuple[float, float]:
        turn = turns[one]
        return float(turn @ axes[:, 1] @ bones[one]), float(turn @ axes[:, 2] @ upwards[one])

    axes = max(_quarter_turns(), key=lambda axes: sum(sum(cosines(one, axes)) for one in upwards))
    if (axes == np.eye(3)).all() and min(min(cosines(one, axes)) for one in upwards) > _AS_MADE_HERE:
        return frames, side
    made = frames.copy()
    for name in PARENTS:
        along = bones[name]
        up = dorsal if name == "wrist" else turns[name] @ axes[:, 2]
        sideways = np.cross(along, up)
        if np.linalg.norm(sideways) < 0.2:
            sideways = np.cross(along, dorsal)
        sideways = unit(sideways)
        made[names.index(name), :3, :3] = np.column_stack([sideways, along, np.cross(sideways, along)])
    return made, side


def side_of(names: Sequence[str], frames: Floats) -> Side:
    """Return which hand joints are of: a right one's index is left of its little finger, seen from the back.

    Parameters
    ----------
    names : sequence of str
        WebXR's 25 among them.
    frames : (J, 4, 4) float64
        +z dorsal (m).
    """
    place = {name: frames[names.index(name), :3, 3] for name in PARENTS}
    knuckles = [JOINTS_OF[digit][1] for digit in DIGITS[1:]]
    dorsal = np.sum([frames[names.index(name), :3, 2] for name in knuckles], axis=0)
    distal = np.mean([place[name] for name in knuckles], axis=0) - place["wrist"]
    across = place[knuckles[-1]] - place[knuckles[0]]
    return "right" if np.cross(across, distal) @ dorsal >= 0.0 else "left"


def _dorsal(bones: dict[str, Floats], dorsal: Floats) -> dict[str, Floats]:
    """Return the dorsal direction of each phalanx of the fingers: that of the hand, as far as bones bend."""
    found = {}
    for digit in DIGITS[1:]:
        before, upward = bones["wrist"], dorsal
        for name in JOINTS_OF[digit][1:-1]:
            bone = bones[name]
            # The least turn from bone to bone (Rodrigues), of what is perpendicular to the first.
            upward = upward - (upward @ bone) / (1.0 + before @ bone) * (before + bone)
            found[name], before = upward, bone
    return found


def _bones(place: dict[str, Floats]) -> dict[str, Floats]:
    """Return the direction of each bone; of a tip that of the phalanx before it."""
    bones = {"wrist": unit(place[JOINTS_OF["middle"][1]] - place["wrist"])}
    for digit in DIGITS:
        chain = JOINTS_OF[digit]
        for name, after in pairwise(chain):
            bones[name] = unit(place[after] - place[name])
        bones[chain[-1]] = bones[chain[-2]]
    return bones


def _quarter_turns() -> list[Floats]:
    """Return the 24 rotations that lead axes to axes."""
    found = []
    for order, signs in product(permutations(range(3)), product((1.0, -1.0), repeat=3)):
        turn = np.eye(3)[list(order)] * np.array(signs)[:, None]
        if np.linalg.det(turn) > 0.0:
            found.append(turn)
    return found


def unit(vector: Floats) -> Floats:
    """Return a vector at length 1; +y for one without length."""
    length = np.linalg.norm(vector)
    along: Floats = vector / length if length > 0.0 else np.array([0.0, 1.0, 0.0])
    return along
