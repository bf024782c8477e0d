"""`quasirigid accuracy` and `quasirigid stress`: tables that are computed here and now."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

import quasirigid as qr

from .console import Talk, refuse, say
from .folder import check_folder

__all__ = ["ACCURACY_EXAMPLE", "STRESS_EXAMPLE", "accuracy", "stress"]

ACCURACY_EXAMPLE = "quasirigid accuracy --quick --out accuracy-output"
STRESS_EXAMPLE = "quasirigid stress --quick --out stress-output"

_AccuracyOut = Annotated[
    Path | None,
    typer.Option(
        help="Folder for accuracy.md, accuracy.json and, with matplotlib, accuracy.png; these are replaced."
    ),
]
_StressOut = Annotated[
    Path | None, typer.Option(help="Folder for stress.md and stress.json; these are replaced.")
]


def accuracy(
    talk: Talk,
    quick: Annotated[bool, typer.Option("--quick", help="A small part, in some seconds.")] = False,
    out: _AccuracyOut = None,
) -> int:
    """Measure error against run time on problems with known answers, and print a table.

    Mesh size, discretization, response, target error and solver; tamaas beside it where it is installed.
    Times are those of this machine as it is now.
    Exit status 0: every force keeps to its bound; 1: one does not; 2: bad input.
    """
    check_folder(out)
    table = qr.accuracy(quick=quick, progress=_progress(talk))
    return _finish(table, out, talk)


def stress(
    talk: Talk,
    quick: Annotated[bool, typer.Option("--quick", help="A part of the cases, in some seconds.")] = False,
    out: _StressOut = None,
) -> int:
    """Try extreme cases, and print what each gave beside what it should give.

    Exit status 0: every case gave that; 1: one is off; 2: bad input.
    """
    check_folder(out)
    table = qr.stress(quick=quick, progress=_progress(talk))
    return _finish(table, out, talk)


def _progress(talk: Talk) -> bool:
    """Return whether to print how far it is: one line on a terminal, nothing into a file."""
    return talk.progress and sys.stderr.isatty()


def _finish(table: qr.Table, out: Path | None, talk: Talk) -> int:
    files = () if out is None else table.save(out)
    talk.tell(str(table), table.record())
    if files and not talk.json:
        say("wrote " + ", ".join(map(str, files)))
    off = sum(not row["ok"] for row in table.rows)
    return refuse(f"{off} of {len(table)} rows are off", status=1) if off else 0
