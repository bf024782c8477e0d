"""The table of `accuracy` as a page and as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..._text import aligned
from ..text import as_error, as_time, markdown
from .kernels import SOLVERS

__all__ = ["accuracy_page", "accuracy_summary"]

Row = Mapping[str, Any]

_PAGE = """\
# Accuracy

Error against run time on problems with known answers, G = 60 kPa, nu = 0.5 where nothing else is said.
`quasirigid accuracy --out FOLDER` (`qr.accuracy`) writes this page; times are wall times of the machine that
ran it, medians of up to three.

A press refines the skin's mesh around the contact until the errors of force and area that the mesh leaves are
estimated to be below `ContactOptions(target_error=0.02)`; `target_error=None` takes the mesh as it is.
`contact.accuracy` holds the estimates, `contact.refinements` what each mesh gave. Errors here are root mean
squares over several places of the product on meshes of squares cut by one diagonal, with vertices moved by up
to a quarter of a cell; refined contacts start from 3 cells per contact radius. The error of force is held to
twice the target or, on a mesh as it is, to one cell of the contact's radius; {verdict}.
{picture}
{parts}
"""
_PICTURE = """
![Errors of force and area against Hertz over the time of a contact](accuracy.png)
"""
_SPHERE = """\
## Sphere

A sphere so large (R = 200 m, 0.5 mm deep) that it is Hertz's parabola. tamaas solves on square pixels under
Hertz's force; its force column is 3/2 of its error of approach. *: beyond it a smaller error costs more.
"""
_OTHERS = """\
## Other shapes, and the layer

Crossed cylinders (Hertz's ellipse), a cylinder along a strip, whose load and half-width in the middle are
compared with Hertz's line contact, a flat punch, a cone, and the sphere on an incompressible layer.
"""
_BODIES = """\
## Bodies with a bone

A flat plate on a sphere of 8 mm with a rigid core of 3 mm (642 vertices each) against finite elements, which
hold to 0.2 %, and on the built-in fingertip, 1.12 mm deep, against the same on a finer mesh. The body is
solved on a coarse mesh (two levels) unless it says its own.
"""
_ESTIMATES = """\
## The estimates

{count} random contacts of Hertz: 2 to 8 cells per contact radius, jitter up to 0.3 cells, lattices of 60 to
120 degrees, targets of 0.005 to 0.05 for the refined ones. Share of them whose error is within the estimate,
and median of estimate over error. An estimate is no bound.
"""


def accuracy_page(rows: Sequence[Row], *, has_picture: bool) -> str:
    """Return the page in Markdown."""
    sphere = [row for row in rows if row["scene"] == "sphere"]
    bodies = [row for row in rows if row["depth"] is not None]
    estimates = [row for row in rows if row["scene"] == "estimates"]
    solvers = [row for row in rows if row["scene"].endswith(SOLVERS)]
    taken = {id(row) for group in (sphere, bodies, estimates, solvers) for row in group}
    others = [row for row in rows if id(row) not in taken]
    parts = [_SPHERE, markdown(*_columns(sphere, ("mesh", "fine", "nodes", *_ERRORS, "time")))]
    if solvers:
        words = "Each solver of the complementarity problems, in Galerkin form with `target_error=None`:\n"
        parts += [words, markdown(*_columns(solvers, ("scene", "fine", "nodes", *_ERRORS, "time")))]
    if others:
        parts += [_OTHERS, markdown(*_columns(others, ("scene", "mesh", "fine", "nodes", *_ERRORS, "time")))]
    if bodies:
        names = ("scene", "response", "mesh", "depth", "nodes", "force", "estimate", "time", "set-up")
        parts += [_BODIES, markdown(*_columns(bodies, names))]
    if estimates:
        parts += [_ESTIMATES.format(count=estimates[0]["nodes"]), _estimates(estimates)]
    off = [row for row in rows if not row["ok"]]
    verdict = "every row keeps to that" if not off else f"{len(off)} of {len(rows)} rows do not (**off**)"
    picture = _PICTURE if has_picture else ""
    return _PAGE.format(verdict=verdict, picture=picture, parts="\n".join(_spaced(parts))).rstrip() + "\n"


def accuracy_summary(rows: Sequence[Row]) -> str:
    """Return the lines for a terminal."""
    measured = [row for row in rows if row["scene"] != "estimates"]
    names = ("scene", "response", "mesh", "fine", "nodes", *_ERRORS, "estimate", "time")
    head, cells = _columns(measured, names)
    lines = aligned(list(zip(head, *cells, strict=True)), left=True)
    off = [row for row in rows if not row["ok"]]
    if any(row["knee"] for row in rows):
        lines.append("* the knee: beyond it a smaller error costs more")
    lines += [f"off: {row['scene']}, {_mesh(row)}: {row['note'] or _why(row)}" for row in off]
    return "\n".join(lines)


_ERRORS = ("force", "area", "peak")


def _columns(rows: Sequence[Row], names: Sequence[str]) -> tuple[list[str], list[list[str]]]:
    return list(names), [[_cell(row, name) for name in names] for row in rows]


def _cell(row: Row, name: str) -> str:
    match name:
        case "mesh":
            return _mesh(row)
        case "fine":
            return _fine(row)
        case "scene" if row["scene"].endswith(SOLVERS):
            return f"{row['scene'].removesuffix(SOLVERS)}, {row['solver']}"
        case "depth":
            return "-" if row["depth"] is None else f"{row['depth'] * 1e3:g} mm"
        case "nodes":
            return "-" if row["nodes"] is None else f"{row['nodes']:.0f}"
        case "force":
            # Of one contact, and not a mean over places.
            is_single = row["depth"] is not None
            return as_error(row["force_error"], signed=is_single) + ("" if row["ok"] else " **off**")
        case "area":
            return as_error(row["area_error"])
        case "peak":
            return as_error(row["max_pressure_error"])
        case "estimate":
            return as_error(row["estimated_force_error"])
        case "time":
            return as_time(row["seconds"]) + (" *" if row["knee"] else "")
        case "set-up":
            return as_time(row["setup_seconds"])
        case _:
            return str(row[name] or "-")


def _mesh(row: Row) -> str:
    if str(row["response"]).startswith("tamaas"):
        return str(row["response"])
    return f"{row['mesh'] or '-'}, {row['discretization'] or '-'}"


def _fine(row: Row) -> str:
    if row["target_error"] is not None:
        return f"target {row['target_error']:g}"
    if row["cells_per_radius"] is None:
        return "-"
    return f"{row['cells_per_radius']:.2g} " + ("pixels" if row["discretization"] == "pixels" else "cells")


def _why(row: Row) -> str:
    return f"the force is {as_error(row['force_error'])} off, expected at most {as_error(row['limit'])}"


def _estimates(rows: Sequence[Row]) -> str:
    figures = list(rows[0]["within"])
    lines = [
        [_mesh(row), *(f"{row['within'][name]:.0%}, {row['ratio'][name]:.2g}" for name in figures)]
        for row in rows
    ]
    return markdown(["mesh", *(name.replace("_", " ") for name in figures)], lines)


def _spaced(parts: Sequence[str]) -> list[str]:
    """Return paragraphs, one empty line between them."""
    return [part.rstrip() + "\n" for part in parts]
