"""The footprint: pressure in the contact plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._check import as_number
from .._units import KPA, MM
from ..contact.result import ContactError
from .outline import contact_side
from .style import FAINT, INK, axes_or_new, color_bar, label_axes, pressure_colors, round_steps
from .view import View, view_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.tri import Triangulation
    from numpy.typing import NDArray

    from .._arrays import Floats, Indices
    from ..contact.result import Contact

__all__ = ["plot_footprint"]


def plot_footprint(
    contact: Contact,
    *,
    ax: Axes | None = None,
    view: View | None = None,
    with_color_bar: bool = True,
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
    with_color_bar : bool
        False where a color bar of the same scale stands beside.
    top : float, optional
        Pressure (kPa) at the dark end of the colors, > 0; the contact's own largest when left out.

    Returns
    -------
    matplotlib.axes.Axes
        `ax`, in mm.

    Notes
    -----
    The outline crosses the edges between touching and free vertices where pressure and gap, extended to the
    rim, both vanish. The origin is the center of pressure; thin lines mark steps of the pressure. Patches on
    skin that faces away are counted.
    """
    from matplotlib.tri import Triangulation

    top = None if top is None else as_number("top", top, ContactError)
    view = view_of(contact, view)
    ax = axes_or_new(ax, (6.4, 5.4))
    ax.set_aspect("equal")
    label_axes(ax, "across (mm)", "along (mm)")
    ax.tick_params(labelsize=8.5)
    pressure = np.nan_to_num(contact.pressure) * KPA
    if not pressure.max() > 0.0:
        return _note(ax, 0.5, "no pressure")
    plane = view.project(contact.deformed.vertices - contact.center_of_pressure) * MM
    faces = _facing(plane, contact.deformed.faces)
    seen = np.isin(np.arange(len(plane)), faces)
    touched = seen & (pressure > 0.0)
    if not touched.any():
        return _note(ax, 0.5, "not seen from here")
    low, high = plane[touched].min(axis=0), plane[touched].max(axis=0)
    loaded = touched[faces].any(axis=1)
    margin = max(0.22 * float((high - low)[:2].max()), 2.0 * _mean_edge(plane[faces[loaded]]))
    corners = plane[faces]
    near = ((corners > low - 2 * margin) & (corners < high + 2 * margin)).all(axis=(1, 2))
    net = Triangulation(plane[:, 0], plane[:, 1], faces[loaded | near])
    top = float(pressure.max()) if top is None else top
    _draw_pressure(ax, net, pressure, top, contact)
    ax.set_xlim(low[0] - margin, high[0] + margin)
    ax.set_ylim(low[1] - margin, high[1] + margin)
    _note(ax, 0.97, _unseen(contact, seen))
    if with_color_bar:
        color_bar(ax, pressure_colors(), top, "pressure (kPa)", beside=True)
    return ax


def _note(ax: Axes, height: float, text: str) -> Axes:
    ax.text(
        0.5, height, text, transform=ax.transAxes, ha="center", va="center", color=FAINT, fontsize=8.5,
        zorder=5, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.9, "pad": 1.5 if text else 0.0},
    )  # fmt: skip
    return ax


def _facing(plane: Floats, faces: Indices) -> Indices:
    """Return the faces that look at the product: not the finger's back."""
    corners = plane[faces]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return faces[first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 0.0]


def _mean_edge(corners: Floats) -> float:
    """Return the mean length of the edges of faces, by their corners (k, 3, 3)."""
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())


def _unseen(contact: Contact, seen: NDArray[np.bool_]) -> str:
    """Return how much of the contact is on vertices that are not seen; "" of less than a hundredth."""
    hidden = contact.active[~seen[contact.active]]
    force = float(contact.node_force[hidden].sum())
    if force < 0.01 * contact.node_force.sum():
        return ""
    unseen = sum(not seen[patch.vertices].any() for patch in contact.patches)
    what = f"{unseen} of {len(contact.patches)} patches" if unseen else "a part"
    return f"{what} not seen from here ({force:.2g} N)"


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
    # White on dark, and dark on white where no pressure is.
    for color, width in ((INK, 2.6), ("white", 1.4)):
        ax.plot(0.0, 0.0, marker="+", color=color, markersize=9, markeredgewidth=width, zorder=4)
