"""The built-in hand put together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from ..._arrays import Floats, Indices
from ..._check import as_number
from ...errors import SurfaceError
from ...hand.rig.joints import PARENTS, WEBXR_25
from ..mesher import Body, contour, remeshed
from .shape import HandShape
from .sizes import size_of
from .skeleton import skeleton_of
from .weights import weights_of

if TYPE_CHECKING:
    from ...hand import Hand

__all__ = ["hand"]

EDGES = (1e-3, 5e-3)  # edge lengths that show a hand and fit a machine (m)
COARSEST = 0.06  # edge length over the hand's breadth: about a third of the little finger's
CELL = 1.2  # of the grid, over the edge length: as many cells are crossed as the mesh has vertices, about
COARSEST_CELL = 2.5e-3  # a coarser grid may bridge the gap between two fingers (m)
MARGIN = 0.03  # of the box around the joints, for a hand 85 mm broad (m)


def hand(
    *,
    side: Literal["right", "left"] = "right",
    hand_length: float = 0.190,
    hand_breadth: float = 0.085,
    percentile: Literal[5, 50, 95] | None = None,
    sex: Literal["female", "male"] | None = None,
    edge_length: float = 2e-3,
) -> Hand:
    """Return an open hand with its joints and weights.

    A drawn shape of human proportions: five digits, slightly bent and spread, the thumb opposed by some 45
    degrees, pads of thumb and little finger, a hollow palm, webs, nails as flats, no creases; cut off flat
    18 mm behind the wrist. Its frame: origin at the wrist joint, +y to the middle knuckle, +z out of the
    back, +x = y x z, so towards the little finger of a right hand; a left hand is its mirror image.

    Parameters
    ----------
    side : {"right", "left"}
        Which hand.
    hand_length : float
        From the wrist joint along the middle finger's bones to its tip (m), 0.09 to 0.26; lengths go with it.
    hand_breadth : float
        Across the knuckles, without the thumb (m); breadths and thicknesses go with it.
    percentile : {5, 50, 95}, optional
        Of adults, in place of the two lengths; with `sex`.
    sex : {"female", "male"}, optional
        Whose percentile.
    edge_length : float
        Mean edge of the mesh (m), 1e-3 to 5e-3, at most 0.06 of the breadth.

    Returns
    -------
    Hand
        Closed skin, the 25 joints of WebXR, up to four weights a vertex; about 13,000 vertices by default.

    Raises
    ------
    SurfaceError
        An argument is out of range, or both pairs of sizes are given.

    References
    ----------
    Buryanov and Kotiuk 2010, Int. J. Morphol. 28(3), 755-758 (lengths of metacarpals and phalanges); Youm et
    al. 1978, J. Bone Joint Surg. Am. 60(4), 423-431 (length of the carpus); Greiner 1991, Natick TR-92/011
    (breadths of the digits); Gordon et al. 2014, Natick/TR-15/007 (percentiles of length and breadth).

    Examples
    --------
    >>> import quasirigid as qr
    >>> hand = qr.models.hand(percentile=5, sex="female", edge_length=4e-3)
    >>> hand.surface.is_closed
    True
    >>> hand.posed("fist").surface.is_closed
    True
    """
    # Hands draw on this package for their bones, so they are there only when it is.
    from ...hand import Hand

    if side not in ("right", "left"):
        raise SurfaceError(f'side is {side!r}, expected "right" or "left"')
    length, breadth = size_of(hand_length, hand_breadth, percentile, sex)
    edge = as_number("edge_length", edge_length, SurfaceError, *EDGES)
    if edge > COARSEST * breadth:
        raise SurfaceError(
            f"edge_length is {edge:g} m, expected at most {COARSEST * breadth:.4f} m, {COARSEST:g} of the "
            "hand's breadth"
        )
    skeleton = skeleton_of(length, breadth)
    shape = HandShape(skeleton, length, breadth)
    vertices, faces = _skin(shape, edge)
    joints, weights = weights_of(vertices, shape)
    right = Hand(
        vertices,
        faces,
        joint_names=WEBXR_25,
        parents=_parents(),
        rest=skeleton.rest(),
        joints=joints,
        weights=weights,
    )
    return right if side == "right" else right.mirrored()


def _parents() -> list[int]:
    above = [PARENTS[name] for name in WEBXR_25]
    return [-1 if name is None else WEBXR_25.index(name) for name in above]


def _skin(shape: HandShape, edge_length: float) -> tuple[Floats, Indices]:
    joints = np.concatenate([digit.joints for digit in shape.skeleton.digits])
    margin = MARGIN * shape.across
    step = min(CELL * edge_length, COARSEST_CELL * shape.across)
    vertices, faces, on_cut = contour(
        shape.distance, joints.min(axis=0) - margin, joints.max(axis=0) + margin, step, shape.cut
    )
    body = Body(shape.distance, shape.cut, step=1e-4 * edge_length)
    return remeshed(vertices, faces, on_cut, body, edge_length)
