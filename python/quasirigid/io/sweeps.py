"""Sweeps: a record for JSON, files."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._core import __version__
from .atomic import json_bytes, write_files
from .frame import sweep_columns
from .record import as_plain, inputs_record, warnings_record

if TYPE_CHECKING:
    from ..contact.swept import Sweep

__all__ = ["SWEEP_FILES", "save_sweep", "sweep_record"]

# All that `save_sweep` writes.
SWEEP_FILES = ("sweep.csv", "sweep.json")


def sweep_record(sweep: Sweep) -> dict[str, Any]:
    """Return the steps of a sweep, ready for JSON, in SI.

    Parameters
    ----------
    sweep : Sweep
        The sweep.

    Returns
    -------
    dict
        `quasirigid`, the version; `columns`, as `sweep_columns` returns them, and `warnings`: for each step,
        as in `contact_record`.
    """
    warned = [warnings_record(step) for step in sweep.warnings]
    return {"quasirigid": __version__, "columns": as_plain(sweep_columns(sweep)), "warnings": warned}


def save_sweep(
    sweep: Sweep, folder: str | PathLike[str], *, inputs: Mapping[str, Any] | None = None
) -> tuple[Path, ...]:
    """Write a sweep into a folder, as `Sweep.save` describes."""
    record = sweep_record(sweep) | {"inputs": inputs_record(inputs)}
    columns = record["columns"]
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(columns)
    table.writerows(zip(*columns.values(), strict=True))
    texts = (text.getvalue().encode(), json_bytes(record))
    contents = dict(zip(SWEEP_FILES, texts, strict=True))
    return write_files(folder, contents, instead_of=["sweep.json"])
