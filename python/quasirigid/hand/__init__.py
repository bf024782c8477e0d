"""Hands: skin that follows joints, poses, and the regions of the skin."""

from .bones import Bone as Bone
from .files.pose_file import read_pose as read_pose
from .files.read import read_hand as read_hand
from .grasp.close import close_hand as close_hand
from .grasp.grasp import Grasp as Grasp
from .hand import Hand as Hand
from .hand import Side as Side
from .pose import Mixed as Mixed
from .pose import Pose as Pose
from .pose import Preset as Preset
from .pose import mix as mix
from .posed import PalmFrame as PalmFrame
from .posed import PosedHand as PosedHand
from .rig.joints import DIGITS as DIGITS
from .rig.joints import JOINTS_16 as JOINTS_16
from .rig.joints import JOINTS_21 as JOINTS_21
from .rig.joints import OPENXR_26 as OPENXR_26
from .rig.joints import WEBXR_25 as WEBXR_25

__all__ = [
    "DIGITS",
    "JOINTS_16",
    "JOINTS_21",
    "OPENXR_26",
    "WEBXR_25",
    "Bone",
    "Grasp",
    "Hand",
    "Mixed",
    "PalmFrame",
    "Pose",
    "PosedHand",
    "Preset",
    "Side",
    "close_hand",
    "mix",
    "read_hand",
    "read_pose",
]
