"""What a hand is made from, checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._check import as_array, reals_or_empty, short
from ..errors import HandError
from ..obstacle import Obstacle
from .rig.joints import DIGITS, EACH_DIGIT, JOINTS_OF, REFERENCE_LENGTH, WEBXR_25, lacking, length_of
from .rig.rotations import nearest_rotations

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from .._arrays import Floats
    from ..surface import Surface

__all__ = ["as_frames", "as_labels", "as_names", "as_parents", "check_inside", "check_movers"]

_FRAME_TOLERANCE = 1e-6  # of the entries of R'R - I
_OUTSIDE = 5e-3  # m, of a tip of a hand of REFERENCE_LENGTH: rigs end some digits just beyond the skin
_DEEPEST_TIP = 0.15  # of the way from wrist to middle tip: no finger is as thick
_CHECK = "check that skin and joints have the same unit and frame"


def as_names(names: Sequence[str]) -> tuple[str, ...]:
    """Return the names of the joints, each once, WebXR's 25 among them."""
    try:
        known = tuple(str(name) for name in names)
    except TypeError:
        raise TypeError(f"joint_names is {short(names)}, expected a sequence of names") from None
    double = sorted({name for name in known if known.count(name) > 1})
    if double:
        raise HandError(f"joint_names holds {double[0]!r} {known.count(double[0])} times")
    missing = lacking(known)
    if missing:
        raise HandError(f"joint_names has no {missing}")
    return known


def as_parents(parents: ArrayLike, names: tuple[str, ...]) -> NDArray[np.int64]:
    """Return the joint that each joint hangs on: one is the root, none hangs on itself."""
    try:
        rows = as_array("parents", parents)
    except TypeError:
        rows = np.empty(0)
    if rows.shape != (len(names),) or rows.dtype.kind not in "iu":
        raise HandError(f"parents is {short(parents)}, expected {len(names)} integers, -1 for the root")
    wrong = np.flatnonzero((rows < -1) | (rows >= len(names)))
    if len(wrong):
        raise HandError(f"parents[{wrong[0]}] is {rows[wrong[0]]}, expected -1 or a joint below {len(names)}")
    for joint in range(len(names)):
        seen: list[int] = []
        at = joint
        while at >= 0:
            if at in seen:
                circle = " on ".join(repr(names[one]) for one in [*seen[seen.index(at) :], at])
                raise HandError(f"parents run in a circle: {circle}; the root has -1")
            seen.append(at)
            at = int(rows[at])
    roots = [repr(name) for name, row in zip(names, rows, strict=True) if row < 0]
    if len(roots) > 1:
        more = f" and {len(roots) - 3} more" if len(roots) > 3 else ""
        raise HandError(
            f"parents has {len(roots)} roots, {', '.join(roots[:3])}{more}, expected one: let all others "
            "hang on the joint before them"
        )
    return rows.astype(np.int64)


def as_frames(rest: ArrayLike, names: tuple[str, ...]) -> Floats:
    """Return the frames (J, 4, 4) as rigid motions to the last digit."""
    frames = reals_or_empty(rest)
    if frames.shape != (len(names), 4, 4):
        raise HandError(f"rest has shape {frames.shape}, expected ({len(names)}, 4, 4)")
    # To the last digit, so that poses are rigid motions too.
    rotations, excess = nearest_rotations(frames[:, :3, :3])
    good = (
        np.isfinite(frames).all(axis=(1, 2)) & (excess < _FRAME_TOLERANCE) & (np.linalg.det(rotations) > 0.0)
    )
    good &= (frames[:, 3] == [0.0, 0.0, 0.0, 1.0]).all(axis=1)
    if not good.all():
        joint = int(np.flatnonzero(~good)[0])
        raise HandError(f"rest[{joint}] ({names[joint]}) is no rigid motion: {frames[joint].tolist()}")
    frames[:, :3, :3] = rotations
    return frames


def check_movers(joints: ArrayLike, count: int) -> None:
    """Refuse negative numbers of joints, which the core would take for large ones."""
    rows = np.atleast_1d(as_array("joints", joints))
    if rows.dtype.kind == "i" and (rows < 0).any():
        place = np.argwhere(rows < 0)[0]
        raise HandError(f"joints[{place[0]}] names joint {rows[tuple(place)]}, but there are {count}")


def as_labels(labels: ArrayLike, count: int) -> NDArray[np.str_]:
    """Return the label (n,) of each vertex."""
    words = as_array("labels", labels)
    if words.shape != (count,) or words.dtype.kind not in "UO":
        raise HandError(f"labels is {short(labels)}, expected one word for each of {count} vertices")
    return words.astype(np.str_)


def check_inside(surface: Surface, rest: Floats, names: tuple[str, ...]) -> None:
    """Refuse joints of the hand outside its skin, but digits may end just beyond it, and tips deep inside."""
    known = [names.index(name) for name in WEBXR_25]
    skin = Obstacle.mesh(surface.vertices, surface.faces, check_crossings=False)
    distance = skin.signed_distance(rest[known, :3, 3])[0]
    length = length_of(rest, names)
    is_tip = np.array([name.endswith("-tip") for name in WEBXR_25])
    outside = np.flatnonzero(distance > np.where(is_tip, _OUTSIDE * length / REFERENCE_LENGTH, 0.0))
    deep = np.flatnonzero(is_tip & (distance < -_DEEPEST_TIP * length))
    if len(outside):
        worst = outside[np.argmax(distance[outside])]
        place = rest[known[worst], :3, 3]
        lost = {WEBXR_25[joint] for joint in outside}
        whole = [digit for digit in DIGITS if lost.isdisjoint(JOINTS_OF[digit])]
        bare = [digit for digit in DIGITS if lost.issuperset(JOINTS_OF[digit][2:])]
        # In another unit or frame hardly a digit would fit.
        missing = f"it holds those of {', '.join(whole)}, and {EACH_DIGIT}; or "
        advice = (missing if whole and len(whole) + len(bare) == len(DIGITS) else "") + _CHECK
        raise HandError(
            f"the joint {WEBXR_25[worst]!r} at {short(place)} m lies {distance[worst] * 1e3:.2f} mm outside "
            f"the skin ({len(outside)} joints do): {advice}"
        )
    if len(deep):
        worst = deep[np.argmin(distance[deep])]
        raise HandError(
            f"the joint {WEBXR_25[worst]!r} lies {-distance[worst] * 1e3:.2f} mm inside the skin, of a hand "
            f"{length * 1e3:.4g} mm long by its joints: {_CHECK}"
        )
