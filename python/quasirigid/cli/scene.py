"""The scene of a press, from the words of the command line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import typer

import quasirigid as qr

from .._units import UNITS
from .arguments import (
    choice,
    file_unit,
    parse_body,
    parse_response,
    parse_target_error,
    rotation,
    with_skin_mask,
)
from .console import progress
from .nodes import free_nodes, may_touch
from .quantities import (
    ANGLE,
    FORCE,
    LENGTH,
    STRESS,
    QuantityError,
    parse_numbers,
    parse_quantities,
    parse_quantity,
)

__all__ = ["GOAL_UNITS", "TARGET_ERROR", "UNIT_NAMES", "Scene", "parse_goal", "prepared_skin", "read_scene"]

UNIT_NAMES = f"{', '.join(list(UNITS)[:-1])} or {list(UNITS)[-1]}"
TARGET_ERROR = "none" if (_target := qr.ContactOptions().target_error) is None else f"{_target:g}"
GOAL_UNITS = {"depth": "m", "force": "N", "overlap": "m"}

SkinFile = Annotated[Path, typer.Argument(metavar="SKIN", help="Hand or finger mesh: .ply, .stl or .obj.")]
ProductFile = Annotated[Path, typer.Argument(metavar="PRODUCT", help="Closed product mesh.")]
Unit = Annotated[str, typer.Option(help=f"Unit of the skin file: {UNIT_NAMES}.")]
Direction = Annotated[str, typer.Option(help="The way the product comes, as in 0,0,1.")]
ShearModulus = Annotated[str, typer.Option(help="Of the skin, as in 60kPa.")]
PoissonRatio = Annotated[float, typer.Option(help="Of the skin, 0 to 0.5.")]
ProductUnit = Annotated[str | None, typer.Option(help="Unit of the product file [default: as --unit].")]
Translate = Annotated[str, typer.Option(help="Shift of the product, after turning it, as in 0,0,-20mm.")]
Rotate = Annotated[
    str, typer.Option(help="Turns of the product about the fixed axes x, then y, then z, as in 0,0,90deg.")
]
ResponseName = Annotated[
    str,
    typer.Option(
        help="half-space; body (see --bone and --fixed); layer:thickness=5mm (on bone); or"
        " gaussian:height=0.8mm/N,width=5mm,cutoff=15mm (the paper's). The kernels take pressure=linear"
        " or pressure=one_ring, half-space and layer discretization=collocation or"
        " discretization=galerkin too, as in half-space:discretization=galerkin."
    ),
]
Bone = Annotated[
    str | None,
    typer.Option(
        help="Of a body: auto draws plausible phalanges into a finger with its pad to -z; FILE"
        " holds closed bones, in the skin's unit; none. [default: auto]"
    ),
]
Fixed = Annotated[
    str | None,
    typer.Option(
        help="Of a body, what does not move: caps, the flat cut faces; none; FILE.npy holds a bool for"
        " each vertex. [default: caps]"
    ),
]
SkinMask = Annotated[
    str,
    typer.Option(
        help="What may touch: caps leaves out flat cut faces, none leaves out nothing, FILE.npy holds a"
        " bool for each vertex."
    ),
]
StartName = Annotated[
    str, typer.Option(help="infinity: first touch counts from far away; current: from here.")
]
TargetError = Annotated[
    str,
    typer.Option(
        help="Error of force and area that the mesh may leave, as 0.02: the mesh is refined around the"
        " contact until the estimates are below; none takes it as it is."
    ),
]


@dataclass(frozen=True, kw_only=True)
class Scene:
    """What is pressed on what, and how."""

    surface: qr.Surface
    obstacle: qr.Obstacle
    skin: qr.Skin
    body: qr.Body | None
    motion: Mapping[str, Any]
    options: qr.ContactOptions
    inputs: Mapping[str, Any]


def read_scene(
    skin_file: Path,
    product_file: Path,
    *,
    unit: str,
    product_unit: str | None,
    translate: str,
    rotate: str,
    direction: str,
    start: str,
    shear_modulus: str,
    poisson_ratio: float,
    response: str,
    bone: str | None,
    fixed: str | None,
    skin_mask: str,
    target_error: str,
) -> Scene:
    """Return the scene; everything is checked before a file is read."""
    motion: dict[str, Any] = {
        "direction": parse_numbers(direction, 3, "--direction"),
        "start": choice(start, ("infinity", "current"), "--start"),
    }
    options = qr.ContactOptions(target_error=parse_target_error(target_error))
    shift = parse_quantities(translate, 3, LENGTH, "--translate")
    angles = parse_quantities(rotate, 3, ANGLE, "--rotate")
    kernel = parse_response(response)
    if kernel is not None:
        _only_for_a_body(bone, "--bone")
        _only_for_a_body(fixed, "--fixed")
    modulus = parse_quantity(shear_modulus, STRESS, "--shear-modulus")
    skin = qr.Skin(shear_modulus=modulus, poisson_ratio=poisson_ratio, response=kernel or qr.HalfSpace())
    units = file_unit(unit, "--unit"), file_unit(product_unit or unit, "--product-unit")
    with progress(f"reading {skin_file} and {product_file}"):
        surface = with_skin_mask(qr.read_surface(skin_file, unit=units[0]), skin_mask)
        obstacle = qr.read_obstacle(product_file, unit=units[1]).moved(rotation(angles), shift)
    body = None if kernel else parse_body(surface, bone or "auto", fixed or "caps", units[0])
    inputs = {
        "skin": str(skin_file),
        "product": str(product_file),
        "unit": units[0],
        "product_unit": units[1],
        "translate": {"value": shift, "unit": "m"},
        "rotate": {"value": angles, "unit": "rad"},
        **motion,
        "shear_modulus": {"value": modulus, "unit": "Pa"},
        "poisson_ratio": {"value": poisson_ratio, "unit": "1"},
        "response": response,
        **({"bone": bone or "auto", "fixed": fixed or "caps"} if body else {}),
        "skin_mask": skin_mask,
        "target_error": {"value": options.target_error, "unit": "1"},
        "quasirigid": qr.__version__,
    }
    return Scene(
        surface=surface,
        obstacle=obstacle,
        skin=skin,
        body=body,
        motion=motion,
        options=options,
        inputs=inputs,
    )


def parse_goal(depth: str | None, force: str | None, overlap: str | None) -> dict[str, float]:
    """Return the one that is given of depth (m), force (N) and overlap (m), under its name."""
    words = {"depth": depth, "force": force, "overlap": overlap}
    given = {name: text for name, text in words.items() if text is not None}
    if len(given) != 1:
        found = " and ".join(f"--{name}" for name in given) or "none of them"
        raise QuantityError(f"give one of --depth, --force and --overlap; given: {found}")
    ((name, text),) = given.items()
    return {name: parse_quantity(text, FORCE if name == "force" else LENGTH, f"--{name}")}


def prepared_skin(scene: Scene, goal: Mapping[str, float]) -> qr.Skin | qr.PreparedSkin | None:
    """Return the skin that is pressed: a body is prepared where a press to `goal` may touch it.

    None where it touches nowhere.
    """
    if scene.body is None:
        return scene.skin
    # Of the press before a body only counts where the product ends.
    first = replace(scene.options, target_error=None)
    asked: dict[str, Any] = {**scene.motion, **goal}
    with progress("pressing"):
        try:
            contact = qr.press(scene.surface, scene.obstacle, scene.skin, options=first, throw=False, **asked)
        except qr.ContactError as error:
            if error.contact is None:
                raise
            contact = error.contact
    # Where the half-space comes near the product, the body may touch it; no other vertex needs its response.
    depth = contact.depth or 0.0
    if "force" in goal:
        # A body may be softer than the half-space: up to twice as deep.
        depth *= 2.0
    nodes = may_touch(scene.surface, contact.obstacle, depth)
    if len(nodes) == 0:
        return None
    body = replace(scene.skin, response=scene.body)
    return body.prepared(scene.surface, free_nodes(nodes, scene.body), progress=True)


def _only_for_a_body(text: str | None, option: str) -> None:
    if text is not None:
        raise QuantityError(f"{option}: '{text}' is of use to --response body alone")
