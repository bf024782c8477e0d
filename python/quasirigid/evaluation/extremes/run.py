"""Extreme cases and what each gave."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable, Iterator
from itertools import chain
from typing import Any

from ...errors import QuasirigidWarning
from ..memo import forget
from ..table import Table, TableProgress, table_reporter
from .alone import row_of_alone
from .case import Case, row_of
from .endings import ending_cases
from .fingers import finger_cases
from .flat import mesh_cases
from .lcps import lcp_cases
from .touches import touch_cases

__all__ = ["all_cases", "print_row", "run_cases", "stress"]


def stress(*, quick: bool = False, progress: TableProgress | bool | None = None) -> Table:
    """Try extreme cases: moduli, Poisson's ratios, lengths, places, depths, meshes, products and LCPs.

    Each expects the scaled answer on one mesh (``target_error=None``), to the larger of 1e-9 and 100 times
    the rounding of the coordinates over the depth, or an error of a named kind with certain words.

    Parameters
    ----------
    quick : bool
        A part of them, in some seconds; the whole takes about a minute.
    progress : callable or bool, optional
        Called as ``progress(name, done, total)`` after each case; True prints to stderr.

    Returns
    -------
    Table
        One row a case: `group`, `case`, `expected`, `found`, `error` and its `limit` (relative), `seconds`,
        `ok`. What a case did not expect to be raised makes a row that is off, not an abort.

    Examples
    --------
    >>> import quasirigid as qr
    >>> table = qr.stress(quick=True)  # doctest: +SKIP
    >>> table.ok, [row["case"] for row in table.rows if not row["ok"]]  # doctest: +SKIP
    (True, [])
    """
    return run_cases((case for case in all_cases() if case.quick or not quick), progress)


def all_cases() -> Iterator[Case]:
    """Make every case."""
    return chain(finger_cases(), mesh_cases(), touch_cases(), ending_cases(), lcp_cases())


def run_cases(cases: Iterable[Case], progress: TableProgress | bool | None = None) -> Table:
    """Carry out cases, one after the other."""
    report = table_reporter(progress)
    listed = list(cases)
    rows: list[dict[str, Any]] = []
    try:
        with warnings.catch_warnings():
            # Extreme questions are warned of; here the answers count.
            warnings.simplefilter("ignore", QuasirigidWarning)
            for case in listed:
                rows.append(row_of(case) if case.alone is None else row_of_alone(case))
                report(f"{case.group}: {case.name}", len(rows), len(listed))
    finally:
        forget()
    return Table(name="stress", _rows=tuple(rows))


def print_row(group: str, name: str) -> None:
    """Carry out one case and print its row as JSON, for the process that asked."""
    (case,) = (case for case in all_cases() if (case.group, case.name) == (group, name))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", QuasirigidWarning)
        print(json.dumps(row_of(case)))
