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
from .console import refuse
from .quantities import FORCE, LENGTH, QuantityError, parse_steps
from .scene import (
    TARGET_ERROR,
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
    prepared_skin,
    read_scene,
)

__all__ = ["EXAMPLE", "sweep"]

EXAMPLE = (
    "quasirigid sweep demo-output/fingertip.ply demo-output/handle.stl --unit m --product-unit mm"
    " --translate 0,19.2,-40mm --rotate 0,90,0deg --direction 0,0,1 --depths 0.2:1.4:4mm"
    " --shear-modulus 60kPa --poisson-ratio 0.5 --out sweep-output"
)


def sweep(
    skin_file: SkinFile,
    product_file: ProductFile,
    unit: Unit,
    direction: Direction,
    shear_modulus: ShearModulus,
    poisson_ratio: PoissonRatio,
    depths: Annotated[
        str | None,
        typer.Option(
            help="How far past first touch: first:last:count with the unit after it, ends included, as in"
            " 0.1:4:40mm, or a list, as in 0.5,1,2mm."
        ),
    ] = None,
    forces: Annotated[str | None, typer.Option(help="Forces along the direction, likewise.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for sweep.csv and sweep.json.")] = None,
    product_unit: ProductUnit = None,
    translate: Translate = "0,0,0mm",
    rotate: Rotate = "0,0,0deg",
    response: ResponseName = "half-space",
    bone: Bone = None,
    fixed: Fixed = None,
    skin_mask: SkinMask = "caps",
    start: StartName = "infinity",
    target_error: TargetError = TARGET_ERROR,
) -> int:
    """Press a product against a skin mesh to several depths or forces, and print a table.

    Leaves with 0 when every press is solved or without contact, 1 when one is not, 2 on bad input.
    """
    if (depths is None) == (forces is None):
        raise QuantityError(
            f"give one of --depths and --forces; given: {'none of them' if depths is None else 'both'}"
        )
    if depths is not None:
        goal, values = "depth", parse_steps(depths, LENGTH, "--depths")
    else:
        goal, values = "force", parse_steps(forces or "", FORCE, "--forces")
    if out is not None and out.exists() and not out.is_dir():
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
    skin = prepared_skin(scene, {goal: max(values)}) or scene.skin
    steps: dict[str, Any] = {f"{goal}s": values}
    curve = qr.sweep(
        scene.surface, scene.obstacle, skin, options=scene.options, progress=True, **scene.motion, **steps
    )
    typer.echo(sweep_table(curve))
    if out is not None:
        inputs = dict(scene.inputs) | {f"{goal}s": {"value": values, "unit": "m" if goal == "depth" else "N"}}
        typer.echo("wrote " + ", ".join(map(str, _save(curve, out, inputs))))
    bad = [status for status in curve.status if status not in ("solved", "no_contact")]
    return refuse(f"{len(bad)} of {len(curve)} presses ended with {bad[0]!r}", status=1) if bad else 0


def _save(curve: qr.Sweep, folder: Path, inputs: dict[str, Any]) -> tuple[Path, ...]:
    """Write the table as CSV, and with its inputs as JSON; both in SI."""
    columns = sweep_columns(curve)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(columns)
    table.writerows(zip(*columns.values(), strict=True))
    record = {"columns": as_plain(columns), "inputs": as_plain(inputs)}
    contents = {
        "sweep.csv": text.getvalue(),
        "sweep.json": json.dumps(record, indent=2, allow_nan=False) + "\n",
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in contents.items():
        with atomic_write(folder / name) as file:
            file.write(content.encode())
    return tuple(folder / name for name in contents)
