"""What the command line prints: figures as a table, progress, warnings and refusals."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from ..contact.result import Contact

MM = 1e3
KPA = 1e-3


def print_contacts(contacts: dict[str, Contact]) -> None:
    """Print the figures of contacts side by side, and what their scenes did not need."""
    table = Table(title="Contact", title_justify="left", box=None, pad_edge=False)
    table.add_column("")
    for name in contacts:
        table.add_column(name, justify="right")
    columns = [dict(_figures(contact)) for contact in contacts.values()]
    for row in dict.fromkeys(key for column in columns for key in column):
        table.add_row(row, *(column.get(row, "") for column in columns))
    terminal = console()
    terminal.print(table)
    skipped = dict.fromkeys(
        (str(what), str(why)) for contact in contacts.values() for what, why in contact.left_out
    )
    for what, why in skipped:
        terminal.print(f"left out: {what} ({why})", soft_wrap=True)


def _figures(contact: Contact) -> Iterator[tuple[str, str]]:
    def vector(values: Any, scale: float) -> str:
        return ", ".join(f"{value * scale:.4g}" for value in np.asarray(values, dtype=float) + 0.0)

    yield "status", str(contact.status)
    yield "force (N)", f"{float(np.linalg.norm(contact.force)):.4g}"
    yield "force vector (N)", vector(np.round(contact.force, 9), 1.0)
    yield "moment about the origin (N mm)", vector(np.round(contact.moment, 12), MM)
    yield "centre of pressure (mm)", vector(np.round(contact.center_of_pressure, 9), MM)
    yield "contact area (mm²)", f"{contact.contact_area * MM**2:.4g}"
    yield "peak pressure (kPa)", f"{contact.max_pressure * KPA:.4g}"
    yield "overlap before (mm)", f"{contact.max_penetration_before * MM:.4g}"
    yield "overlap after (mm)", f"{contact.max_penetration_after * MM:.2g}"
    yield "volume change (mm³)", f"{contact.volume_change * MM**3:.4g}"
    yield (
        "vertices, candidates, active",
        f"{len(contact.pressure)}, {len(contact.candidates)}, {len(contact.active)}",
    )
    yield "natural residual", f"{contact.natural_residual:.1e}"
    for stage, seconds in contact.timings.items():
        yield f"time: {stage} (ms)", f"{seconds * 1e3:.3g}"


@contextmanager
def progress(what: str) -> Iterator[None]:
    """Say on stderr what is going on, once it takes more than a second."""
    terminal = Console(stderr=True)
    if terminal.is_terminal:
        with terminal.status(f"{what} ..."):
            yield
        return
    timer = threading.Timer(1.0, lambda: print(f"{what} ...", file=sys.stderr, flush=True))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def console() -> Console:
    """Standard output; wide where it is no terminal, so that no line is cut."""
    terminal = Console(highlight=False)
    return terminal if terminal.is_terminal else Console(highlight=False, width=160)


def show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """A warning as one line on stderr."""
    print(f"warning: {message}", file=sys.stderr)


def refuse(message: str, *, status: int = 2) -> int:
    """Say on one line of stderr what is wrong; returns the exit status."""
    print("error: " + " ".join(message.split()), file=sys.stderr)
    return status
