"""A hand in a pose."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from .joints import index_of
from .rays import way_out

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..surface import Surface
    from .hand import Hand
    from .rotations import Floats

__all__ = ["PosedHand"]

_BELOW = 5e-3  # m, below the mean of the palm's centre: inside the hand


@dataclass(frozen=True, kw_only=True, eq=False)
class PosedHand:
    """A hand in a pose, ready to press.

    Attributes
    ----------
    hand : Hand
        The hand at rest.
    surface : Surface
        The skin; its faces were checked at rest.
    joints : (J, 4, 4) float64
        Frames of the joints (m), in the order of `Hand.joint_names`.
    motions : (J, 4, 4) float64
        Motion of each joint from rest (m).
    """

    hand: Hand
    surface: Surface = field(repr=False)
    joints: Floats = field(repr=False)
    motions: Floats = field(repr=False)

    @property
    def labels(self) -> NDArray[np.str_]:
        """(n,) str: the region of each vertex."""
        return self.hand.labels

    @property
    def palm(self) -> Floats:
        """(4, 4) float64: frame of the palm (m).

        Origin at the palm's centre on the skin, +y distal, +z out of the palm, +x = y x z.
        """
        wrist, knuckle = (self.frame_of(name)[:3, 3] for name in ("wrist", "middle-finger-phalanx-proximal"))
        dorsal = self.frame_of("wrist")[:3, 2]
        distal = (knuckle - wrist) / np.linalg.norm(knuckle - wrist)
        out = -(dorsal - (dorsal @ distal) * distal)
        out /= np.linalg.norm(out)
        middle = self.surface.vertices[self.labels == "palm-center"].mean(axis=0) - _BELOW * out
        frame = np.eye(4)
        frame[:3, :3] = np.column_stack([np.cross(distal, out), distal, out])
        frame[:3, 3] = middle + way_out(self.surface, middle, out) * out
        return frame

    def frame_of(self, joint: str) -> Floats:
        """Return the frame (4, 4) of a joint (m), by its name."""
        frame: Floats = self.joints[index_of(joint, self.hand.joint_names, "the joint")]
        return frame
