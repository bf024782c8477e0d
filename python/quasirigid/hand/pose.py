"""Poses: angles of the joints, presets, and what lies between two of them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._arrays import Floats
from .._check import as_share, real_or_nan, reals_or_empty, short
from ..errors import HandError, QuasirigidWarning
from .rig.joints import DIGIT_OF, DIGITS, JOINTS_OF, index_of
from .rig.rotations import about, between, from_vectors, product

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .hand import Hand

__all__ = ["ANGLES", "PRESETS", "Mixed", "Pose", "Preset", "mix", "turned_joint"]

Preset = Literal["flat", "open", "opposed", "relaxed", "cylinder", "sphere", "pinch", "point", "fist"]
"""A pose by its name, as `Hand.posed` takes it."""

ANGLES = ("flexion", "abduction", "twist")

_Range = tuple[float, float]
_FINGER: dict[int, dict[str, _Range]] = {
    0: {"flexion": (-5, 25), "abduction": (-10, 10), "twist": (-10, 10)},
    1: {"flexion": (-45, 90), "abduction": (-25, 25), "twist": (-20, 20)},
    2: {"flexion": (-10, 110), "abduction": (-5, 5), "twist": (-10, 10)},
    3: {"flexion": (-20, 90), "abduction": (-5, 5), "twist": (-10, 10)},
}
_THUMB: dict[int, dict[str, _Range]] = {
    0: {"flexion": (-20, 45), "abduction": (-30, 70), "twist": (-30, 60)},
    1: {"flexion": (-10, 60), "abduction": (-15, 15), "twist": (-20, 20)},
    2: {"flexion": (-20, 85), "abduction": (-5, 5), "twist": (-10, 10)},
}
"""Ranges of motion (degrees): flexion of phalanges from the straight digit, all else from rest. Means of
healthy adults and two standard deviations (Greene, Heckman 1994, The Clinical Measurement of Joint Motion,
AAOS; Hume, Gellman, McKellop, Brumfield 1990, J. Hand Surg. Am. 15(2), 240-243; Cooney, Lucca, Chao,
Linscheid 1981, J. Bone Joint Surg. Am. 63(9), 1371-1381); twist and sideways play of hinges are rounded
up."""

_HALF_TURN: _Range = (-180, 180)  # degrees, of the wrist and others: beyond, an angle is in another unit


def _preset(
    fingers: tuple[float, float, float],
    thumb: tuple[float, float, float],
    *,
    spread: float = 0.0,
    oppose: float = 0.0,
    lift: float = 0.0,
    **other: tuple[float, float, float],
) -> dict[str, dict[str, float]]:
    """Return degrees: flexion of the three joints of fingers and thumb, what deviates by the digit's name."""
    angles: dict[str, dict[str, float]] = {}
    for digit in DIGITS[1:]:
        for name, flexion in zip(JOINTS_OF[digit][1:4], other.get(digit, fingers), strict=True):
            angles[name] = {"flexion": flexion}
        angles[JOINTS_OF[digit][1]]["abduction"] = 0.0 if digit == "middle" else spread
    for name, flexion in zip(JOINTS_OF["thumb"][:3], thumb, strict=True):
        angles[name] = {"flexion": flexion}
    angles[JOINTS_OF["thumb"][0]] |= {"abduction": lift, "twist": oppose}
    return angles


