"""The scenes of `quasirigid demo`: the built-in fingertip that is pressed, the built-in hand that grasps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .. import models
from ..contact import Contact, ContactOptions, press
from ..hand import close_hand
from ..io import compare_contacts, digit_table, grasp_record, save_contact, write_mesh
from ..io.atomic import png_bytes, write_files
from ..io.record import contact_record, figure
from ..plot import comparison_figure, grasp_figure
from ..skin import Body, HalfSpace, Skin
from ..surface import skin_without_caps
from .console import ContactTalk, Talk, progress, say
from .nodes import may_touch

__all__ = ["grasp_demo", "press_demo"]

_DEPTH, _SHEAR_MODULUS, _POISSON_RATIO = 1.12e-3, 60e3, 0.5
_UPWARDS = (0.0, 0.0, 1.0)
_INPUTS = {
    "depth": figure(_DEPTH, "m"),
    "shear_modulus": figure(_SHEAR_MODULUS, "Pa"),
    "poisson_ratio": figure(_POISSON_RATIO, "1"),
    "response": "body",
    "bone": "auto",
    "fixed": "caps",
    "skin_mask": "caps",
}
_GRASP_FORCE = 20.0
_HAND_EDGE = 2e-3


def press_demo(out: Path, edge_length: float, options: ContactOptions, talk: ContactTalk) -> dict[str, Any]:
    """Press finger and products, print the figures, write the files, and return the record.

    Parameters
    ----------
    out : path
        Folder for the meshes, with a folder for each product.
    edge_length : float
        Mean edge of finger and handle (m).
    options : ContactOptions
        How each contact is solved.
    talk : Talk
        How much is said, and in which form.
    """
    with progress("building finger, bone and products"):
        finger = models.fingertip(edge_length=edge_length)
        finger = finger.with_skin_mask(skin_without_caps(finger))
        bone = models.bone_of(finger)
        handle = models.cylinder_handle(edge_length=edge_length)
        below = finger.vertices[np.argmin(finger.vertices[:, 2])] - (0.0, 0.0, 0.04)
        # The bar lies across the finger: its axis z turned to x.
        across = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
        products = {
            "handle": handle.moved(across, below),
            "phone": models.rounded_box().moved(np.eye(3), below),
        }
    half_space, held = _skin(HalfSpace()), Body(bone=bone, fixed=~finger.skin_mask)
    first = {
        name: press(finger, product, half_space, _UPWARDS, depth=_DEPTH, options=options)
        for name, product in products.items()
    }
    near = [may_touch(finger, contact.obstacle, _DEPTH) for contact in first.values()]
    nodes = np.unique(np.concatenate(near))
    body = _skin(held).prepared(finger, nodes, progress=talk.progress)
    inputs = _INPUTS | {"target_error": figure(options.target_error, "1")}
    contacts: dict[str, Contact] = {}
    for name, product in products.items():
        with progress(f"pressing the {name}"):
            contact = press(finger, product, body, _UPWARDS, depth=_DEPTH, options=options)
        with progress(f"drawing and writing {out / name}"):
            save_contact(contact, out / name, inputs=inputs | {"scene": name}, pictures=True, bone=bone)
            both = {"half-space": first[name], "body": contact}
            write_files(out / name, {"responses.png": png_bytes(comparison_figure(both))})
        contacts |= {f"{name}: {response}": pressed for response, pressed in both.items()}
    write_mesh(finger.vertices, finger.faces, out / "fingertip.ply", unit="m")
    write_mesh(bone.vertices, bone.faces, out / "bone.ply", unit="m")
    if triangles := handle.triangles():
        write_mesh(*triangles, out / "handle.stl", unit="mm")
    record = {name: contact_record(contact) for name, contact in contacts.items()}
    lines = [compare_contacts(contacts, verbose=talk.verbose, warnings=False)]
    for name in products:
        pictures = ("skin.png", "footprint.png", "responses.png")
        lines.append(f"{name}: " + ", ".join(str(out / name / picture) for picture in pictures))
    if not talk.json:
        say("\n".join(lines))
    return record


def grasp_demo(out: Path, talk: Talk) -> dict[str, Any]:
    """Close the built-in hand on a bottle, as `press_demo`."""
    name, bottle = "grasped bottle", models.bottle()
    with progress("building the hand"):
        hand = models.hand(edge_length=_HAND_EDGE)
        product = bottle.placed(hand.posed("opposed").palm)
    with progress(f"closing the hand: {name}"):
        grasp = close_hand(
            hand, product, _skin(HalfSpace()), force=_GRASP_FORCE, start="opposed", throw=False
        )
    folder = out / name.replace(" ", "-")
    with progress(f"drawing and writing {folder}"):
        inputs = {"scene": name, "force": figure(_GRASP_FORCE, "N")}
        grasp.save(folder, inputs=inputs)
        write_files(folder, {"grasp.png": png_bytes(grasp_figure(grasp))})
    if not talk.json:
        say(f"{name}, {_GRASP_FORCE:g} N\n{digit_table(grasp)}\n{name}: {folder / 'grasp.png'}")
    if triangles := bottle.triangles():
        write_mesh(*triangles, out / "bottle.stl", unit="mm")
    return {name: grasp_record(grasp) | {"contact": contact_record(grasp.contact)}}


def _skin(response: HalfSpace | Body) -> Skin:
    return Skin(shear_modulus=_SHEAR_MODULUS, poisson_ratio=_POISSON_RATIO, response=response)
