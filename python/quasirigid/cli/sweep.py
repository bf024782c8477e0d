"""`quasirigid sweep`: presses to several depths or forces."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Annotated, Any

import typer

import quasirigid as qr

from ..io import as_plain, sweep_columns, sweep_table
from ..io.atomic import atomic_write
from .console import Talk, refuse
from .quantities import FORCE, LENGTH, QuantityError, parse_steps
from .scene import SceneWords, naming_scene, prepared_skin, read_scene

__all__ = ["EXAMPLE", "sweep"]

EXAMPLE = (
    "quasirigid sweep demo-output/fingertip.ply demo-output/handle.stl --unit m --product-unit mm"
    " --translate 0,19.2,-40mm --rotate 0,90,0deg --direction 0,0,1 --depths 0.2:1.4:4mm"
    " --shear-modulus 60kPa --poisson-ratio 0.5 --out sweep-output"
)


_FILES = ("sweep.csv", "sweep.json")


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
    read = read_scene(scene, _FILES)
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
    inputs = dict(read.inputs) | {f"{goal}s": {"value": values, "unit": "m" if goal == "depth" else "N"}}
    record = {"columns": as_plain(sweep_columns(curve)), "inputs": as_plain(inputs)}
    files = () if scene.out is None else _save(record, scene.out)
    text = sweep_table(curve)
    talk.tell(text + "\nwrote " + ", ".join(map(str, files)) if files else text, record)
    bad = [step for step, status in enumerate(curve.status) if status not in ("solved", "no_contact")]
    if not bad:
        return 0
    status, message = curve.status[bad[0]], curve.messages[bad[0]]
    return refuse(f"{len(bad)} of {len(curve)} presses ended with {status!r}: {message}", status=1)


def _save(record: dict[str, Any], folder: Path) -> tuple[Path, ...]:
    """Write the table as CSV, and with its inputs as JSON; both in SI."""
    columns = record["columns"]
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(columns)
    table.writerows(zip(*columns.values(), strict=True))
    document = json.dumps(record, indent=2, allow_nan=False) + "\n"
    folder.mkdir(parents=True, exist_ok=True)
    files = tuple(folder / name for name in _FILES)
    for path, content in zip(files, (text.getvalue(), document), strict=True):
        with atomic_write(path) as file:
            file.write(content.encode())
    return files
