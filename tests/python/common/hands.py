"""Published hands, and parts of hands to make others of."""

from __future__ import annotations

from typing import Any

import quasirigid as qr

RIGS = ("webxr_right_13k", "libhand_right_13k", "makehuman_male_right_13k")
GLB = ("webxr_generic_hand_left", "webxr_generic_hand_right")
INDEX = "index-finger-phalanx-"


def parts_of(hand: qr.Hand) -> dict[str, Any]:
    return {
        "joint_names": hand.joint_names,
        "parents": hand.parents,
        "rest": hand.rest,
        "joints": hand.joints,
        "weights": hand.weights,
    }
