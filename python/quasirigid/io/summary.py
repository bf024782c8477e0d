"""A contact as a table for people: lengths in mm, forces in N, pressures in kPa."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from .._units import KPA, MM

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..contact.result import Contact

__all__ = ["compare_contacts", "contact_html", "contact_summary"]


def contact_summary(contact: Contact) -> str:
    """Return the figures of a contact as a text table, and what its scene did not need.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    str
        One line a figure, in mm, N and kPa, each with its unit; then `warnings`, `left_out`, and `advice`
        where the contact did not end solved.
    """
    return compare_contacts({"": contact})


def compare_contacts(contacts: Mapping[str, Contact]) -> str:
    """Return the figures of several contacts side by side as a text table.

    Parameters
    ----------
    contacts : mapping of str to Contact
        The contacts under their names.

    Returns
    -------
    str
        As `contact_summary`, with a column for each contact.
    """
    columns = [{"": name} | _rows(contact) for name, contact in contacts.items()]
    names = dict.fromkeys(name for column in columns for name in column)
    first = max(map(len, names))
    widths = [max(len(value) for value in column.values()) for column in columns]
    lines = []
    for name in names:
        cells = [column.get(name, "").rjust(width) for column, width in zip(columns, widths, strict=True)]
        lines.append("  ".join([name.ljust(first), *cells]).rstrip())
    notes = dict.fromkeys(note for contact in contacts.values() for note in _notes(contact))
    return "\n".join([*filter(None, lines), *notes])


def contact_html(contact: Contact) -> str:
    """Return the figures of a contact as an HTML table, for notebooks.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    str
        The lines of `contact_summary`: one `<table>`, and a `<div>` for each note.
    """
    from html import escape

    rows = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td>{escape(value)}</td></tr>'
        for name, value in _rows(contact).items()
    )
    notes = "".join(f"<div>{escape(note)}</div>" for note in _notes(contact))
    return f"<table>{rows}</table>{notes}"


def _rows(contact: Contact) -> dict[str, str]:
    counts = len(contact.pressure), len(contact.candidates), len(contact.active)
    return {
        "status": str(contact.status),
        "force (N)": f"{float(np.linalg.norm(contact.force)):.4g}",
        "force vector (N)": _vector(contact.force, 1.0),
        "moment about the origin (N mm)": _vector(contact.moment, MM),
        "center of pressure (mm)": _vector(contact.center_of_pressure, MM),
        "contact area (mm²)": f"{contact.contact_area * MM**2:.4g}",
        "peak pressure (kPa)": f"{contact.max_pressure * KPA:.4g}",
        "overlap before (mm)": f"{contact.max_penetration_before * MM:.4g}",
        "overlap after (mm)": f"{contact.max_penetration_after * MM:.2g}",
        "patches": str(len(contact.patches)),
        "vertices, candidates, active": ", ".join(map(str, counts)),
        "cells per contact radius": f"{contact.accuracy.cells_per_radius:.3g}",
        "natural residual": f"{contact.natural_residual:.1e}",
    } | {f"time: {stage} (ms)": f"{seconds * 1e3:.3g}" for stage, seconds in contact.timings.items()}


def _vector(values: ArrayLike, scale: float) -> str:
    """Numbers parted by commas; what is nothing beside the largest is 0, and no 0 has a sign."""
    numbers = np.asarray(values, dtype=np.float64) * scale
    small = np.abs(numbers) < 1e-9 * np.abs(numbers).max()
    return ", ".join(f"{number:.4g}" for number in np.where(small, 0.0, numbers) + 0.0)


def _notes(contact: Contact) -> list[str]:
    advice = [f"advice: {contact.advice}"] if contact.advice else []
    warned = [f"warning: {warning}" for warning in contact.warnings]
    return [*warned, *(f"left out: {what} ({why})" for what, why in contact.left_out), *advice]
