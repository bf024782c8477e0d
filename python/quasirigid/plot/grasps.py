"""Pictures of a hand that holds a product."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._check import as_kind
from .._units import KPA, MM
from ..hand import Grasp
from .outline import contact_side
from .shading import SKIN, lit_skin
from .style import PRODUCT, color_bar, new_figure, pressure_colors, scale_bar, window_around
from .view import View

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .raster import Floats

__all__ = ["grasp_figure"]

_THUMB_SIDE = (-0.85, 0.15, -0.55)
_FINGER_SIDE = (0.35, -0.75, -0.55)
_PALM_SIDE = (0.0, 0.6, -0.8)
# Panels: title, line of sight in the palm's frame, whether the product is drawn.
_PANELS = (
    ("from the thumb's side", _THUMB_SIDE, True),
    ("from the fingertips", _FINGER_SIDE, True),
    ("without the product", _PALM_SIDE, False),
)
_SIZE = (12.0, 5.2)  # inches
_PIXELS = 560  # height of a panel


def grasp_figure(grasp: Grasp) -> Figure:
    """Return pictures of a grasp (extra `plot`): hand and product from two sides, and the hand's pressure.

    Parameters
    ----------
    grasp : Grasp
        The grasp. A product that is a primitive has no triangles and is not drawn.

    Returns
    -------
    Figure
        The deformed hand with its pressure (kPa).
    """
    as_kind("grasp", grasp, Grasp, "close_hand returns one")
    contact, palm = grasp.contact, np.array(grasp.posed.palm)
    vertices, faces = contact.deformed.vertices, contact.deformed.faces
    pressure = np.nan_to_num(contact.pressure)
    inside = contact_side(vertices, faces, pressure, contact.gap)
    product = contact.obstacle.triangles()
    figure = new_figure(_SIZE)
    panels = figure.subplots(1, len(_PANELS))
    for ax, (title, sight, with_product) in zip(panels, _PANELS, strict=True):
        view = View.along(_mirrored(grasp, sight) @ palm[:3, :3].T, palm[:3, 1])
        points, corners, values, colored = vertices, faces, pressure * KPA, inside
        base = np.broadcast_to(SKIN, vertices.shape)
        if with_product and product is not None:
            count = len(product[0])
            points, corners = (
                np.vstack([vertices, product[0]]),
                np.vstack([faces, product[1] + len(vertices)]),
            )
            values, colored = np.append(values, np.zeros(count)), np.append(inside, np.zeros(count))
            base = np.vstack([base, np.broadcast_to(_rgb(PRODUCT), (count, 3))])
        window = window_around(view.project(points) * MM)
        picture = lit_skin(
            points * MM, corners, view, values, colored, pressure_colors(), window, _PIXELS, base=base
        )
        ax.imshow(picture, extent=window, interpolation="antialiased")
        ax.set_axis_off()
        ax.set_title(title)
        scale_bar(ax, window)
    if pressure.max(initial=0.0) > 0.0:
        color_bar(panels[-1], pressure_colors(), float(pressure.max()) * KPA, "pressure (kPa)")
    return figure


def _mirrored(grasp: Grasp, sight: tuple[float, float, float]) -> Floats:
    """Return the sight on a left hand, whose thumb is on the other side."""
    x, y, z = sight
    return np.array([x if grasp.posed.hand.side == "right" else -x, y, z])


def _rgb(color: str) -> Floats:
    return np.array([int(color[at : at + 2], 16) / 255.0 for at in (1, 3, 5)])
