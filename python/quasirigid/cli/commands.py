"""The command line: parse, call, print. Lengths in mm, forces in N, pressures in kPa here."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
import typer
from rich.table import Table

import quasirigid as qr

from .._extras import import_extra
from .._units import MM
from ..errors import QuasirigidError
from ..io import compare_contacts, patch_table, refinement_table, save_contact
from .arguments import file_unit, parse_target_error
from .console import console, progress, refuse, show_warning
from .demo import press_demo
from .evaluation import ACCURACY_EXAMPLE, STRESS_EXAMPLE, accuracy, stress
from .scene import (
    GOAL_UNITS,
    TARGET_ERROR,
    UNIT_NAMES,
    Bone,
    Direction,
    Fixed,
    PoissonRatio,
    ProductFile,
    ProductUnit,
    ResponseName,
    Rotate,
    ShearModulus,
    SkinFile,
    SkinMask,
    StartName,
    TargetError,
    Translate,
    Unit,
    parse_goal,
    prepared_skin,
    read_scene,
)
from .sweep import EXAMPLE as SWEEP_EXAMPLE
from .sweep import sweep

__all__ = ["run"]

Made = TypeVar("Made")

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
    target_error: TargetError = TARGET_ERROR,
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
    skin_file: SkinFile,
    product_file: ProductFile,
    unit: Unit,
    direction: Direction,
    shear_modulus: ShearModulus,
    poisson_ratio: PoissonRatio,
    out: Annotated[Path, typer.Option(help="Folder for the results.")],
    depth: Annotated[str | None, typer.Option(help="How far past first touch, as in 1.12mm.")] = None,
    force: Annotated[str | None, typer.Option(help="Force along the direction, as in 5N.")] = None,
    overlap: Annotated[
        str | None, typer.Option(help="Deepest overlap with the undeformed skin, as in 1.12mm.")
    ] = None,
    product_unit: ProductUnit = None,
    translate: Translate = "0,0,0mm",
    rotate: Rotate = "0,0,0deg",
    response: ResponseName = "half-space",
    bone: Bone = None,
    fixed: Fixed = None,
    skin_mask: SkinMask = "caps",
    start: StartName = "infinity",
    target_error: TargetError = TARGET_ERROR,
    pictures: Annotated[bool, typer.Option(help="Draw skin.png and footprint.png.")] = True,
) -> int:
    """Press a product against a skin mesh to a depth, a force or an overlap, and write what happens.

    Takes one of --depth, --force and --overlap.
    Writes deformed.ply, deformed.vtp, product.ply, contact.npz, contact.json, skin.png and footprint.png.
    Leaves with 0 when solved or without contact, 1 when the solver ended otherwise, 2 on bad input.
    """
    # Everything is read and checked before anything is computed.
    goal = parse_goal(depth, force, overlap)
    if pictures:
        _need_matplotlib()
    if out.exists() and not out.is_dir():
        raise NotADirectoryError(f"--out: {out} is a file, expected a folder")
    scene = read_scene(
        skin_file,
        product_file,
        unit=unit,
        product_unit=product_unit,
        translate=translate,
        rotate=rotate,
        direction=direction,
        start=start,
        shear_modulus=shear_modulus,
        poisson_ratio=poisson_ratio,
        response=response,
        bone=bone,
        fixed=fixed,
        skin_mask=skin_mask,
        target_error=target_error,
    )
    body, pressed = scene.body, prepared_skin(scene, goal) or scene.skin
    asked: dict[str, Any] = {**scene.motion, **goal}
    with progress("pressing"):
        contact = qr.press(
            scene.surface, scene.obstacle, pressed, options=scene.options, throw=False, **asked
        )
    inputs = dict(scene.inputs) | {
        name: {"value": value, "unit": GOAL_UNITS[name]} for name, value in goal.items()
    }
    with progress(f"writing {out}"):
        bones = body.bone if body else None
        files = save_contact(contact, out, inputs=inputs, pictures=pictures, bone=bones)
    typer.echo(compare_contacts({skin_file.stem: contact}))
    if contact.patches:
        typer.echo(patch_table(contact))
    if sum(one.kind == "mesh" for one in contact.refinements) > 1:
        typer.echo(refinement_table(contact))
    typer.echo("wrote " + ", ".join(map(str, files)))
    if contact.status in ("solved", "no_contact"):
        return 0
    return refuse(f"the contact ended with '{contact.status}': {contact.advice}", status=1)


app.command(
    name="sweep",
    short_help="Press a product against a skin mesh to several depths or forces.",
    epilog=f"Example (on the meshes that `quasirigid demo` writes):\n\n\b\n  {SWEEP_EXAMPLE}",
)(sweep)


_INFO_EXAMPLE = "quasirigid info demo-output/fingertip.ply --unit m"


@app.command(
    short_help="Show what a mesh file can serve as.",
    epilog=f"Example (on a mesh that `quasirigid demo` writes):\n\n\b\n  {_INFO_EXAMPLE}",
)
def info(
    file: Annotated[Path, typer.Argument(metavar="MESH", help="Mesh file: .ply, .stl or .obj.")],
    unit: Annotated[str, typer.Option(help=f"Unit of the file: {UNIT_NAMES}.")],
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


app.command(
    name="accuracy",
    short_help="Measure error against run time on problems with known answers.",
    epilog=f"Example:\n\n\b\n  {ACCURACY_EXAMPLE}",
)(accuracy)

app.command(
    name="stress",
    short_help="Try extreme cases, and say which are off.",
    epilog=f"Example:\n\n\b\n  {STRESS_EXAMPLE}",
)(stress)


def _tried(make: Callable[[], Made]) -> tuple[Made | None, str]:
    """Return what is made, or why not."""
    try:
        return make(), ""
    except QuasirigidError as error:
        return None, str(error)


def _need_matplotlib() -> None:
    import_extra("matplotlib", "pictures", "'quasirigid[plot]'")
