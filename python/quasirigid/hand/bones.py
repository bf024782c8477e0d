"""Bones along the joints of a hand: phalanges, metacarpals, and one block for the carpals.

Sections are those of `models.bone_of`, with its sources. A bone's head is round about the joint that it
carries and the next bone begins beyond it, so that bones which turn about their joints keep clear of
each other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from .._frozen import Frozen
from ..models.fingers import REFERENCE_BREADTH
from ..models.loft import joined, loft
from ..models.phalanges import JOINT_GAP, LENGTHS, SECTIONS
from ..obstacle import Obstacle
from .regions import metacarpal_base
from .rig.joints import DIGITS, JOINTS_OF, REFERENCE_LENGTH

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from .._arrays import Floats, Indices
    from ..surface import Surface
    from .hand import Hand

_MIN_THICKNESS = 1e-3  # m, of tissue between bone and skin
_SLIMMER = 0.85  # factor from one try to the next
_SLIMMEST = 0.3  # of the published section; a bone that must be slimmer is left out
_CMC = 0.08  # of the length of a metacarpal, which it begins beyond its joint
_AROUND = 7  # vertices of a ring
_CARPALS = ((0.28, 0.09), (0.33, 0.11), (0.33, 0.11))  # half sizes over the breadth between outer knuckles
_WORDS: dict[str, tuple[str, ...]] = dict.fromkeys(DIGITS, ("metacarpal", "proximal", "middle", "distal"))
_WORDS["thumb"] = ("metacarpal", "proximal", "distal")
_KIND = {"distal": 0, "middle": 1, "proximal": 2, "metacarpal": 2}
"""Row of the table of sections; metacarpals have that of the proximal phalanges."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Bone(Frozen):
    """A bone, at rest or where its joint is.

    Attributes
    ----------
    name : str
        Such as "index-proximal", "thumb-metacarpal" or "carpals".
    joint : int
        The joint that it moves with.
    vertices : (n, 3) float64
        Its surface (m).
    faces : (m, 3) int64
        Counter-clockwise seen from outside.
    ends : (2, 3) float64
        Of its axis (m).
    share : float
        Of the published section; below 1 where the skin leaves no room for more.
    """

    name: str
    joint: int
    vertices: Floats
    faces: Indices
    ends: Floats
    share: float

    def moved(self, motion: Floats) -> Bone:
        """Return the bone after a rigid motion (4, 4)."""
        vertices, ends = (places @ motion[:3, :3].T + motion[:3, 3] for places in (self.vertices, self.ends))
        return replace(self, vertices=vertices, ends=ends)

    def slimmer(self) -> Bone | None:
        """Return the bone closer to its axis; None where it would be too slim."""
        if self.share * _SLIMMER < _SLIMMEST:
            return None
        axis = (self.ends[1] - self.ends[0]) / np.linalg.norm(self.ends[1] - self.ends[0])
        on_axis = self.ends[0] + np.outer((self.vertices - self.ends[0]) @ axis, axis)
        vertices = on_axis + _SLIMMER * (self.vertices - on_axis)
        return replace(self, vertices=vertices, share=_SLIMMER * self.share)


@dataclass(frozen=True, kw_only=True)
class _Rod:
    """A straight bone: its ends (m), half breadth and height (m) of its base, its waist and its head."""

    name: str
    joint: str
    start: Floats
    end: Floats
    dorsal: Floats
    halves: Floats

    def mesh(self) -> tuple[Floats, Indices]:
        """Return vertices (m) and faces."""
        way = self.end - self.start
        length = float(np.linalg.norm(way))
        axis = way / length
        dorsal = self.dorsal - (self.dorsal @ axis) * axis
        dorsal /= np.linalg.norm(dorsal)
        across = np.cross(axis, dorsal)
        halves = self.halves
        rows = max(5, round(length / (6.0 * np.pi * halves[1].mean() / _AROUND)))
        along = 0.5 * (1.0 - np.cos(np.pi * np.arange(1, rows) / rows))
        rings = []
        for row, at in enumerate(along):
            # Level at base, waist and head, round at both ends.
            step = np.clip((at - 0.1) / 0.45 if at < 0.55 else (at - 0.55) / 0.35, 0.0, 1.0)
            first = 0 if at < 0.55 else 1
            half = halves[first] + (halves[first + 1] - halves[first]) * step * step * (3.0 - 2.0 * step)
            radius = min(half[1], 0.4 * length)
            beyond = max(1.0 - min(at, 1.0 - at) * length / radius, 0.0)
            half = half * np.sqrt(1.0 - beyond * beyond)
            angle = 2.0 * np.pi * (np.arange(_AROUND) + 0.5 * ((len(along) - 1 - row) % 2)) / _AROUND
            ring = np.outer(half[0] * np.cos(angle), across) + np.outer(half[1] * np.sin(angle), dorsal)
            rings.append(self.start + at * way + ring)
        return loft(rings[::-1], self.end, self.start)


