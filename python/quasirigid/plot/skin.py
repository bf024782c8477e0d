"""The skin in light, colored by overlap or pressure."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Literal

import numpy as np

from .._check import as_choice, as_integer
from .._units import KPA, MM
from ..contact.result import ContactError
from .outline import contact_side
from .shading import lit_skin
from .style import axes_or_new, color_bar, overlap_colors, pressure_colors, scale_bar, window_around
from .view import View, view_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..contact.result import Contact

__all__ = ["plot_skin"]

_MOST_PIXELS = 5e6  # of a picture; some 3 GB of memory


class _Shown(StrEnum):
    PRESSURE = "pressure"
    OVERLAP = "overlap"


def plot_skin(
    contact: Contact,
    *,
    show: Literal["overlap", "pressure"] = "pressure",
    ax: Axes | None = None,
    view: View | None = None,
    pixels: int = 800,
) -> Axes:
    """Draw the lit skin, colored by what it carries.

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
        Height of the picture; five million in all at most.

    Returns
    -------
    matplotlib.axes.Axes
        `ax`, in mm.

    Raises
    ------
    ContactError
        If `show` is neither, or `pixels` is 0 or makes too large a picture.
    """
    shown = as_choice("show", show, _Shown, ContactError)
    pixels = as_integer("pixels", pixels, ContactError, least=1)
    view = view_of(contact, view)
    ax = axes_or_new(ax, (4.4, 6.0))
    faces = contact.surface.faces
    if shown is _Shown.PRESSURE:
        vertices = contact.deformed.vertices
        pressure = np.nan_to_num(contact.pressure)
        values, colors, label = pressure * KPA, pressure_colors(), "pressure (kPa)"
        inside = contact_side(vertices, faces, pressure, contact.gap)
    else:
        vertices = contact.surface.vertices
        distance = contact.obstacle.signed_distance(vertices)[0]
        inside = np.where(contact.surface.skin_mask, -distance, -np.abs(distance))
        values, colors, label = inside.clip(0.0) * MM, overlap_colors(), "depth inside the product (mm)"
    window = window_around(view.project(vertices) * MM)
    count = pixels**2 * (window[1] - window[0]) / (window[3] - window[2])
    if count > _MOST_PIXELS:
        found = f"pixels is {pixels}, which makes a picture of {count:.1e} pixels"
        raise ContactError(f"{found}, expected at most {_MOST_PIXELS:.1e}: lower it")
    picture = lit_skin(vertices * MM, faces, view, values, inside, colors, window, pixels)
    ax.imshow(picture, extent=window, interpolation="antialiased")
    ax.set_axis_off()
    scale_bar(ax, window)
    if values.max() > 0.0:
        color_bar(ax, colors, float(values.max()), label)
    return ax
