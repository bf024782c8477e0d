"""What `quasirigid demo` shows: the built-in fingertip over a handle and over a phone-sized box."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import typer
from numpy.typing import NDArray

from .. import models
from ..contact import Contact, press
from ..io import write_contact, write_mesh
from ..models.products import build_cylinder_handle
from ..obstacle import Obstacle
from ..plot import side_by_side
from ..skin import Body, HalfSpace, Skin
from ..surface import Surface, flat_cap_mask
from .console import print_contacts, progress
from .nodes import may_touch

__all__ = ["Scene", "demo_scenes", "press_demo", "under_the_pad"]


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A finger and a product below its pad.

    Attributes
    ----------
    name : str
        For folders and tables.
    surface : Surface
        The finger, its cut face no skin.
    bone : Surface
        Its phalanges.
    obstacle : Obstacle
        The product, where it starts.
    direction : (3,) float64
        The way it comes, a unit vector.
    """

    name: str
    surface: Surface
    bone: Surface
    obstacle: Obstacle
    direction: NDArray[np.float64]


def demo_scenes(edge_length: float) -> list[Scene]:
    """The two scenes; finger and handle have a mean edge of `edge_length` (m)."""
    finger = models.fingertip(edge_length=edge_length)
    finger = finger.with_skin_mask(flat_cap_mask(finger))
    bone = models.bone_of(finger)
    # The bar lies across the finger: its axis z turned to x.
    across = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    place = under_the_pad(finger.vertices, below=0.04)
    upwards = np.array([0.0, 0.0, 1.0])
    handle = models.cylinder_handle(edge_length=edge_length).moved(across, place)
    phone = models.rounded_box().moved(np.eye(3), place)
    return [
        Scene(name="handle", surface=finger, bone=bone, obstacle=handle, direction=upwards),
        Scene(name="phone", surface=finger, bone=bone, obstacle=phone, direction=upwards),
    ]


def under_the_pad(vertices: NDArray[np.float64], below: float) -> NDArray[np.float64]:
    """The point (3,) in m that lies `below` (m) the lowest point of a finger's pad."""
    point: NDArray[np.float64] = vertices[np.argmin(vertices[:, 2])] - np.array([0.0, 0.0, below])
    return point


def press_demo(out: Path, edge_length: float) -> None:
    """Press both scenes, print their figures and write their files into `out`."""
    depth = 1.12e-3
    with progress("building finger, bone and products"):
        scenes = demo_scenes(edge_length)
    surface, bone = scenes[0].surface, scenes[0].bone
    half_space = Skin(shear_modulus=60e3, poisson_ratio=0.5, response=HalfSpace())
    first = {
        scene.name: press(surface, scene.obstacle, half_space, scene.direction, depth=depth)
        for scene in scenes
    }
    nodes = np.unique(np.concatenate([may_touch(contact, depth) for contact in first.values()]))
    body = Skin(
        shear_modulus=60e3, poisson_ratio=0.5, response=Body(bone=bone, fixed=~surface.skin_mask)
    ).prepared(surface, nodes, progress=True)
    inputs = {
        "depth": {"value": depth, "unit": "m"},
        "shear_modulus": {"value": 60e3, "unit": "Pa"},
        "poisson_ratio": {"value": 0.5, "unit": "1"},
        "response": "body",
        "bone": "auto",
        "fixed": "caps",
        "skin_mask": "caps",
    }
    contacts: dict[str, Contact] = {}
    for scene in scenes:
        with progress(f"pressing the {scene.name}"):
            contact = press(surface, scene.obstacle, body, scene.direction, depth=depth)
        folder = out / scene.name
        with progress(f"drawing and writing {folder}"):
            write_contact(contact, folder, inputs=inputs | {"scene": scene.name}, bone=bone)
            both = {"half-space": first[scene.name], "body": contact}
            side_by_side(both).savefig(folder / "responses.png")
        contacts |= {f"{scene.name}: {name}": pressed for name, pressed in both.items()}
    write_mesh(surface.vertices, surface.faces, out / "fingertip.ply", unit="m")
    write_mesh(bone.vertices, bone.faces, out / "bone.ply", unit="m")
    write_mesh(*build_cylinder_handle(0.016, 0.110, 0.003, edge_length), out / "handle.stl", unit="mm")
    print_contacts(contacts)
    for scene in scenes:
        pictures = ("skin.png", "footprint.png", "responses.png")
        typer.echo(f"{scene.name}: " + ", ".join(str(out / scene.name / name) for name in pictures))