def bones_of(hand: Hand) -> tuple[Bone, ...]:
    """Return the bones of a hand at rest, but for those that its skin has no room for."""
    bones = []
    for rod in (_carpals(hand), *(rod for digit in DIGITS for rod in _rods(hand, digit))):
        vertices, faces = rod.mesh()
        ends = np.array([rod.start, rod.end])
        joint = hand.joint_names.index(rod.joint)
        bones.append(Bone(name=rod.name, joint=joint, vertices=vertices, faces=faces, ends=ends, share=1.0))
    return fitted(bones, hand.surface)


def fitted(bones: Iterable[Bone], surface: Surface) -> tuple[Bone, ...]:
    """Return bones, slimmer or left out where they come nearer than 1 mm to the skin or cross it or others.

    A fold of the skin may reach into a bone between its vertices, which are apart from it.
    """
    skin = Obstacle.mesh(surface.vertices, surface.faces, check_crossings=False)
    fitting: list[Bone] = []
    for bone in bones:
        slim: Bone | None = bone
        while slim is not None and -skin.signed_distance(slim.vertices)[0].max() < _MIN_THICKNESS:
            slim = slim.slimmer()
        if slim is not None:
            fitting.append(slim)
    while crossing := _crossing(fitting, surface):
        slimmer = (bone.slimmer() if at in crossing else bone for at, bone in enumerate(fitting))
        fitting = [bone for bone in slimmer if bone is not None]
    return tuple(fitting)


def _crossing(bones: Sequence[Bone], surface: Surface) -> set[int]:
    """Return which bones cross another or the skin."""
    if not bones:
        return set()
    meshes = [(surface.vertices, surface.faces), *((bone.vertices, bone.faces) for bone in bones)]
    of_face = np.repeat(np.arange(-1, len(bones)), [len(faces) for _, faces in meshes])
    crossing = _core.find_crossings(*joined(meshes))
    return set(of_face[crossing].ravel().tolist()) - {-1}


def _rods(hand: Hand, digit: str) -> list[_Rod]:
    """Return the bones of a digit, from its metacarpal on."""
    names, words = JOINTS_OF[digit], _WORDS[digit]
    places = np.array([metacarpal_base(hand, digit), *(hand.pivot_of(name) for name in names[1:])])
    scale = hand.length / REFERENCE_LENGTH
    halves = [0.5 * _girth(hand, digit) * np.array(SECTIONS[_KIND[word]][::-1]) for word in words]
    rods = []
    for at, word in enumerate(words):
        way = places[at + 1] - places[at]
        length = float(np.linalg.norm(way))
        axis = way / length
        # The head of the bone before ends half its height beyond the joint.
        begin = _CMC * length if at == 0 else halves[at - 1][-1, 1] + JOINT_GAP * scale
        if word == "distal":
            end = _core.way_out(hand.surface, places[at], axis) - LENGTHS[digit][0] * scale
        else:
            end = length + halves[at][-1, 1]
        rods.append(
            _Rod(
                name=f"{digit}-{word}",
                joint=names[at],
                start=places[at] + begin * axis,
                end=places[at] + end * axis,
                dorsal=hand.frame_of(names[at])[:3, 2],
                halves=halves[at],
            )
        )
    return rods


def _carpals(hand: Hand) -> _Rod:
    """Return the carpals as one block, from the wrist to short of the metacarpals."""
    wrist = hand.frame_of("wrist")
    bases = np.mean([metacarpal_base(hand, digit) for digit in DIGITS[1:]], axis=0)
    outer = hand.pivot_of(JOINTS_OF["little"][1]) - hand.pivot_of(JOINTS_OF["index"][1])
    return _Rod(
        name="carpals",
        joint="wrist",
        start=wrist[:3, 3],
        end=wrist[:3, 3] + 0.85 * (bases - wrist[:3, 3]),
        dorsal=wrist[:3, 2],
        halves=float(np.linalg.norm(outer)) * np.array(_CARPALS),
    )


def _girth(hand: Hand, digit: str) -> float:
    """Return the breadth of a digit at its last joint, over that of the tables."""
    joint = JOINTS_OF[digit][-2]
    across = hand.frame_of(joint)[:3, 0]
    breadth = sum(_core.way_out(hand.surface, hand.pivot_of(joint), sign * across) for sign in (1.0, -1.0))
    return breadth / REFERENCE_BREADTH
