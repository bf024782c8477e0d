"""`quasirigid info` and `quasirigid repair`: what mesh files hold, and mending them."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
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
from ..io.record import figure
from .arguments import file_unit
from .console import Talk, progress, refuse, say
from .folder import check_file, check_inputs
from .quantities import LENGTH, parse_not_negative
from .scene import UNIT_NAMES

__all__ = ["INFO_EXAMPLE", "REPAIR_EXAMPLE", "info", "record_table", "repair"]

INFO_EXAMPLE = "quasirigid info demo-output/fingertip.ply --unit m"
REPAIR_EXAMPLE = "quasirigid repair demo-output/fingertip.ply --unit m --out repaired.ply"

_SHOWN_UNITS = {"m": (" (mm)", MM), "m^2": (" (mm²)", MM**2), "m^3": (" (cm³)", 1e6)}
_EXTENTS = (1e-3, 3.0)  # m: products, and all skins

Made = TypeVar("Made")
MeshFile = Annotated[Path, typer.Argument(metavar="MESH", help="Mesh file: .ply, .stl or .obj.")]
Unit = Annotated[str, typer.Option(help=f"Unit of the file: {UNIT_NAMES}.")]


def info(
    file: MeshFile,
    unit: Unit,
    talk: Talk,
    crossings: Annotated[
        bool, typer.Option("--check-crossings", help="Look for faces that cross, of open meshes too.")
    ] = False,
) -> int:
    """Show what a mesh file holds, and whether it can serve as skin and as product.

    Exit status 0: it can serve as one of them; 2: as neither, or bad input.
    """
    check_inputs({"MESH": file})
    if file.suffix.lower() in (".glb", ".gltf"):
        return refuse(f"{file}: holds no plain mesh; `quasirigid hand {file}` shows a hand")
    with progress(f"reading {file}"):
        vertices, faces = qr.read_mesh(file, unit=file_unit(unit, "--unit"))
        record = _record(vertices, faces, check_crossings=crossings)
    extent = float(np.ptp(vertices, axis=0).max())
    if not _EXTENTS[0] <= extent <= _EXTENTS[1]:
        warnings.warn(
            f"{file}: the mesh is {extent:.4g} m long, outside the {_EXTENTS[0]:g} to {_EXTENTS[1]:g} m of"
            f" products: is it in another unit than {unit}?",
            qr.SizeWarning,
            stacklevel=1,
        )
    talk.tell(record_table(str(file), record), record)
    return _end(file, record)


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

    Exit status 0: mended; 2: the mesh is neither skin nor product even so, or bad input.
    """
    inputs = {"MESH": file}
    check_inputs(inputs)
    check_file(out, "--out", inputs)
    known = file_unit(unit, "--unit")
    tolerance = parse_not_negative(weld_tolerance, LENGTH, "--weld-tolerance")
    with progress(f"repairing {file}"):
        vertices, faces = qr.read_mesh(file, unit=known)
        try:
            mended = qr.repair(vertices, faces, weld_tolerance=tolerance)
        except QuasirigidError as error:
            raise type(error)(f"{file}: {error}") from None
        write_mesh(mended.vertices, mended.faces, out, unit=known)
        record = {
            "changes": dict(mended.report),
            **_record(mended.vertices, mended.faces, check_crossings=False),
        }
    talk.tell(record_table(str(out), record), record)
    if not talk.json:
        say(f"wrote {out}")
    return _end(out, record)


def _end(file: Path, record: Mapping[str, Any]) -> int:
    """Return the exit status for a mesh of that record: it is refused where it serves as nothing."""
    if record["as_skin"] or record["as_product"]:
        return 0
    return refuse(f"{file}: neither skin nor product: {record['why_no_skin']}")


def _record(vertices: Any, faces: Any, *, check_crossings: bool) -> dict[str, Any]:
    """Return what a mesh holds, in SI; what is not known is None."""
    surface, no_skin = _tried(lambda: qr.Surface(vertices, faces))
    _, no_product = _tried(lambda: qr.Obstacle.mesh(vertices, faces))
    record = {
        "vertices": len(vertices),
        "faces": len(faces),
        "size": figure(np.ptp(vertices, axis=0), "m"),
        "closed": surface and surface.is_closed,
        "area": figure(surface and surface.area, "m^2"),
        "volume": figure(surface and surface.volume, "m^3"),
        "mean_edge_length": figure(surface and surface.mean_edge_length, "m"),
        "vertices_on_flat_cuts": surface and int(np.count_nonzero(~qr.skin_without_caps(surface))),
    }
    if check_crossings:
        record["crossing_faces"] = surface and _core.find_crossings(vertices, faces).tolist()
    uses = {"as_skin": no_skin is None, "why_no_skin": no_skin}
    return record | uses | {"as_product": no_product is None, "why_no_product": no_product}


def record_table(title: str, record: Mapping[str, Any]) -> str:
    """Return a record as a table of two columns in mm, mm² and cm³; what is not known is left out."""
    names, values = [], []
    for name, value in record.items():
        unit, factor = "", 1.0
        if isinstance(value, dict) and "unit" in value:
            value, (unit, factor) = value["value"], _SHOWN_UNITS[value["unit"]]
        if value is not None:
            names.append(name.replace("_", " ") + unit)
            values.append(_shown(value, factor))
    return "\n".join([title, *aligned([names, values], left=True)])


def _shown(value: Any, factor: float) -> str:
    match value:
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value * factor:.5g}"
        case [float(), *_]:
            return " x ".join(_shown(one, factor) for one in value)
        case list():
            first = f", the first {value[0][0]} and {value[0][1]}" if value else ""
            return f"{len(value)} pairs{first}"
        case dict():
            return ", ".join(f"{name} {count}" for name, count in value.items() if count) or "none"
    return str(value)


def _tried(make: Callable[[], Made]) -> tuple[Made | None, str | None]:
    """Return what is made, or why not."""
    try:
        return make(), None
    except QuasirigidError as error:
        return None, str(error)
