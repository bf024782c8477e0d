"""Whole figures of one contact, and of several side by side."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from .._units import KPA, MM
from ..contact.result import ContactError
from ..io.summary import infinite_error, with_error
from .footprint import plot_footprint
from .section import plot_section
from .skin import plot_skin
from .style import INK, color_bar, new_figure, pressure_colors
from .view import View, as_contact, view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..contact.result import Contact
    from ..surface import Surface

__all__ = ["comparison_figure", "contact_figure", "footprint_figure"]

_TITLES = {
    "before": "Before: overlap",
    "after": "After: pressure",
    "cut": "Cut through the contact",
    "footprint": "Footprint of pressure",
}
_IN_A_ROW = 4  # footprints side by side, at most
_LINE, _LINES = 34, 4  # letters in a line of a name, and lines, that a footprint has room for


def contact_figure(contact: Contact, *, bone: Surface | None = None, view: View | None = None) -> Figure:
    """Return a figure of the skin before and after, the cut through the contact, and the footprint.

    Parameters
    ----------
    contact : Contact
        What to draw; any ending can be drawn.
    bone : Surface, optional
        Bones inside the skin, drawn in the cut.
    view : View, optional
        From where; `pad_view` when left out.

    Returns
    -------
    matplotlib.figure.Figure
        Lengths in mm, pressures in kPa.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    figure = new_figure((11.0, 6.0))
    view = view_of(contact, view)
    axes = figure.subplot_mosaic(
        [["before", "after", "cut"], ["before", "after", "footprint"]],
        width_ratios=[1.0, 1.0, 1.15],
        height_ratios=[1.0, 1.2],
        gridspec_kw={"hspace": 0.1},  # between the legend of the cut and the title below it
    )
    plot_skin(contact, show="overlap", ax=axes["before"], view=view)
    plot_skin(contact, show="pressure", ax=axes["after"], view=view)
    plot_section(contact, bone=bone, ax=axes["cut"], view=view)
    plot_footprint(contact, ax=axes["footprint"], view=view, with_color_bar=False)
    for name, title in _TITLES.items():
        axes[name].set_title(title, fontsize=11, color=INK, pad=8)
    for name in ("before", "after", "cut"):
        axes[name].set_anchor("N")
    figure.suptitle(headline(contact), fontsize=13, color=INK, x=0.02, ha="left", weight="bold")
    return figure


def footprint_figure(contact: Contact, *, view: View | None = None) -> Figure:
    """Return a figure of the footprint of pressure in the contact plane.

    Parameters
    ----------
    contact, view
        As for `contact_figure`.

    Returns
    -------
    matplotlib.figure.Figure
        Lengths in mm, pressures in kPa.
    """
    figure = new_figure((6.6, 5.6))
    plot_footprint(contact, ax=figure.subplots(), view=view)
    figure.suptitle(headline(contact), fontsize=12, color=INK, x=0.03, ha="left", weight="bold")
    return figure


def comparison_figure(contacts: Mapping[str, Contact]) -> Figure:
    """Return a figure of the footprints of several contacts at one scale of pressure.

    Parameters
    ----------
    contacts : mapping of str to Contact
        The contacts under their names, which become titles as they are, wrapped; at least one.

    Returns
    -------
    matplotlib.figure.Figure
        Footprints in rows of up to four, lengths in mm, pressures in kPa.

    Raises
    ------
    ContactError
        If there is no contact; a TypeError if `contacts` is no mapping of contacts.
    """
    if not isinstance(contacts, Mapping):
        raise TypeError(f"contacts is a {type(contacts).__name__}, expected a mapping of names to contacts")
    if not contacts:
        raise ContactError("contacts is empty, expected at least one")
    for name, contact in contacts.items():
        as_contact(f"contacts[{name!r}]", contact)
    rows = math.ceil(len(contacts) / _IN_A_ROW)
    columns = math.ceil(len(contacts) / rows)
    figure = new_figure((5.2 * columns + 0.8, 5.4 * rows))
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    axes, spare = panels.ravel()[: len(contacts)], panels.ravel()[len(contacts) :]
    top = max(float(np.nan_to_num(contact.pressure).max()) for contact in contacts.values()) * KPA
    for ax, (name, contact) in zip(axes, contacts.items(), strict=True):
        plot_footprint(contact, ax=ax, with_color_bar=False, top=top or None)
        title = textwrap.fill(str(name), _LINE, max_lines=_LINES, placeholder="…")
        ax.set_title(f"{title}\n{headline(contact)}", fontsize=10, color=INK, pad=8, parse_math=False)
        # Panels that share axes have numbers at the outer ones alone, of which some may be spare.
        ax.tick_params(labelbottom=True, labelleft=True)
    reach = max(max(map(abs, (*ax.get_xlim(), *ax.get_ylim()))) for ax in axes)
    axes[0].set_xlim(-reach, reach)
    axes[0].set_ylim(-reach, reach)
    if top > 0.0:
        color_bar(list(panels[:, -1]), pressure_colors(), top, "pressure (kPa)", beside=True)
    for ax in spare:
        ax.remove()
    return figure


def headline(contact: Contact) -> str:
    """Return force, area, overlap and peak with their errors; of another ending, which it was."""
    if contact.status == "no_contact":
        return "No contact"
    if contact.status != "solved":
        return f"No result: the contact ended with '{contact.status}'"
    accuracy, unbounded = contact.accuracy, infinite_error(contact)
    force = f"{np.linalg.norm(contact.force):.3g} N" + with_error(accuracy.force_error, unbounded)
    area = f"{contact.contact_area * MM**2:.3g} mm²" + with_error(accuracy.area_error, unbounded)
    peak = f"{contact.max_pressure * KPA:.3g} kPa" + with_error(accuracy.max_pressure_error, unbounded)
    return f"{force} on {area}, overlap {contact.max_penetration_before * MM:.3g} mm\nup to {peak}"
