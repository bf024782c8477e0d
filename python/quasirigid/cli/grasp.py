"""`quasirigid grasp`: a hand closes on a product."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray

import quasirigid as qr

from .._extras import need_matplotlib
from ..hand.grasp.close import MOST_NODES, TARGET_ERROR
from ..hand.rig.joints import DIGITS, index_of
from ..io import as_plain, compare_contacts, contact_record, digit_table, grasp_record
from ..io.grasps import GRASP_FILES
from ..io.record import figure
from .arguments import file_unit, parse_poisson_ratio, parse_response, rotation
from .console import ContactTalk, progress, refuse
from .folder import OutFolder, check_folder, check_inputs
from .hand import (
    HandFile,
    HandUnit,
    PoseWord,
    Rig,
    check_joints,
    hand_inputs,
    pose_file,
    read_pose_word,
    read_rigged,
)
from .product import ProductPoissonRatio, ProductShearModulus, parse_material
from .quantities import (
    ANGLE,
    FORCE,
    LENGTH,
    MASS,
    STRESS,
    QuantityError,
    parse_positive,
    parse_quantities,
)
from .scene import (
    GOAL_UNITS,
    CoupleFingers,
    MaxNodes,
    PoissonRatio,
    ProductFile,
    ProductUnit,
    ShearModulus,
    TargetError,
    options_of,
)

__all__ = ["GRASP_EXAMPLE", "GraspWords", "grasp"]

GRASP_EXAMPLE = (
    "quasirigid grasp built-in demo-output/bottle.stl --product-unit mm --start opposed --force 20N"
    " --out grasp-output"
)


@dataclass(frozen=True, kw_only=True)
class GraspWords:
    """Which hand closes on what, and how, as it is asked for."""

    hand: HandFile
    product: ProductFile
    force: Annotated[
        str | None,
        typer.Option(
            help="What the digits hold: 20N is their sum, half of it the thumb's; or thumb=8N,index=4N, where"
            " digits that are not named stay at the start."
        ),
    ] = None
    overlap: Annotated[
        str | None,
        typer.Option(help="In place of a force, how deep each digit goes, likewise, as in 2mm or index=2mm."),
    ] = None
    rig: Rig = None
    unit: HandUnit = "m"
    product_unit: ProductUnit = None
    start: PoseWord = "relaxed"
    end: PoseWord = "fist"
    rotate: Annotated[
        str,
        typer.Option(
            help="Turns of the product about x, y, z: across the palm, distal, out of it; then it comes down."
        ),
    ] = "0,0,0deg"
    shift: Annotated[
        str,
        typer.Option(
            help="Shift of the product from the palm's center along x and y, as in 0,10,0mm, and along z from"
            " where it touches."
        ),
    ] = "0,0,0mm"
    as_placed: Annotated[
        bool, typer.Option("--as-placed", help="Leave hand and product where their files have them.")
    ] = False
    product_mass: Annotated[str | None, typer.Option(help="As in 0.3kg: what is out of balance is told.")] = (
        None
    )
    product_shear_modulus: ProductShearModulus = None
    product_poisson_ratio: ProductPoissonRatio = None
    shear_modulus: ShearModulus = "60kPa"
    poisson_ratio: PoissonRatio = "0.495"
    response: Annotated[
        str,
        typer.Option(
            help="half-space; body: the hand's own bones, seconds to minutes; or a kernel of press."
        ),
    ] = "half-space"
    target_error: TargetError = f"{TARGET_ERROR:g}"
    max_nodes: MaxNodes = MOST_NODES
    couple_fingers: CoupleFingers = False
    pictures: Annotated[bool, typer.Option(help="Draw grasp.png, skin.png and footprint.png.")] = True
    out: OutFolder = None


@dataclass(frozen=True, kw_only=True)
class _Asked:
    """Which hand closes on what, and how: arguments of `close_hand`, and the inputs for the record."""

    hand: qr.Hand
    obstacle: qr.Obstacle
    skin: qr.Skin
    more: Mapping[str, Any]
    inputs: Mapping[str, Any]


def grasp(words: GraspWords, talk: ContactTalk) -> int:
    """Close a hand on a product until its digits hold it, and write what happens.

    Takes one of --force and --overlap.
    The product is laid across the palm, its longest axis along the knuckles, in touch.
    Writes what `press` writes, grasp.json, hand.glb and grasp.png.
    Exit status 0: every digit holds; 1: one does not, or the solver ended otherwise; 2: bad input.
    """
    asked = _read(words)
    held = qr.close_hand(
        asked.hand, asked.obstacle, asked.skin, **asked.more, progress=talk.progress, throw=False
    )
    figures = compare_contacts({words.product.stem: held.contact}, verbose=talk.verbose, warnings=False)
    text = f"{digit_table(held)}\n{figures}"
    record = grasp_record(held) | {"contact": contact_record(held.contact), "inputs": as_plain(asked.inputs)}
    save = partial(held.save, inputs=asked.inputs, pictures=words.pictures)
    talk.save_and_tell(text, record, words.out, save)
    if held.contact.status not in ("solved", "no_contact"):
        return refuse(f"the contact did not end solved: {held.contact.advice}", status=1)
    if held.missed:
        reasons = (f"{digit} {reason}" for digit, reason in held.missed.items())
        return refuse("; ".join(reasons), status=1)
    return 0


def _read(words: GraspWords) -> _Asked:
    """Return what is asked for; all words are checked before a file is read."""
    inputs = hand_inputs(words.hand, words.rig) | {"PRODUCT": words.product}
    inputs |= {"--start": pose_file(words.start), "--end": pose_file(words.end)}
    check_inputs(inputs)
    check_folder(words.out, GRASP_FILES, inputs)
    goal = _goal(words.force, words.overlap)
    options = options_of(words)
    modulus = parse_positive(words.shear_modulus, STRESS, "--shear-modulus")
    ratio = parse_poisson_ratio(words.poisson_ratio)
    material = parse_material(words.product_shear_modulus, words.product_poisson_ratio)
    skin = qr.Skin(shear_modulus=modulus, poisson_ratio=ratio, response=parse_response(words.response))
    angles = parse_quantities(words.rotate, 3, ANGLE, "--rotate")
    way = parse_quantities(words.shift, 3, LENGTH, "--shift")
    if words.as_placed and any([*angles, *way]):
        raise QuantityError(
            "--rotate and --shift are of a product in the palm: leave out --as-placed, or them"
        )
    mass = None if words.product_mass is None else parse_positive(words.product_mass, MASS, "--product-mass")
    poses = {"start": read_pose_word(words.start), "end": read_pose_word(words.end)}
    if words.out is not None and words.pictures:
        need_matplotlib()
    in_unit = file_unit(words.product_unit or words.unit, "--product-unit")
    with progress(f"reading {words.hand} and {words.product}"):
        hand = read_rigged(words.hand, words.rig, words.unit)
        check_joints(words.start, poses["start"], hand)
        check_joints(words.end, poses["end"], hand)
        obstacle = material.given_to(qr.read_obstacle(words.product, unit=in_unit))
    if not words.as_placed:
        obstacle = _in_palm(obstacle, hand.posed(poses["start"]).palm, rotation(angles), way)
    record = {
        "hand": words.hand,
        "rig": None if words.rig is None else str(words.rig),
        "unit": words.unit,
        "product": str(words.product),
        "product_unit": in_unit,
        "rotate": figure(angles, "rad"),
        "shift": figure(way, "m"),
        "as_placed": words.as_placed,
        "product_mass": None if mass is None else figure(mass, "kg"),
        **material.inputs,
        **{name: figure(value, GOAL_UNITS[name]) for name, value in goal.items()},
        "start": words.start,
        "end": words.end,
        "shear_modulus": figure(modulus, "Pa"),
        "poisson_ratio": figure(ratio, "1"),
        "response": words.response,
        "target_error": figure(options.target_error, "1"),
        "max_nodes": options.max_nodes,
        "couple_fingers": options.couple_fingers,
    }
    more = {**goal, **poses, "product_mass": mass, "options": options}
    return _Asked(hand=hand, obstacle=obstacle, skin=skin, more=more, inputs=record)


def _in_palm(
    obstacle: qr.Obstacle, palm: NDArray[np.float64], turn: NDArray[np.float64], way: Sequence[float]
) -> qr.Obstacle:
    """Return the product laid across the palm in touch, turned, and shifted along the palm's axes."""
    across, distal, out_of_palm = palm[:3, :3].T
    middle = palm.copy()
    middle[:3, 3] += way[0] * across + way[1] * distal
    try:
        placed = obstacle.placed(middle, rotation=turn)
    except qr.ObstacleError as error:
        raise qr.ObstacleError(
            f"the product does not come to lie on the palm: {error}; check --product-unit, --rotate, --shift"
        ) from error
    return placed.moved(translation=way[2] * out_of_palm)


def _goal(force: str | None, overlap: str | None) -> dict[str, Any]:
    """Return the force or the overlap that is asked for: a number, or one for each digit."""
    if (force is None) == (overlap is None):
        given = "neither" if force is None else "both"
        raise QuantityError(f"give one of --force and --overlap; given: {given}")
    name, text, units = ("overlap", overlap, LENGTH) if force is None else ("force", force, FORCE)
    if text is None or "=" not in text:
        return {name: parse_positive(text or "", units, f"--{name}")}
    goal: dict[str, float] = {}
    for part in text.split(","):
        digit, _, value = (word.strip() for word in part.partition("="))
        index_of(digit, DIGITS, f"--{name}: the digit")
        if digit in goal:
            raise QuantityError(f"--{name}: {digit!r} stands there twice")
        goal[digit] = parse_positive(value, units, f"--{name}")
    return {name: goal}
