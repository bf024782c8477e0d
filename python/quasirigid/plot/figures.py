"""Skin and footprint of a contact, alone and side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

import numpy as np

from .outline import contact_side
from .section import plot_section
from .shading import lit_skin
from .style import (
    FAINT,
    INK,
    axes_or_new,
    colour_bar,
    new_figure,
    overlap_colours,
    pressure_colours,
    round_steps,
    scale_bar,
    window_around,
)
from .view import KPA, MM, View, pad_view, vertices_before

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..contact.result import Contact
    from ..surface import Surface

__all__ = [
    "before_and_after",
    "footprint",
    "plot_footprint",
    "plot_skin",
    "side_by_side",
]


def plot_skin(
    contact: Contact,
    *,
    show: Literal["overlap", "pressure"] = "pressure",
    ax: Axes | None = None,
    view: View | None = None,
    pixels: int = 800,
) -> Axes:
    """The lit skin, coloured by what it carries.

    Parameters
    ----------
    contact : Contact
        What to draw.
    show : {"pressure", "overlap"}
        The deformed skin with its pressure (kPa), or the skin before with its depth inside the product (mm).
    ax : Axes, optional
        Where to draw; a new figure when left out.
    view : View, optional
        From where; `pad_view` when left out.
    pixels : int
        Height of the picture.
    """
    view = pad_view(contact) if view is None else view
    ax = axes_or_new(ax, (4.4, 6.0))
    faces = np.asarray(contact.deformed.faces, dtype=np.int64)
    if show == "pressure":
        vertices = np.asarray(contact.deformed.vertices)
        pressure = np.nan_to_num(np.asarray(contact.pressure))
        values, colours, label = pressure * KPA, pressure_colours(), "pressure (kPa)"
        inside = contact_side(vertices, faces, pressure, np.asarray(contact.gap))
    else:
        vertices = vertices_before(contact)
        distance = np.asarray(contact.obstacle.signed_distance(vertices)[0])
        inside = np.where(np.asarray(contact.deformed.skin_mask), -distance, -np.abs(distance))
        values, colours, label = inside.clip(0.0) * MM, overlap_colours(), "depth inside the product (mm)"
    window = window_around(view.project(vertices) * MM)
    picture = lit_skin(vertices * MM, faces, view, values, inside, colours, window, pixels)
    ax.imshow(picture, extent=window, interpolation="antialiased")
    ax.set_axis_off()
    scale_bar(ax, window)
    if values.max() > 0.0:
        colour_bar(ax, colours, float(values.max()), label)
    return ax


def plot_footprint(
    contact: Contact,
    *,
    ax: Axes | None = None,
    view: View | None = None,
    with_colour_bar: bool = True,
    top: float | None = None,
) -> Axes:
    """The pressure (kPa) in the contact plane (mm), with the outline of the contact.

    Parameters
    ----------
    contact : Contact
        What to draw.
    ax : Axes, optional
        Where to draw; a new figure when left out.
    view : View, optional
        The view whose `right` and `up` span the plane; `pad_view` when left out.
    with_colour_bar : bool
        False where a colour bar of the same scale stands beside.
    top : float, optional
        Pressure (kPa) at the dark end of the colours; the contact's own largest when left out.

    Notes
    -----
    The outline crosses the edges between touching and free vertices where pressure and gap, extended to the
    rim, both vanish. The origin is the centre of pressure; thin lines mark steps of the pressure.
    """
    from matplotlib.tri import Triangulation

    view = pad_view(contact) if view is None else view
    ax = axes_or_new(ax, (6.4, 5.4))
    pressure = np.nan_to_num(np.asarray(contact.pressure)) * KPA
    ax.set_aspect("equal")
    for spine in ("top", "right"):
        ax.spines[spine].set_visible(False)
    ax.set_xlabel("across (mm)", color=INK)
    ax.set_ylabel("along (mm)", color=INK)
    ax.tick_params(labelsize=8.5, colors=INK)
    if not pressure.max() > 0.0:
        ax.text(0.5, 0.5, "no pressure", transform=ax.transAxes, ha="center", va="center", color=FAINT)
        return ax
    faces = np.asarray(contact.deformed.faces, dtype=np.int64)
    vertices = np.asarray(contact.deformed.vertices)
    plane = view.project(vertices - np.asarray(contact.center_of_pressure)) * MM
    touched = pressure > 0.0
    low, high = plane[touched].min(axis=0), plane[touched].max(axis=0)
    margin = 0.22 * float((high - low)[:2].max()) + 1e-3
    # Faces that look at the product and lie near the contact: no other finger, not the back of this one.
    corners = plane[faces]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    facing = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 0.0
    near = ((corners > low - 2 * margin) & (corners < high + 2 * margin)).all(axis=(1, 2))
    kept = faces[facing & near]
    net = Triangulation(plane[:, 0], plane[:, 1], kept)
    ax.triplot(net, color="#e3e5e9", linewidth=0.4, zorder=0)
    side = contact_side(vertices, faces, np.asarray(contact.pressure), np.asarray(contact.gap))
    colours, top = pressure_colours(), float(pressure.max()) if top is None else top
    filled = ax.tricontourf(
        net, pressure.clip(0.0, top), levels=np.linspace(0.0, top, 65), cmap=colours, zorder=1
    )
    steps = [level for level in round_steps(top) if level < 0.97 * top]
    lines = ax.tricontour(net, pressure, levels=steps, colors="white", linewidths=0.6, alpha=0.75, zorder=2)
    outline = ax.tricontour(net, side, levels=[0.0], colors=INK, linewidths=1.5, zorder=3)
    for drawn in (filled, lines):
        drawn.set_clip_path(outline.get_paths()[0], transform=ax.transData)
    ax.plot(0.0, 0.0, marker="+", color="white", markersize=9, markeredgewidth=1.4, zorder=4)
    ax.set_xlim(low[0] - margin, high[0] + margin)
    ax.set_ylim(low[1] - margin, high[1] + margin)
    if with_colour_bar:
        colour_bar(ax, colours, top, "pressure (kPa)", beside=True)
    return ax


def before_and_after(contact: Contact, *, bone: Surface | None = None, view: View | None = None) -> Figure:
    """The skin before, the skin after with its pressure, the cut through the contact, and the footprint."""
    figure = new_figure((11.0, 6.0))
    view = pad_view(contact) if view is None else view
    axes = figure.subplot_mosaic(
        [["before", "after", "cut"], ["before", "after", "footprint"]],
        width_ratios=[1.0, 1.0, 1.15],
        height_ratios=[1.0, 1.2],
    )
    plot_skin(contact, show="overlap", ax=axes["before"], view=view)
    plot_skin(contact, show="pressure", ax=axes["after"], view=view)
    plot_section(contact, bone=bone, ax=axes["cut"], view=view)
    plot_footprint(contact, ax=axes["footprint"], view=view, with_colour_bar=False)
    titles = {
        "before": "Before: overlap",
        "after": "After: pressure",
        "cut": "Cut through the contact",
        "footprint": "Footprint of pressure",
    }
    for name, title in titles.items():
        axes[name].set_title(title, fontsize=11, color=INK, pad=8)
    for name in ("before", "after", "cut"):
        axes[name].set_anchor("N")
    figure.suptitle(_headline(contact), fontsize=13, color=INK, x=0.02, ha="left", weight="bold")
    return figure


def footprint(contact: Contact, *, view: View | None = None) -> Figure:
    """One figure with the footprint of pressure in the contact plane."""
    figure = new_figure((6.6, 5.6))
    plot_footprint(contact, ax=figure.subplots(), view=view)
    figure.suptitle(_headline(contact), fontsize=12, color=INK, x=0.03, ha="left", weight="bold")
    return figure


def side_by_side(contacts: Mapping[str, Contact]) -> Figure:
    """The footprints of several contacts at the same scale of pressure, each with its name and figures."""
    figure = new_figure((5.2 * len(contacts) + 0.8, 5.4))
    axes = figure.subplots(1, len(contacts), squeeze=False, sharex=True, sharey=True)[0]
    top = max(float(np.nan_to_num(contact.pressure).max()) for contact in contacts.values()) * KPA
    for ax, (name, contact) in zip(axes, contacts.items(), strict=True):
        plot_footprint(contact, ax=ax, with_colour_bar=False, top=top)
        ax.set_title(f"{name}\n{_headline(contact)}", fontsize=11, color=INK, pad=8)
    reach = max(max(map(abs, (*ax.get_xlim(), *ax.get_ylim()))) for ax in axes)
    axes[0].set_xlim(-reach, reach)
    axes[0].set_ylim(-reach, reach)
    if top > 0.0:
        colour_bar(axes[-1], pressure_colours(), top, "pressure (kPa)", beside=True)
    return figure


def _headline(contact: Contact) -> str:
    if contact.status == "no_contact":
        return "No contact"
    if contact.status != "solved":
        return f"No result: the contact ended with '{contact.status}'"
    force = float(np.linalg.norm(contact.force))
    parts = [
        f"{force:.3g} N on {contact.contact_area * MM**2:.3g} mm²",
        f"up to {contact.max_pressure * KPA:.3g} kPa",
        f"{contact.max_penetration_before * MM:.3g} mm deep",
    ]
    return ", ".join(parts)
