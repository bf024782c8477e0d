"""The scenes of docs/paper.md: skins, products and bones of the test meshes that are CC0."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
import quasirigid as qr
from numpy.typing import NDArray

DATA = Path(os.environ.get("QUASIRIGID_DATA", Path(__file__).parents[2] / "../shared/data"))
FINGER = DATA / "hands/makehuman_female_right_middle_1500.ply"
HAND, JOINTS = DATA / "hands/makehuman_male_right_53k.ply", DATA / "hands/makehuman_male_right_joints.json"
SLAB, MOUSE = DATA / "products/gen_phone_slab.ply", DATA / "products/tbm_computer_mouse.ply"

MESHES = (FINGER, HAND, JOINTS, SLAB, MOUSE)

Floats = NDArray[np.float64]


class Scene(NamedTuple):
    """A skin, a product, the way it comes, the view of the cut, and what lies inside."""

    surface: qr.Surface
    product: qr.Obstacle
    direction: Floats
    bone: qr.Surface


def pitched(degrees: float) -> Floats:
    """Return the turn about x by an angle."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def skin_of(path: Path) -> qr.Surface:
    """Return a skin without its flat cuts."""
    surface = qr.read_surface(path, unit="m")
    return surface.with_skin_mask(qr.skin_without_caps(surface))


def finger_scene() -> Scene:
    """Return a middle finger of 1,500 vertices over a flat product, pitched by 25 degrees."""
    finger = skin_of(FINGER)
    turn = pitched(25.0)
    direction = turn[:, 2]
    slab = qr.read_obstacle(SLAB, unit="m").moved(turn, [-0.001, 0.034, -0.010] - 0.05 * direction)
    return Scene(finger, slab, direction, qr.models.bone_of(finger))


def joints() -> dict[str, Floats]:
    """Return the joints of the hand (m)."""
    return {joint["name"]: np.array(joint["position"]) for joint in json.loads(JOINTS.read_text())["joints"]}


def fingertip_scene(hand: qr.Surface) -> Scene:
    """Return the index finger cut out of the hand, over the same product."""
    at = joints()
    root, tip = at["index-finger-phalanx-intermediate"], at["index-finger-tip"]
    point = 0.7 * root + 0.3 * at["index-finger-phalanx-proximal"]
    nearest = int(np.argmin(np.linalg.norm(hand.vertices - tip, axis=1)))
    cut = qr.cut_out(hand, tip=nearest, point=point, normal=tip - root)
    bone = qr.models.bone_of(cut.surface, digit="index", cut=cut.fixed, scale=1.1)
    turn = pitched(-10.0)
    direction = turn[:, 2]
    slab = qr.read_obstacle(SLAB, unit="m").moved(turn, tip - [0.0, 0.01, 0.0] - 0.05 * direction)
    return Scene(cut.surface, slab, direction, bone)


def palm_scene(hand: qr.Surface) -> Scene:
    """Return the whole hand over a mouse, with rods for four metacarpals and one across for the wrist."""
    at = joints()
    rods = [rod(np.array([-4e-3, 26e-3, -4e-3]), np.array([18e-3, 30e-3, -4e-3]), 7e-3, 10)]
    for name in ("index", "middle", "ring", "pinky"):
        base, head = at[f"{name}-finger-metacarpal"], at[f"{name}-finger-phalanx-proximal"]
        rods.append(rod(0.7 * base + 0.3 * head, 0.1 * base + 0.9 * head, 3e-3, 6))
    starts = np.cumsum([0, *(len(points) for points, _ in rods)])
    bone = qr.Surface(
        np.concatenate([points for points, _ in rods]),
        np.concatenate([faces + start for (_, faces), start in zip(rods, starts[:-1], strict=True)]),
    )
    mouse = qr.read_obstacle(MOUSE, unit="m").moved(np.eye(3), [0.012, 0.07, -0.08])
    return Scene(hand, mouse, np.array([0.0, 0.0, 1.0]), bone)


def rod(first: Floats, last: Floats, radius: float, around: int) -> tuple[Floats, NDArray[np.int64]]:
    """Return a closed capsule between two points, `around` vertices on each ring."""
    length = float(np.linalg.norm(last - first))
    axis = (last - first) / length
    side = np.cross(axis, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    across = np.cross(axis, side)
    steps = int(np.ceil(length / (2 * np.pi * radius / around)))
    angles = np.linspace(0.0, np.pi / 2, 4)[1:]
    rings = [(-radius * np.cos(angle), radius * np.sin(angle)) for angle in angles]
    rings += [(length * step / steps, radius) for step in range(1, steps)]
    rings += [(length + radius * np.cos(angle), radius * np.sin(angle)) for angle in angles[::-1]]
    points = [(first - radius * axis)[None]]
    for number, (along, wide) in enumerate(rings):
        turn = (2 * np.arange(around) + number % 2) * np.pi / around
        circle = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * across
        points.append(first + along * axis + wide * circle)
    points.append((last + radius * axis)[None])
    end = 1 + len(rings) * around
    faces = []
    for j in range(around):
        k = (j + 1) % around
        faces += [(0, 1 + k, 1 + j), (end, end - around + j, end - around + k)]
        for number in range(len(rings) - 1):
            a, b = 1 + number * around + j, 1 + number * around + k
            c, d = a + around, b + around
            faces += [(a, b, d), (a, d, c)] if number % 2 else [(a, b, c), (b, d, c)]
    return np.concatenate(points), np.array(faces)
