"""`quasirigid info` and `quasirigid repair`: what mesh files hold, and mending them."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
import typer

import quasirigid as qr

from .. import _core
from .._text import aligned
from .._units import MM
from ..errors import QuasirigidError
from ..io import write_mesh
from .arguments import file_unit
from .console import Talk, progress, refuse, say
from .folder import check_file, check_inputs
from .quantities import LENGTH, parse_not_negative
from .scene import UNIT_NAMES

__all__ = ["INFO_EXAMPLE", "REPAIR_EXAMPLE", "info", "record_table", "repair"]

INFO_EXAMPLE = "quasirigid info demo-output/fingertip.ply --unit m"
REPAIR_EXAMPLE = "quasirigid repair demo-output/fingertip.ply --unit m --out repaired.ply"

_EXTENTS = (1e-3, 3.0)  # m: products, and all skins

Made = TypeVar("Made")
MeshFile = Annotated[Path, typer.Argument(metavar="MESH", help="Mesh file: .ply, .stl or .obj.")]
Unit = Annotated[str, typer.Option(help=f"Unit of the file: {UNIT_NAMES}.")]


def info(
    file: MeshFile,
    unit: Unit,
    talk: Talk,
    check_crossings: Annotated[
        bool, typer.Option("--check-crossings", help="Look for faces that cross, of open meshes too.")
    ] = False,
) -> int:
    """Show what a mesh file holds, and whether it can serve as skin and as product.

    Exit status 0: it can serve as one of them; 2: as neither, or bad input.
    """
    check_inputs({"MESH": file})
    with progress(f"reading {file}"):
        vertices, faces = qr.read_mesh(file, unit=file_unit(unit, "--unit"))
        record = _record(vertices, faces, check_crossings=check_crossings)
    extent = float(np.ptp(vertices, axis=0).max())
    if not _EXTENTS[0] <= extent <= _EXTENTS[1]:
        warnings.warn(
            f"{file}: the mesh is {extent:.4g} m long, outside the {_EXTENTS[0]:g} to {_EXTENTS[1]:g} m of"
            f" products: is it in another unit than {unit}?",
            qr.SizeWarning,
            stacklevel=1,
        )
    talk.tell(record_table(str(file), record), record)
    if record["as skin"] != "yes" and record["as product"] != "yes":
        return refuse(f"{file}: neither skin nor product: {record['as skin'].removeprefix('no: ')}")
    return 0


def repair(
    file: MeshFile,
    unit: Unit,
    out: Annotated[
        Path,
        typer.Option(help="File to write: .ply or .stl, in the same unit; one of that name is replaced."),
    ],
    talk: Talk,
    weld_tolerance: Annotated[
        str, typer.Option(help="Vertices at most this far apart become one, as in 1um.")
    ] = "0mm",
) -> int:
    """Weld, drop what is unused, degenerate or double, turn faces the same way, and count the changes.

    Exit status 0: mended; 2: the mesh cannot be mended, or bad input.
    """
    inputs = {"MESH": file}
    check_inputs(inputs)
    check_file(out, "--out", inputs)
    known = file_unit(unit, "--unit")
    tolerance = parse_not_negative(weld_tolerance, LENGTH, "--weld-tolerance")
    with progress(f"repairing {file}"):
        mended = qr.repair(*qr.read_mesh(file, unit=known), weld_tolerance=tolerance)
        write_mesh(mended.vertices, mended.faces, out, unit=known)
        record = _record(mended.vertices, mended.faces, check_crossings=False)
    changes = {name: count for name, count in mended.report.items() if count}
    shown = {"changes": ", ".join(f"{name} {count}" for name, count in changes.items()) or "none", **record}
    talk.tell(record_table(str(out), shown), {"changes": dict(mended.report), **record})
    if not talk.json:
        say(f"wrote {out}")
    return 0


def _record(vertices: Any, faces: Any, *, check_crossings: bool) -> dict[str, Any]:
    """Return what a mesh holds, lengths in mm."""
    surface, no_skin = _tried(lambda: qr.Surface(vertices, faces))
    _, no_product = _tried(lambda: qr.Obstacle.mesh(vertices, faces))
    record: dict[str, Any] = {
        "vertices": len(vertices),
        "faces": len(faces),
        "size (mm)": [float(f"{length:.4g}") for length in np.ptp(vertices, axis=0) * MM],
    }
    if surface is not None:
        record |= {
            "closed": "yes" if surface.is_closed else "no",
            "area (mm²)": float(f"{surface.area * MM**2:.5g}"),
            "volume (mm³)": float(f"{surface.volume * MM**3:.5g}") if surface.is_closed else None,
            "mean edge (mm)": float(f"{surface.mean_edge_length * MM:.4g}"),
            "vertices on flat cuts": int(np.count_nonzero(~qr.skin_without_caps(surface))),
        }
        if check_crossings:
            record["crossing faces"] = _core.find_crossings(vertices, faces).tolist()
    for use, why_not in (("as skin", no_skin), ("as product", no_product)):
        record[use] = f"no: {why_not}" if why_not else "yes"
    return record


def record_table(title: str, record: dict[str, Any]) -> str:
    """Return a record as a table of two columns."""
    shown = {name: _shown(name, value) for name, value in record.items()}
    return "\n".join([title, *aligned([list(shown), list(shown.values())], left=True)])


def _shown(name: str, value: Any) -> str:
    if name == "size (mm)":
        return " x ".join(f"{length:.4g}" for length in value)
    if name == "crossing faces":
        first = f", the first {value[0][0]} and {value[0][1]}" if value else ""
        return f"{len(value)} pairs{first}"
    return "-" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


def _tried(make: Callable[[], Made]) -> tuple[Made | None, str]:
    """Return what is made, or why not."""
    try:
        return make(), ""
    except QuasirigidError as error:
        return None, str(error)
