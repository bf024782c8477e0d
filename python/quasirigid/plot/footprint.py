"""The footprint: pressure in the contact plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._units import KPA, MM
from .outline import contact_side
from .style import FAINT, INK, axes_or_new, color_bar, pressure_colors, round_steps
from .view import View, pad_view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.tri import Triangulation

    from ..contact.result import Contact
    from .raster import Floats, Indices

__all__ = ["plot_footprint"]


def plot_footprint(
    contact: Contact,
    *,
    ax: Axes | None = None,
    view: View | None = None,
    with_colour_bar: bool = True,
    top: float | None = None,
) -> Axes:
    """Draw the pressure (kPa) in the contact plane (mm), with the outline of the contact.

    Parameters
    ----------
    contact : Contact
        What to draw.
    ax : Axes, optional
        Where to draw; a new figure when left out.
    view : View, optional
        The view whose `right` and `up` span the plane; `pad_view` when left out.
    with_colour_bar : bool
        False where a color bar of the same scale stands beside.
    top : float, optional
        Pressure (kPa) at the dark end of the colors; the contact's own largest when left out.

    Returns
    -------
    matplotlib.axes.Axes
        `ax`, in mm.

    Notes
    -----
    The outline crosses the edges between touching and free vertices where pressure and gap, extended to the
    rim, both vanish. The origin is the center of pressure; thin lines mark steps of the pressure.
    """
    from matplotlib.tri import Triangulation

    view = pad_view(contact) if view is None else view
    ax = _plane_axes(axes_or_new(ax, (6.4, 5.4)))
    pressure = np.nan_to_num(contact.pressure) * KPA
    if not pressure.max() > 0.0:
        ax.text(0.5, 0.5, "no pressure", transform=ax.transAxes, ha="center", va="center", color=FAINT)
        return ax
    plane = view.project(contact.deformed.vertices - contact.center_of_pressure) * MM
    touched = pressure > 0.0
    low, high = plane[touched].min(axis=0), plane[touched].max(axis=0)
    margin = 0.22 * float((high - low)[:2].max()) + 1e-3
    faces = _facing(plane, contact.deformed.faces, low - 2 * margin, high + 2 * margin)
    net = Triangulation(plane[:, 0], plane[:, 1], faces)
    top = float(pressure.max()) if top is None else top
    _draw_pressure(ax, net, pressure, top, contact)
    ax.set_xlim(low[0] - margin, high[0] + margin)
    ax.set_ylim(low[1] - margin, high[1] + margin)
    if with_colour_bar:
        color_bar(ax, pressure_colors(), top, "pressure (kPa)", beside=True)
    return ax


def _plane_axes(ax: Axes) -> Axes:
    """Return the axes with labels in mm, without the frame above and to the right."""
    ax.set_aspect("equal")
    for spine in ("top", "right"):
        ax.spines[spine].set_visible(False)
    ax.set_xlabel("across (mm)", color=INK)
    ax.set_ylabel("along (mm)", color=INK)
    ax.tick_params(labelsize=8.5, colors=INK)
    return ax


def _facing(plane: Floats, faces: Indices, low: Floats, high: Floats) -> Indices:
    """Return the faces between `low` and `high` (3,) that look at the product: not the finger's back."""
    corners = plane[faces]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    facing = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 0.0
    near = ((corners > low) & (corners < high)).all(axis=(1, 2))
    return faces[facing & near]


def _draw_pressure(ax: Axes, net: Triangulation, pressure: Floats, top: float, contact: Contact) -> None:
    """Draw mesh, colors up to `top` (kPa), steps, outline and the center of pressure."""
    ax.triplot(net, color="#e3e5e9", linewidth=0.4, zorder=0)
    filled = ax.tricontourf(
        net, pressure.clip(0.0, top), levels=np.linspace(0.0, top, 65), cmap=pressure_colors(), zorder=1
    )
    steps = [level for level in round_steps(top) if level < 0.97 * top]
    lines = ax.tricontour(net, pressure, levels=steps, colors="white", linewidths=0.6, alpha=0.75, zorder=2)
    side = contact_side(contact.deformed.vertices, contact.deformed.faces, contact.pressure, contact.gap)
    outline = ax.tricontour(net, side, levels=[0.0], colors=INK, linewidths=1.5, zorder=3)
    for drawn in (filled, lines):
        drawn.set_clip_path(outline.get_paths()[0], transform=ax.transData)
    ax.plot(0.0, 0.0, marker="+", color="white", markersize=9, markeredgewidth=1.4, zorder=4)
