"""Which joints carry the skin of the built-in hand: smooth weights from places along its digits.

Along a digit the weights pass from bone to bone within about half a breadth of the joint. The palm goes with
the metacarpals near to it, the heel of the hand with the wrist. Phalanges carry the skin of their own digit
alone: between two fingers their share fades to the metacarpals' before the skin of the next begins.
"""

from __future__ import annotations

import numpy as np

from ..loft import Floats, Indices
from .shape import HandShape
from .skeleton import JOINT_NAMES

__all__ = ["MOST", "weights_of"]

MOST = 4  # joints a vertex
BLENDS = (
    0.85,
    0.60,
    0.50,
)  # from knuckle to last joint: where two bones share the skin, in breadths of the digit
WRIST = (0.0, 34.0e-3)  # between these the metacarpals take over from the wrist (m)
BELONGS = (2.0e-3, 8.0e-3)  # skin farther from a digit than this is the palm's (m)
FADE = 10.0e-3  # by as much must a digit be nearer than the next to carry the skin alone (m)
REACH = 3.5e-3  # over which one metacarpal yields to the next (m)


def weights_of(points: Floats, shape: HandShape) -> tuple[Indices, Floats]:
    """Return joints (n, 4) and weights (n, 4) of skin points (n, 3) in m of a right hand."""
    weights = np.zeros((len(points), len(JOINT_NAMES)))
    distances = np.stack([digit.distance(points) for digit in shape.digits], axis=1)
    order = np.argsort(distances, axis=1)
    nearest = order[:, 0]
    least, second = (distances[np.arange(len(points)), order[:, place]] for place in (0, 1))
    apart = _step(second - least, 0.0, FADE * shape.across)
    near = 1.0 - _step(least, *(bound * shape.across for bound in BELONGS))
    left = np.ones(len(points))
    for number, (skin, digit) in enumerate(zip(shape.digits, shape.skeleton.digits, strict=True)):
        own = np.flatnonzero(nearest == number)
        _, along, _ = skin.local(points[own])
        knuckle = 1 if skin.name == "thumb" else 0
        joints = skin.joints[knuckle:-1]
        turns = [
            _step(along, joint - 0.5 * blend * skin.breadth, joint + 0.5 * blend * skin.breadth)
            for joint, blend in zip(joints, BLENDS, strict=False)
        ]
        turns[0] = turns[0] * near[own] * apart[own]
        left[own] = 1.0 - turns[0]
        carried = turns[0]
        for place, turn in enumerate([*turns[1:], np.zeros(len(own))]):
            weights[own, digit.first + 1 + place] = carried * (1.0 - turn)
            carried = carried * turn
    wrist = 1.0 - _step(points[:, 1], *(bound * shape.along for bound in WRIST))
    weights[:, 0] = left * wrist
    for digit, share in zip(shape.skeleton.digits, _shares(points, shape).T, strict=True):
        weights[:, digit.first] = left * (1.0 - wrist) * share
    return _most(weights)


def _shares(points: Floats, shape: HandShape) -> Floats:
    """Return the metacarpals' shares (n, 5), those of the nearest largest."""
    distances = []
    for digit in shape.skeleton.digits:
        base, knuckle = digit.joints[:2]
        bone, way = knuckle - base, points - base
        share = np.clip(way @ bone / (bone @ bone), 0.0, 1.0)
        distances.append(np.linalg.norm(way - share[:, None] * bone, axis=1))
    table = np.stack(distances, axis=1)
    shares: Floats = np.exp(-(table - table.min(axis=1, keepdims=True)) / (REACH * shape.across))
    shares /= shares.sum(axis=1, keepdims=True)
    return shares


def _step(values: Floats, low: float, high: float) -> Floats:
    """Return 0 below `low`, 1 above `high`, and a smooth rise between."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _most(weights: Floats) -> tuple[Indices, Floats]:
    """Return the joints of the largest weights, the largest first, and those weights made to sum to 1."""
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :MOST]
    largest = np.take_along_axis(weights, joints, axis=1)
    largest[largest < 1e-4] = 0.0
    joints[largest == 0.0] = 0
    return joints, largest / largest.sum(axis=1, keepdims=True)
