"""The scene of a press, from the words of the command line."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

import quasirigid as qr

from .._units import UNITS
from ..contact.options import options_to_core
from ..io.record import figure
from .arguments import (
    choice,
    file_unit,
    mask_file,
    on_skin,
    parse_poisson_ratio,
    parse_response,
    parse_target_error,
    rotation,
    with_skin_mask,
)
from .console import Talk, progress
from .folder import OutFolder, check_file, check_folder, check_inputs
from .kept import kept_body
from .nodes import may_touch
from .product import ProductPoissonRatio, ProductShearModulus, parse_material
from .quantities import (
    ANGLE,
    LENGTH,
    STRESS,
    QuantityError,
    parse_numbers,
    parse_positive,
    parse_quantities,
)

if TYPE_CHECKING:
    from .grasp import GraspWords

__all__ = [
    "GOAL_UNITS",
    "TARGET_ERROR",
    "UNIT_NAMES",
    "CoupleFingers",
    "MaxNodes",
    "Scene",
    "SceneWords",
    "TargetError",
    "naming_scene",
    "options_of",
    "prepared_skin",
    "read_scene",
]

UNIT_NAMES = f"{', '.join(list(UNITS)[:-1])} or {list(UNITS)[-1]}"
_OPTIONS = qr.ContactOptions()
TARGET_ERROR = f"{_OPTIONS.target_error:g}"
GOAL_UNITS = {"depth": "m", "force": "N", "overlap": "m"}

SkinFile = Annotated[Path, typer.Argument(metavar="SKIN", help="Hand or finger mesh: .ply, .stl or .obj.")]
ProductFile = Annotated[Path, typer.Argument(metavar="PRODUCT", help="Closed product mesh.")]
Unit = Annotated[str, typer.Option(help=f"Unit of the skin file: {UNIT_NAMES}.")]
Direction = Annotated[str, typer.Option(help="Direction in which the product travels, as in 0,0,1.")]
ShearModulus = Annotated[str, typer.Option(help="Of the skin, as in 60kPa.")]
PoissonRatio = Annotated[str, typer.Option(help="Of the skin, 0 to 0.5.")]
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
        " or pressure=one_ring, all but the gaussian discretization=collocation or"
        " discretization=galerkin too, as in half-space:discretization=galerkin, and the body"
        " coarse_edge_length=2mm, the edges of the mesh that it is solved on."
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
PreparedFile = Annotated[
    Path | None,
    typer.Option(
        help="Of a body, the file that keeps its response: read where it is there and holds enough, else"
        " computed and written.",
        metavar="FILE.npz",
    ),
]
SkinMask = Annotated[
    str,
    typer.Option(
        help="What may touch: caps leaves out flat cut faces; none leaves out nothing, as Python does where"
        " no mask is given; FILE.npy holds a bool for each vertex."
    ),
]
StartName = Annotated[
    str,
    typer.Option(help="infinity: first touch counts from far away; current: from where the product stands."),
]
TargetError = Annotated[
    str,
    typer.Option(
        help="Error of force and area that the mesh may leave, as 0.02: the mesh is refined around the"
        " contact until the estimates are below; none takes it as it is."
    ),
]
MaxNodes = Annotated[int, typer.Option(help="Most contact nodes of a refined mesh.", min=1)]
CoupleFingers = Annotated[
    bool,
    typer.Option(
        "--couple-fingers", help="Let a kernel couple patches on different fingers too, through the air."
    ),
]


@dataclass(frozen=True, kw_only=True)
class SceneWords:
    """What is pressed on what, and how, as it is asked for."""

    skin_file: SkinFile
    product_file: ProductFile
    unit: Unit
    direction: Direction
    shear_modulus: ShearModulus
    poisson_ratio: PoissonRatio
    product_unit: ProductUnit = None
    translate: Translate = "0,0,0mm"
    rotate: Rotate = "0,0,0deg"
    product_shear_modulus: ProductShearModulus = None
    product_poisson_ratio: ProductPoissonRatio = None
    response: ResponseName = "half-space"
    bone: Bone = None
    fixed: Fixed = None
    prepared: PreparedFile = None
    skin_mask: SkinMask = "caps"
    start: StartName = "infinity"
    target_error: TargetError = TARGET_ERROR
    max_nodes: MaxNodes = _OPTIONS.max_nodes
    couple_fingers: CoupleFingers = _OPTIONS.couple_fingers
    out: OutFolder = None


@dataclass(frozen=True, kw_only=True)
class Scene:
    """What is pressed on what, and how."""

    surface: qr.Surface
    obstacle: qr.Obstacle
    skin: qr.Skin
    body: qr.Body | None
    prepared: Path | None
    motion: Mapping[str, Any]
    options: qr.ContactOptions
    inputs: Mapping[str, Any]


def read_scene(words: SceneWords, names: Sequence[str]) -> Scene:
    """Return the scene; everything is checked before a file is read.

    Parameters
    ----------
    words : SceneWords
        What is asked for.
    names : sequence of str
        Names of the files that the command may write.
    """
    _check_files(words, names)
    motion: dict[str, Any] = {
        "direction": parse_numbers(words.direction, 3, "--direction"),
        "start": choice(words.start, ("infinity", "current"), "--start"),
    }
    if not any(motion["direction"]):
        raise QuantityError(f"--direction: '{words.direction}' has no direction, expected as 0,0,1")
    options = options_of(words)
    shift = parse_quantities(words.translate, 3, LENGTH, "--translate")
    angles = parse_quantities(words.rotate, 3, ANGLE, "--rotate")
    response = parse_response(words.response)
    if not isinstance(response, qr.Body):
        _only_for_a_body(words.bone, "--bone")
        _only_for_a_body(words.fixed, "--fixed")
        _only_for_a_body(words.prepared, "--prepared")
    modulus = parse_positive(words.shear_modulus, STRESS, "--shear-modulus")
    ratio = parse_poisson_ratio(words.poisson_ratio)
    material = parse_material(words.product_shear_modulus, words.product_poisson_ratio)
    skin = qr.Skin(
        shear_modulus=modulus,
        poisson_ratio=ratio,
        response=qr.HalfSpace() if isinstance(response, qr.Body) else response,
    )
    unit = file_unit(words.unit, "--unit")
    product_unit = file_unit(words.product_unit or words.unit, "--product-unit")
    with progress(f"reading {words.skin_file} and {words.product_file}"):
        surface = with_skin_mask(qr.read_surface(words.skin_file, unit=unit), words.skin_mask)
        product = qr.read_obstacle(words.product_file, unit=product_unit).moved(rotation(angles), shift)
        obstacle = material.given_to(product)
    body, held = None, {}
    if isinstance(response, qr.Body):
        held = {"bone": words.bone or "auto", "fixed": words.fixed or "caps"}
        body = on_skin(response, surface, held["bone"], held["fixed"], unit)
    inputs = {
        "skin": str(words.skin_file),
        "product": str(words.product_file),
        "unit": unit,
        "product_unit": product_unit,
        "translate": figure(shift, "m"),
        "rotate": figure(angles, "rad"),
        **motion,
        **material.inputs,
        "shear_modulus": figure(modulus, "Pa"),
        "poisson_ratio": figure(ratio, "1"),
        "response": words.response,
        **held,
        "skin_mask": words.skin_mask,
        "target_error": figure(options.target_error, "1"),
        "max_nodes": options.max_nodes,
        "couple_fingers": options.couple_fingers,
    }
    return Scene(
        surface=surface,
        obstacle=obstacle,
        skin=skin,
        body=body,
        prepared=words.prepared,
        motion=motion,
        options=options,
        inputs=inputs,
    )


def options_of(words: SceneWords | GraspWords) -> qr.ContactOptions:
    """Return how the contact is to be solved."""
    options = qr.ContactOptions(
        target_error=parse_target_error(words.target_error),
        max_nodes=words.max_nodes,
        couple_fingers=words.couple_fingers,
    )
    options_to_core(options)  # refused before there is a scene to blame
    return options


def prepared_skin(scene: Scene, goal: Mapping[str, Any], talk: Talk) -> qr.Skin | qr.PreparedSkin:
    """Return the skin that is pressed: a body is prepared where a press to `goal` may touch it."""
    if scene.body is None:
        return scene.skin
    # Of the press before a body only counts where the product ends.
    first = replace(scene.options, target_error=None)
    asked: dict[str, Any] = {**scene.motion, **goal}
    with progress("pressing"), warnings.catch_warnings():
        warnings.simplefilter("ignore", qr.QuasirigidWarning)
        try:
            contact = qr.press(scene.surface, scene.obstacle, scene.skin, options=first, throw=False, **asked)
        except qr.ContactError as error:
            if error.contact is None:
                raise
            contact = error.contact
    # Where the half-space comes near the product, the body may touch it; no other vertex needs its response.
    depth = contact.depth or 0.0
    if "force" in goal or "balance" in goal:
        # A body may be softer than the half-space, or tilt the product farther: up to twice as deep.
        depth *= 2.0
    nodes = may_touch(scene.surface, contact.obstacle, depth)
    if len(nodes) == 0:
        # It touches nowhere.
        return scene.skin
    body = replace(scene.skin, response=scene.body)
    if scene.body.fixed is not None:
        nodes = nodes[~np.asarray(scene.body.fixed)[nodes]]
    with _naming_bone(scene):
        if scene.prepared is None:
            return body.prepared(scene.surface, nodes, progress=talk.progress)
        return kept_body(scene.prepared, body, scene.surface, nodes, progress=talk.progress)


@contextmanager
def _naming_bone(scene: Scene) -> Iterator[None]:
    """Name the file of a bone that is refused, and the unit that it is read in."""
    try:
        yield
    except qr.ResponseError as error:
        file, unit = scene.inputs["bone"], scene.inputs["unit"]
        if file in ("auto", "none") or not re.match("(the )?bones? ", str(error)):
            raise
        raise qr.ResponseError(
            f"--bone: {file}: {error} (it is read in {unit}, as the skin: --unit)"
        ) from None


@contextmanager
def naming_scene(words: SceneWords) -> Iterator[None]:
    """Name skin and product where there is no contact to speak of: they may be swapped or far apart."""
    try:
        yield
    except (qr.ContactError, qr.ObstacleError) as error:
        if isinstance(error, qr.ContactError) and error.contact is not None:
            raise
        raise type(error)(
            f"{error} (the skin is {words.skin_file}, the product {words.product_file}: check their order,"
            " --unit, --product-unit, --translate, --rotate and --direction)"
        ) from error


def _check_files(words: SceneWords, names: Sequence[str]) -> None:
    """Refuse missing inputs, and to write where they are or nothing can be."""
    inputs = {
        "SKIN": words.skin_file,
        "PRODUCT": words.product_file,
        "--bone": None if words.bone in (None, "auto", "none") else Path(words.bone),
        "--fixed": mask_file(words.fixed),
        "--skin-mask": mask_file(words.skin_mask),
    }
    check_inputs(inputs)
    check_file(words.prepared, "--prepared", inputs, may_be_read=True)
    check_folder(words.out, names, inputs | {"--prepared": words.prepared})


def _only_for_a_body(text: object, option: str) -> None:
    if text is not None:
        raise QuantityError(f"{option}: '{text}' is of use to --response body alone")
