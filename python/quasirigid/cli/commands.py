"""The command line: parse, call, print. Lengths in mm, forces in N, pressures in kPa here."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

import quasirigid as qr

from .._extras import need_matplotlib
from ..errors import QuasirigidError
from ..io import as_plain, compare_contacts, contact_record, patch_table, refinement_table, save_contact
from ..io.record import figure
from ..io.write import CONTACT_FILES
from .arguments import parse_target_error
from .completion import COMPLETION_EXAMPLE, completion
from .console import (
    ContactTalk,
    close_stdout,
    print_all_letters,
    progress,
    refuse,
    say,
    show_warning,
    speak_for,
)
from .demo import grasp_demo, press_demo
from .evaluation import ACCURACY_EXAMPLE, STRESS_EXAMPLE, accuracy, stress
from .folder import check_folder
from .gather import gathered
from .grasp import GRASP_EXAMPLE, grasp
from .hand import HAND_EXAMPLE, hand
from .meshes import INFO_EXAMPLE, REPAIR_EXAMPLE, info, repair
from .quantities import LENGTH, QuantityError, parse_goal, parse_numbers, parse_quantities
from .scene import (
    GOAL_UNITS,
    TARGET_ERROR,
    SceneWords,
    TargetError,
    naming_scene,
    prepared_skin,
    read_scene,
)
from .sweep import EXAMPLE as SWEEP_EXAMPLE
from .sweep import sweep

__all__ = ["run"]

DEMO_EXAMPLE = "quasirigid demo --quick --out demo-output"
PRESS_EXAMPLE = (
    "quasirigid press demo-output/fingertip.ply demo-output/handle.stl --unit m --product-unit mm"
    " --translate 0,19.2,-40mm --rotate 0,90,0deg --direction 0,0,1 --depth 1.12mm --shear-modulus 60kPa"
    " --poisson-ratio 0.5 --response body --bone auto --fixed caps --skin-mask caps --out press-output"
)

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Press a hand mesh against a product and read off deformed skin, pressure, area and force.",
    epilog=f"Example:\n\n\b\n  {DEMO_EXAMPLE}",
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
        0: done; 1: done, but the contact did not end solved; 2: bad input, one line on stderr says what; 130:
        interrupted.
    """
    print_all_letters()
    warnings.showwarning = show_warning
    try:
        status = app(list(arguments) or ["--help"], prog_name="quasirigid", standalone_mode=False)
    except OSError as error:
        # In our own words, or the system's.
        place = f"{error.filename} cannot be read or written: " if error.filename else ""
        return refuse(place + (error.strerror or str(error)))
    except QuasirigidError as error:
        return refuse(str(error))
    except (KeyboardInterrupt, typer.Abort):
        return refuse("interrupted", status=130)
    except SystemExit as left:
        # Whoever reads the help has read enough.
        if not isinstance(left.__context__, BrokenPipeError):
            raise
        close_stdout()
        return 0
    except Exception as error:
        # Typer's own refusals (a missing option, an unknown command) carry this method; nothing else does.
        message = getattr(error, "format_message", None)
        if message is None:
            raise
        return refuse(message())
    if status == 130:
        return refuse("interrupted", status=130)
    return status if isinstance(status, int) else 0


def _print_version(is_asked: bool) -> None:
    if is_asked:
        say(f"quasirigid {qr.__version__}")
        raise typer.Exit


@app.callback()
def _program(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_print_version, help="Show the version.")
    ] = False,
) -> None:
    speak_for(context)


def demo(
    talk: ContactTalk,
    out: Annotated[
        Path,
        typer.Option(help="Folder for meshes, results and pictures; files of the same names are replaced."),
    ] = Path("demo-output"),
    quick: Annotated[bool, typer.Option("--quick", help="Coarse meshes: done in a moment.")] = False,
    target_error: TargetError = TARGET_ERROR,
) -> int:
    """Press the built-in fingertip on two products, and close the built-in hand on a bottle.

    The fingertip goes 1.12 mm deep on a handle and on a phone-sized box, each twice: as a half-space, which
    knows neither the finger's shape nor its bone, and as the body with its bone, whose compliance is computed
    first and serves both. The hand holds the bottle with 20 N, to the target of `grasp`.
    Needs no file. Prints the figures and writes, in a folder for each product, what `press` writes and
    footprints of both responses, or what `grasp` writes, with one picture.
    Exit status 0: done; 2: bad input.
    """
    check_folder(out)
    options = qr.ContactOptions(target_error=parse_target_error(target_error))
    need_matplotlib()
    record = press_demo(out, edge_length=1.6e-3 if quick else 1.0e-3, options=options, talk=talk)
    record |= grasp_demo(out, talk)
    if talk.json:
        talk.tell("", record)
    return 0