PRESETS: dict[str, dict[str, dict[str, float]]] = {
    "flat": _preset((0, 0, 0), (0, 0, 0)),
    "open": _preset((0, 0, 0), (-20, 0, 0), spread=5, lift=-30),
    "opposed": _preset((0, 0, 0), (-20, 0, 0), oppose=40, lift=40),
    "relaxed": _preset((25, 30, 12), (5, 10, 10), oppose=5),
    "cylinder": _preset((45, 55, 30), (10, 20, 25), oppose=35, lift=15),
    "sphere": _preset((35, 45, 25), (5, 15, 20), spread=12, oppose=30, lift=20),
    "pinch": _preset((25, 30, 15), (20, 20, 30), oppose=40, lift=15, index=(45, 50, 25)),
    "point": _preset((75, 90, 50), (25, 40, 40), oppose=30, index=(0, 0, 0)),
    "fist": _preset((85, 100, 60), (25, 45, 55), oppose=45, lift=30),
}
"""Angles (degrees): flexion from the straight digit, of a thumb's metacarpal and all else from rest."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Mixed:
    """A pose between two: every joint so far on the shorter way from one to the other; made by `mix`.

    Attributes
    ----------
    first, second : pose
        The two, as for `Hand.posed`.
    share : float
        0 is the first, 1 the second.
    """

    first: Pose
    second: Pose
    share: float


Pose: TypeAlias = (
    Preset | Mapping[str, float | Mapping[str, float]] | NDArray[Any] | Sequence[Sequence[float]] | Mixed
)
"""A pose as `Hand.posed` takes it: a preset, angles by joint, an array of turns, or one between two."""


def mix(first: Pose, second: Pose, share: float) -> Mixed:
    """Return the pose that lies so far from one to another.

    Parameters
    ----------
    first, second : pose
        As for `Hand.posed`.
    share : float
        0 is the first, 1 the second.

    Returns
    -------
    Mixed
        A pose, for `Hand.posed` or another mixture.

    Raises
    ------
    HandError
        If the share is not from 0 to 1.

    Examples
    --------
    >>> import quasirigid as qr
    >>> half_closed = qr.hand.mix("flat", "fist", 0.5)
    >>> half_closed.share
    0.5
    """
    return Mixed(first=first, second=second, share=as_share("share", share, HandError))


def turns_of(pose: Pose, hand: Hand) -> Floats:
    """Return the turn (J, 4) of every joint against its rest frame."""
    if isinstance(pose, Mixed):
        first, second = (turns_of(one, hand) for one in (pose.first, pose.second))
        return between(first, second, pose.share)
    if isinstance(pose, str):
        return _of_preset(pose, hand)
    if isinstance(pose, Mapping):
        return _of_mapping(pose, hand)
    return _of_array(pose, len(hand.joint_names))


def _of_array(pose: ArrayLike, count: int) -> Floats:
    rows = reals_or_empty(pose)
    if rows.shape not in ((count, 3), (count, 4)):
        raise HandError(
            f"pose is {short(pose)}, expected a preset's name, a mapping of joint names to angles, or an "
            f"array ({count}, 3) of rotation vectors or ({count}, 4) of quaternions x, y, z, w"
        )
    if not np.isfinite(rows).all():
        joint = int(np.flatnonzero(~np.isfinite(rows).all(axis=1))[0])
        raise HandError(f"pose[{joint}] is {short(rows[joint])}, expected finite numbers")
    if rows.shape[1] == 3:
        return from_vectors(rows)
    lengths = np.linalg.norm(rows, axis=1)
    if (np.abs(lengths - 1.0) > 1e-3).any():
        joint = int(np.argmax(np.abs(lengths - 1.0)))
        raise HandError(
            f"pose[{joint}] has length {lengths[joint]:.6g}, expected a unit quaternion x, y, z, w"
        )
    turns: Floats = rows / lengths[:, None]
    return turns


def _of_preset(pose: str, hand: Hand) -> Floats:
    """Return the turns of a preset, the same bend of the digits whatever their bend at rest."""
    index_of(pose, PRESETS, "the pose")
    bend = bend_at_rest(hand)
    angles = np.zeros((len(hand.joint_names), 3))
    for name, wanted in PRESETS[pose].items():
        if name in hand.joint_names:
            joint = hand.joint_names.index(name)
            row = [math.radians(wanted.get(angle, 0.0)) for angle in ANGLES]
            angles[joint] = row
            angles[joint, 0] -= bend[joint]
    return _turns(angles, hand)


def _of_mapping(pose: Mapping[str, float | Mapping[str, float]], hand: Hand) -> Floats:
    """Return the turns of angles that are named, each within what a joint can do."""
    angles = np.zeros((len(hand.joint_names), 3))
    for name, value in pose.items():
        joint = turned_joint(name, hand)
        given = value if isinstance(value, Mapping) else {"flexion": value}
        for angle, amount in given.items():
            column = index_of(angle, ANGLES, f"the angle of {name}")
            angles[joint, column] = _as_angle(f"{angle} of {name}", amount)
        if angles[joint].any() and not _moves_skin(joint, hand):
            warnings.warn(f"{name} moves no skin: its angles change nothing", QuasirigidWarning, stacklevel=5)
    return _turns(_within_limits(angles, hand), hand)


def turned_joint(name: str, hand: Hand, what: str = "the joint") -> int:
    """Return the number of a joint; a refusal offers one that moves skin, of a digit's name its first."""
    moving = [known for joint, known in enumerate(hand.joint_names) if _moves_skin(joint, hand)]
    return index_of(name, hand.joint_names, what, JOINTS_OF[name][:1] if name in DIGITS else moving)


