"""What the built-in hand is made of: skin, joints and weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..._frozen import Frozen
from ..loft import Floats, Indices

__all__ = ["HandModel", "Side"]

Side = Literal["left", "right"]


@dataclass(frozen=True, eq=False)
class HandModel(Frozen):
    """A hand's skin with the joints that move it.

    Attributes
    ----------
    vertices : (n, 3) float64
        Skin and the cut at the wrist (m).
    faces : (m, 3) int64
        Counter-clockwise seen from outside.
    joint_names : tuple of str
        The 25 names of the WebXR hand.
    parents : (25,) int64
        Number of the joint that each hangs on; -1 for the wrist.
    rest : (25, 4, 4) float64
        Frames of the joints at rest (m): +y along the bone, +x the axis of flexion, +z out of the back.
    joints, weights : (n, 4)
        Joints that carry each vertex and their shares, which sum to 1.
    side : {"right", "left"}
        Which hand it is.
    """

    vertices: Floats
    faces: Indices
    joint_names: tuple[str, ...]
    parents: Indices
    rest: Floats
    joints: Indices
    weights: Floats
    side: Side

    def __post_init__(self) -> None:
        for name in ("vertices", "faces", "parents", "rest", "joints", "weights"):
            getattr(self, name).flags.writeable = False
