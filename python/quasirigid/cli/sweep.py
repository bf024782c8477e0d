"""`quasirigid sweep`: presses to several depths or forces."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

import typer

import quasirigid as qr

from ..io import as_plain, sweep_record, sweep_table
from ..io.record import figure
from ..io.sweeps import SWEEP_FILES
from .console import Talk, refuse
from .quantities import FORCE, LENGTH, QuantityError, parse_steps
from .scene import SceneWords, naming_scene, prepared_skin, read_scene

__all__ = ["EXAMPLE", "sweep"]

EXAMPLE = (
    "quasirigid sweep demo-output/fingertip.ply demo-output/handle.stl --unit m --product-unit mm"
    " --translate 0,19.2,-40mm --rotate 0,90,0deg --direction 0,0,1 --depths 0.2:1.4:4mm"
    " --shear-modulus 60kPa --poisson-ratio 0.5 --out sweep-output"
)


def sweep(
    scene: SceneWords,
    talk: Talk,
    depths: Annotated[
        str | None,
        typer.Option(
            help="How far past first touch: first:last:count with the unit after it, ends included, as in"
            " 0.1:4:40mm, or a list, as in 0.5,1,2mm."
        ),
    ] = None,
    forces: Annotated[str | None, typer.Option(help="Forces along the direction, likewise.")] = None,
) -> int:
    """Press a product against a skin mesh to several depths or forces, and print a table.

    Writes sweep.csv and sweep.json.
    Exit status 0: every press is solved or without contact; 1: one is not; 2: bad input.
    """
    if (depths is None) == (forces is None):
        raise QuantityError(
            f"give one of --depths and --forces; given: {'none of them' if depths is None else 'both'}"
        )
    if depths is not None:
        goal, values = "depth", parse_steps(depths, LENGTH, "--depths")
        if min(values) < 0.0:
            raise QuantityError(f"--depths: '{depths}' holds a depth below 0")
    else:
        goal, values = "force", parse_steps(forces or "", FORCE, "--forces")
        if min(values) <= 0.0:
            raise QuantityError(f"--forces: '{forces}' holds a force that is not above 0")
    read = read_scene(scene, SWEEP_FILES)
    steps: dict[str, Any] = {f"{goal}s": values}
    with naming_scene(scene):
        skin = prepared_skin(read, {goal: max(values)}, talk)
        curve = qr.sweep(
            read.surface,
            read.obstacle,
            skin,
            options=read.options,
            progress=talk.progress,
            **read.motion,
            **steps,
        )
    inputs = dict(read.inputs) | {f"{goal}s": figure(values, "m" if goal == "depth" else "N")}
    record = sweep_record(curve) | {"inputs": as_plain(inputs)}
    talk.save_and_tell(sweep_table(curve), record, scene.out, partial(curve.save, inputs=inputs))
    bad = [step for step, status in enumerate(curve.status) if status not in ("solved", "no_contact")]
    if not bad:
        return 0
    first = bad[0]
    status, message = curve.status[first], curve.messages[first]
    return refuse(
        f"{len(bad)} of {len(curve)} presses did not end solved; "
        f"the first is step {first}, with {status!r}: {message}",
        status=1,
    )