def _moves_skin(joint: int, hand: Hand) -> bool:
    return joint in hand.parents or bool(hand._shares[:, joint].any())


def _as_angle(name: str, value: Any) -> float:
    angle = real_or_nan(value)
    if not math.isfinite(angle):
        raise HandError(f"{name} is {short(value)}, expected a finite angle (rad)")
    return angle


def _within_limits(angles: Floats, hand: Hand) -> Floats:
    """Return angles from rest that no joint of a healthy hand exceeds, and warn of those that did."""
    bend = bend_at_rest(hand)
    kept, said = angles.copy(), []
    for joint, name in enumerate(hand.joint_names):
        for column, angle in enumerate(ANGLES):
            if angles[joint, column] == 0.0:
                continue
            # The place at rest is always within reach.
            at_rest = bend[joint] if angle == "flexion" else 0.0
            low, high = (math.radians(limit) - at_rest for limit in _limits(name, angle))
            low, high = min(low, 0.0), max(high, 0.0)
            kept[joint, column] = min(max(angles[joint, column], low), high)
            if kept[joint, column] != angles[joint, column]:
                said.append(
                    f"{angle} of {name} is {math.degrees(angles[joint, column]):.0f} degrees, "
                    f"taken as {math.degrees(kept[joint, column]):.0f}"
                )
    if said:
        more = f" (and {len(said) - 1} more)" if len(said) > 1 else ""
        why = f"beyond what the joint can do: {said[0]}{more}; angles are in rad, of a file in its unit"
        warnings.warn(why, QuasirigidWarning, stacklevel=5)
    return kept


def _limits(name: str, angle: str) -> _Range:
    digit = DIGIT_OF.get(name)
    if digit is None:
        return _HALF_TURN
    ranges = (_THUMB if digit == "thumb" else _FINGER).get(JOINTS_OF[digit].index(name), {})
    return ranges.get(angle, _HALF_TURN)


def bend_at_rest(hand: Hand) -> Floats:
    """Return by how much (J,) (rad) each phalanx is bent at rest; 0 for other joints.

    A finger's first phalanx is measured against the wrist: many rigs have a mere stub for its metacarpal.
    """
    bend = np.zeros(len(hand.joint_names))
    wrist = hand.joint_names.index("wrist")
    for joint, (name, parent) in enumerate(zip(hand.joint_names, hand.parents, strict=True)):
        digit = DIGIT_OF.get(name)
        if digit is None or parent < 0 or name in (JOINTS_OF[digit][0], JOINTS_OF[digit][-1]):
            continue
        before = wrist if digit != "thumb" and name == JOINTS_OF[digit][1] else parent
        # y of the joint in that frame: (-sin a, cos a cos f, -cos a sin f).
        _, y, z = hand.rest[before, :3, :3].T @ hand.rest[joint, :3, 1]
        bend[joint] = math.atan2(-z, y)
    return bend


def _turns(angles: Floats, hand: Hand) -> Floats:
    """Return turns by flexion about x, then abduction about z, then twist about the bone."""
    digits = [DIGIT_OF.get(name, "middle") for name in hand.joint_names]
    sideways = np.array([_sideways(digit, hand.side) for digit in digits])
    mirror = 1.0 if hand.side == "right" else -1.0
    flexion, abduction, twist = angles.T
    turned = product(about(2, sideways * abduction), about(1, -mirror * twist))
    return product(about(0, -flexion), turned)


def _sideways(digit: str, side: str) -> float:
    """Return the sense of the turn about z that leads a digit away from the middle finger."""
    radial = 1.0 if side == "right" else -1.0
    return -radial if digit in ("ring", "little") else radial