def press(
    scene: SceneWords,
    talk: ContactTalk,
    depth: Annotated[str | None, typer.Option(help="How far past first touch, as in 1.12mm.")] = None,
    force: Annotated[str | None, typer.Option(help="Force along the direction, as in 5N.")] = None,
    overlap: Annotated[
        str | None, typer.Option(help="Deepest overlap with the undeformed skin, as in 1.12mm.")
    ] = None,
    tilt_point: Annotated[
        str | None,
        typer.Option(
            help="Let the product turn about this point of it, before it travels, until the skin leaves no"
            " moment about it, as in 0,19.2,-40mm. [default: it keeps its attitude]"
        ),
    ] = None,
    tilt_axes: Annotated[
        str | None,
        typer.Option(
            help="Of --tilt-point, the axes that it turns about: one, as in 0,1,0, or two, as in"
            " 1,0,0,0,1,0. [default: all across the direction]"
        ),
    ] = None,
    pictures: Annotated[bool, typer.Option(help="Draw skin.png and footprint.png.")] = True,
) -> int:
    """Press a product against a skin mesh to a depth, a force or an overlap, and write what happens.

    Takes one of --depth, --force and --overlap.
    Writes deformed.ply, deformed.vtp, product.ply, contact.npz, contact.json, skin.png and footprint.png, and
    deformed_product.ply of a product that gives way; where the force or overlap is out of reach, of the
    contact that comes nearest.
    Exit status 0: solved or without contact; 1: out of reach, or the solver ended otherwise; 2: bad input.
    """
    # Everything is read and checked before anything is computed.
    goal = parse_goal(depth, force, overlap)
    tilt = _tilt(tilt_point, tilt_axes)
    if pictures and scene.out is not None:
        need_matplotlib()
    read = read_scene(scene, CONTACT_FILES)
    with naming_scene(scene):
        skin = prepared_skin(read, goal | tilt, talk)
    asked: dict[str, Any] = {**read.motion, **goal, **tilt}
    unreached = None
    with progress("pressing"), naming_scene(scene):
        try:
            contact = qr.press(read.surface, read.obstacle, skin, options=read.options, throw=False, **asked)
        except qr.ContactError as error:
            if error.contact is None:
                raise
            contact, unreached = error.contact, str(error)
    inputs = dict(read.inputs) | {name: figure(value, GOAL_UNITS[name]) for name, value in goal.items()}
    inputs |= {"tilt_point": figure(tilt.get("tilt_point"), "m"), "tilt_axes": tilt.get("tilt_axes")}
    text = _press_text(scene.skin_file.stem, contact, verbose=talk.verbose, is_reached=unreached is None)
    record = contact_record(contact, unreached=unreached) | {"inputs": as_plain(inputs)}
    bone = read.body.bone if read.body else None
    saved: dict[str, Any] = {"inputs": inputs, "pictures": pictures, "bone": bone, "unreached": unreached}
    talk.save_and_tell(text, record, scene.out, partial(save_contact, contact, **saved))
    if unreached is not None:
        return refuse(unreached, status=1)
    if contact.status in ("solved", "no_contact"):
        return 0
    return refuse(f"the contact did not end solved: {contact.advice}", status=1)


def _tilt(point: str | None, axes: str | None) -> dict[str, Any]:
    """Return how the product turns, as arguments of `press`."""
    if point is None and axes is not None:
        raise QuantityError(f"--tilt-axes: '{axes}' needs --tilt-point, which the product turns about")
    tilt: dict[str, Any] = {}
    if point is not None:
        tilt = {"balance": "tilt", "tilt_point": parse_quantities(point, 3, LENGTH, "--tilt-point")}
    if axes is not None:
        numbers = parse_numbers(axes, 3 if axes.count(",") < 3 else 6, "--tilt-axes")
        tilt["tilt_axes"] = [numbers[at : at + 3] for at in range(0, len(numbers), 3)]
    return tilt


def _press_text(name: str, contact: qr.Contact, *, verbose: bool, is_reached: bool) -> str:
    parts = [compare_contacts({name: contact}, verbose=verbose, warnings=False, is_reached=is_reached)]
    if contact.patches:
        parts.append(patch_table(contact))
    if sum(one.kind == "mesh" for one in contact.refinements) > 1:
        parts.append(refinement_table(contact))
    return "\n".join(parts)


_ON_DEMO = "on the meshes that `quasirigid demo` writes"
_COMMANDS = (
    (
        demo,
        "Press the built-in fingertip and close the built-in hand on products.",
        "",
        DEMO_EXAMPLE,
    ),
    (press, "Press a product against a skin mesh.", _ON_DEMO, PRESS_EXAMPLE),
    (sweep, "Press a product against a skin mesh to several depths or forces.", _ON_DEMO, SWEEP_EXAMPLE),
    (info, "Show what a mesh file can serve as.", _ON_DEMO, INFO_EXAMPLE),
    (repair, "Mend a mesh file and count the changes.", _ON_DEMO, REPAIR_EXAMPLE),
    (hand, "Show a hand's joints, regions and size; write it in a pose.", "", HAND_EXAMPLE),
    (grasp, "Close a hand on a product until its digits hold it.", _ON_DEMO, GRASP_EXAMPLE),
    (accuracy, "Measure error against run time on problems with known answers.", "", ACCURACY_EXAMPLE),
    (stress, "Try extreme cases, and say which are off.", "", STRESS_EXAMPLE),
)
for _command, _help, _where, _example in _COMMANDS:
    _words = f"Example ({_where})" if _where else "Example"
    app.command(short_help=_help, epilog=f"{_words}:\n\n\b\n  {_example}")(gathered(_command))
app.command(
    short_help="Print a script for a shell's completion.",
    epilog=f"Example:\n\n\b\n  {COMPLETION_EXAMPLE}",
)(completion)
