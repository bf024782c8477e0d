"""The command line: parse, call, print. Lengths in mm, forces in N, pressures in kPa here."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
import typer
from rich.table import Table

import quasirigid as qr

from .._extras import import_extra
from .._units import MM, UNITS
from ..errors import QuasirigidError
from ..io import compare_contacts, patch_table, refinement_table, save_contact
from .arguments import (
    choice,
    file_unit,
    parse_body,
    parse_response,
    parse_target_error,
    rotation,
    with_skin_mask,
)
from .console import console, progress, refuse, show_warning
from .demo import press_demo
from .nodes import free_nodes, may_touch
from .quantities import ANGLE, LENGTH, STRESS, QuantityError, parse_numbers, parse_quantities, parse_quantity

__all__ = ["run"]

Made = TypeVar("Made")

_TARGET_ERROR = "none" if (_target := qr.ContactOptions().target_error) is None else f"{_target:g}"
_TARGET_HELP = (
    "Error of force and area that the mesh may leave, as 0.02: the mesh is refined around the contact until"
    " the estimates are below; none takes it as it is."
)
_UNITS = f"{', '.join(list(UNITS)[:-1])} or {list(UNITS)[-1]}"

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Press a hand mesh against a product and read off deformed skin, pressure, area and force.",
    epilog="Example:\n\n\b\n  quasirigid demo --quick --out demo-output",
)


def run(arguments: Sequence[str]) -> int:
    """Carry out a command line.

    Parameters
    ----------
    arguments : sequence of str
        Without the program's name.

    Returns
    -------
    int
        0: done; 1: done, but the contact did not end solved; 2: bad input, one line on stderr says what.
    """
    warnings.showwarning = show_warning
    try:
        status = app(list(arguments) or ["--help"], prog_name="quasirigid", standalone_mode=False)
    except (QuasirigidError, OSError) as error:
        return refuse(str(error))
    except (KeyboardInterrupt, typer.Abort):
        return refuse("interrupted", status=130)
    except Exception as error:
        # Typer's own refusals (a missing option, an unknown command) carry this method; nothing else does.
        message = getattr(error, "format_message", None)
        if message is None:
            raise
        return refuse(message())
    return status if isinstance(status, int) else 0


@app.command(
    short_help="Press the built-in fingertip with its bone on two products.",
    epilog="Example:\n\n\b\n  quasirigid demo --quick --out demo-output",
)
def demo(
    out: Annotated[Path, typer.Option(help="Folder for meshes, results and pictures.")] = Path("demo-output"),
    quick: Annotated[bool, typer.Option("--quick", help="A coarse mesh: done in a moment.")] = False,
    target_error: Annotated[str, typer.Option(help=_TARGET_HELP)] = _TARGET_ERROR,
) -> int:
    """Press the built-in fingertip on a handle and on a phone-sized box, 1.12 mm deep.

    Each press twice: as a half-space, which knows neither the finger's shape nor its bone, and as the body
    with its bone, whose compliance is computed first and serves both products. Needs no file. Prints the
    figures side by side and writes, in a folder for each product, what `press` writes for the body, and
    footprints of both.
    """
    options = qr.ContactOptions(target_error=parse_target_error(target_error))
    _need_matplotlib()
    press_demo(out, edge_length=1.6e-3 if quick else 1.0e-3, options=options)
    return 0


_PRESS_EXAMPLE = (
    "quasirigid press demo-output/fingertip.ply demo-output/handle.stl --unit m --product-unit mm"
    " --translate 0,19.2,-40mm --rotate 0,90,0deg --direction 0,0,1 --depth 1.12mm --shear-modulus 60kPa"
    " --poisson-ratio 0.5 --response body --bone auto --fixed caps --skin-mask caps --out press-output"
)


@app.command(
    short_help="Press a product against a skin mesh.",
    epilog=f"Example (on the meshes that `quasirigid demo` writes):\n\n\b\n  {_PRESS_EXAMPLE}",
)
def press(
    skin_file: Annotated[
        Path, typer.Argument(metavar="SKIN", help="Hand or finger mesh: .ply, .stl or .obj.")
    ],
    product_file: Annotated[Path, typer.Argument(metavar="PRODUCT", help="Closed product mesh.")],
    unit: Annotated[str, typer.Option(help=f"Unit of the skin file: {_UNITS}.")],
    direction: Annotated[str, typer.Option(help="The way the product comes, as in 0,0,1.")],
    depth: Annotated[str, typer.Option(help="How far past first touch, as in 1.12mm.")],
    shear_modulus: Annotated[str, typer.Option(help="Of the skin, as in 60kPa.")],
    poisson_ratio: Annotated[float, typer.Option(help="Of the skin, 0 to 0.5.")],
    out: Annotated[Path, typer.Option(help="Folder for the results.")],
    product_unit: Annotated[
        str | None, typer.Option(help="Unit of the product file [default: as --unit].")
    ] = None,
    translate: Annotated[
        str, typer.Option(help="Shift of the product, after turning it, as in 0,0,-20mm.")
    ] = "0,0,0mm",
    rotate: Annotated[
        str,
        typer.Option(help="Turns of the product about the fixed axes x, then y, then z, as in 0,0,90deg."),
    ] = "0,0,0deg",
    response: Annotated[
        str,
        typer.Option(
            help="half-space; body (see --bone and --fixed); layer:thickness=5mm (on bone); or"
            " gaussian:height=0.8mm/N,width=5mm,cutoff=15mm (the paper's). The kernels take pressure=linear"
            " or pressure=one_ring, half-space and layer discretization=collocation or"
            " discretization=galerkin too, as in half-space:discretization=galerkin."
        ),
    ] = "half-space",
    bone: Annotated[
        str | None,
        typer.Option(
            help="Of a body: auto draws plausible phalanges into a finger with its pad to -z; FILE"
            " holds closed bones, in the skin's unit; none. [default: auto]"
        ),
    ] = None,
    fixed: Annotated[
        str | None,
        typer.Option(
            help="Of a body, what does not move: caps, the flat cut faces; none; FILE.npy holds a bool for"
            " each vertex. [default: caps]"
        ),
    ] = None,
    skin_mask: Annotated[
        str,
        typer.Option(
            help="What may touch: caps leaves out flat cut faces, none leaves out nothing, FILE.npy holds a"
            " bool for each vertex."
        ),
    ] = "caps",
    start: Annotated[
        str, typer.Option(help="infinity: first touch counts from far away; current: from here.")
    ] = "infinity",
    target_error: Annotated[str, typer.Option(help=_TARGET_HELP)] = _TARGET_ERROR,
    pictures: Annotated[bool, typer.Option(help="Draw skin.png and footprint.png.")] = True,
) -> int:
    """Press a product against a skin mesh by a depth and write what happens.

    Writes deformed.ply, deformed.vtp, product.ply, contact.npz, contact.json, skin.png and footprint.png.
    Leaves with 0 when solved or without contact, 1 when the solver ended otherwise, 2 on bad input.
    """
    # Everything is read and checked before anything is computed.
    motion: dict[str, Any] = {
        "direction": parse_numbers(direction, 3, "--direction"),
        "depth": parse_quantity(depth, LENGTH, "--depth"),
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
    if pictures:
        _need_matplotlib()
    if out.exists() and not out.is_dir():
        raise NotADirectoryError(f"--out: {out} is a file, expected a folder")
    units = file_unit(unit, "--unit"), file_unit(product_unit or unit, "--product-unit")
    with progress(f"reading {skin_file} and {product_file}"):
        surface = with_skin_mask(qr.read_surface(skin_file, unit=units[0]), skin_mask)
        obstacle = qr.read_obstacle(product_file, unit=units[1]).moved(rotation(angles), shift)
    body = None if kernel else parse_body(surface, bone or "auto", fixed or "caps", units[0])
    contact = _press(surface, obstacle, skin, body, motion, options)
    inputs = {
        "skin": str(skin_file),
        "product": str(product_file),
        "unit": units[0],
        "product_unit": units[1],
        "translate": {"value": shift, "unit": "m"},
        "rotate": {"value": angles, "unit": "rad"},
        **motion,
        "depth": {"value": motion["depth"], "unit": "m"},
        "shear_modulus": {"value": modulus, "unit": "Pa"},
        "poisson_ratio": {"value": poisson_ratio, "unit": "1"},
        "response": response,
        **({"bone": bone or "auto", "fixed": fixed or "caps"} if body else {}),
        "skin_mask": skin_mask,
        "target_error": {"value": options.target_error, "unit": "1"},
        "quasirigid": qr.__version__,
    }
    with progress(f"writing {out}"):
        bones = body.bone if body else None
        files = save_contact(contact, out, inputs=inputs, pictures=pictures, bone=bones)
    typer.echo(compare_contacts({skin_file.stem: contact}))
    if contact.patches:
        typer.echo(patch_table(contact))
    if len(contact.refinements) > 1:
        typer.echo(refinement_table(contact))
    typer.echo("wrote " + ", ".join(map(str, files)))
    if contact.status in ("solved", "no_contact"):
        return 0
    return refuse(f"the contact ended with '{contact.status}': {contact.advice}", status=1)


def _press(
    surface: qr.Surface,
    obstacle: qr.Obstacle,
    skin: qr.Skin,
    body: qr.Body | None,
    motion: dict[str, Any],
    options: qr.ContactOptions,
) -> qr.Contact:
    """Return the contact with `skin`, or with `body`, where there is one, prepared where `skin` touches."""
    # Of the press before a body only counts where the product ends.
    first = options if body is None else replace(options, target_error=None)
    with progress("pressing"):
        contact = qr.press(surface, obstacle, skin, options=first, throw=False, **motion)
    if body is None:
        return contact
    # Where the half-space comes near the product, the body may touch it; no other vertex needs its response.
    nodes = may_touch(surface, contact.obstacle, motion["depth"])
    if len(nodes) == 0:
        return contact
    prepared = replace(skin, response=body).prepared(surface, free_nodes(nodes, body), progress=True)
    with progress("pressing"):
        return qr.press(surface, obstacle, prepared, options=options, throw=False, **motion)


_INFO_EXAMPLE = "quasirigid info demo-output/fingertip.ply --unit m"


@app.command(
    short_help="Show what a mesh file can serve as.",
    epilog=f"Example (on a mesh that `quasirigid demo` writes):\n\n\b\n  {_INFO_EXAMPLE}",
)
def info(
    file: Annotated[Path, typer.Argument(metavar="MESH", help="Mesh file: .ply, .stl or .obj.")],
    unit: Annotated[str, typer.Option(help=f"Unit of the file: {_UNITS}.")],
) -> int:
    """Show what a mesh file holds, and whether it can serve as skin and as product.

    Leaves with 2 when it can serve as neither.
    """
    with progress(f"reading {file}"):
        vertices, faces = qr.read_mesh(file, unit=file_unit(unit, "--unit"))
        surface, no_skin = _tried(lambda: qr.Surface(vertices, faces))
        _, no_product = _tried(lambda: qr.Obstacle.mesh(vertices, faces))
    size = np.ptp(vertices, axis=0) * MM
    rows = [
        ("vertices, faces", f"{len(vertices)}, {len(faces)}"),
        ("size (mm)", " x ".join(f"{length:.4g}" for length in size)),
    ]
    if surface is not None:
        caps = int(np.count_nonzero(~qr.skin_without_caps(surface)))
        rows += [
            ("closed", "yes" if surface.is_closed else "no"),
            ("area (mm²)", f"{surface.area * MM**2:.5g}"),
            ("volume (mm³)", f"{surface.volume * MM**3:.5g}" if surface.is_closed else "-"),
            ("mean edge (mm)", f"{surface.mean_edge_length * MM:.4g}"),
            ("vertices on flat cuts", str(caps)),
        ]
    for use, why_not in (("as skin", no_skin), ("as product", no_product)):
        rows.append((use, f"no: {why_not}" if why_not else "yes"))
    table = Table(title=str(file), title_justify="left", show_header=False, box=None, pad_edge=False)
    for name, value in rows:
        table.add_row(name, value)
    console().print(table)
    if no_skin and no_product:
        return refuse(f"{file}: neither skin nor product: {no_skin}")
    return 0


def _only_for_a_body(text: str | None, option: str) -> None:
    if text is not None:
        raise QuantityError(f"{option}: '{text}' is of use to --response body alone")


def _tried(make: Callable[[], Made]) -> tuple[Made | None, str]:
    """Return what is made, or why not."""
    try:
        return make(), ""
    except QuasirigidError as error:
        return None, str(error)


def _need_matplotlib() -> None:
    import_extra("matplotlib", "pictures", "'quasirigid[plot]'")
