"""Pictures of a hand that holds a product."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from .._check import as_kind
from .._units import KPA, MM
from ..contact.ending import ContactStatus
from ..hand import Grasp
from ..models.loft import joined
from .figures import headline
from .outline import contact_side
from .shading import SKIN, lit_skin
from .style import INK, PRODUCT, color_bar, new_figure, pressure_colors, scale_bar, window_around
from .view import View

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .._arrays import Floats, Indices
    from .style import Window

__all__ = ["grasp_figure"]

_THUMB_SIDE = (-0.85, 0.15, -0.55)
_FINGER_SIDE = (0.35, -0.75, -0.55)
_PALM_SIDE = (0.0, 0.6, -0.8)
# Panels with the product: title, and the line of sight in the palm's frame.
_HELD = (("from the thumb's side", _THUMB_SIDE), ("from the fingertips", _FINGER_SIDE))
_SIZE = (15.0, 5.2)  # inches
_PIXELS = 560  # height of a panel
_AROUND = 0.5  # of a product shown beyond the hand on each side, over the hand's longer side
_HIDDEN = 0.75  # share of the hand that a product hides, above which it is drawn translucent
_OPACITY = 0.35  # of such a product


def grasp_figure(grasp: Grasp) -> Figure:
    """Return pictures of a grasp (extra `plot`): hand and product from two sides, and all that is pressed.

    Parameters
    ----------
    grasp : Grasp
        The grasp; any ending can be drawn. A product that is a primitive has no triangles and is not drawn.

    Returns
    -------
    Figure
        The deformed hand with its pressure (kPa). Of a product much larger than the hand the part around the
        hand is shown; one that hides it is translucent.
    """
    as_kind("grasp", grasp, Grasp, "close_hand returns one")
    contact, palm = grasp.contact, np.array(grasp.posed.palm)
    vertices, faces = contact.deformed.vertices, contact.deformed.faces
    pressure = np.nan_to_num(contact.pressure)
    inside = contact_side(vertices, faces, pressure, contact.gap)
    product = contact.obstacle.triangles()
    figure = new_figure(_SIZE)
    held = [(title, _mirrored(grasp, sight) @ palm[:3, :3].T, True) for title, sight in _HELD]
    views = held + [(title, sight, False) for title, sight in _pressed_sights(grasp)]
    panels = figure.subplots(1, len(views))
    for ax, (title, sight, with_product) in zip(panels, views, strict=True):
        view = View.along(sight, palm[:3, 1])
        window = window_around(view.project(vertices) * MM)
        shown = product if with_product else None
        if shown is not None:
            window = _around(window, window_around(view.project(np.vstack([vertices, shown[0]])) * MM))
        draw = partial(_picture, vertices, faces, view, pressure * KPA, inside, window)
        picture = draw(None) if shown is None else _see_through(draw(None), draw(shown))
        ax.imshow(picture, extent=window, interpolation="antialiased")
        ax.set_axis_off()
        ax.set_title(title)
        scale_bar(ax, window)
    if pressure.max(initial=0.0) > 0.0:
        color_bar(panels[-1], pressure_colors(), float(pressure.max()) * KPA, "pressure (kPa)")
    if contact.status not in (ContactStatus.SOLVED, ContactStatus.NO_CONTACT):
        figure.suptitle(headline(contact), fontsize=13, color=INK, x=0.02, ha="left", weight="bold")
    return figure


def _around(hand: Window, whole: Window) -> Window:
    """Return the part of the window on hand and product that is not far from the hand."""
    rim = _AROUND * max(hand[1] - hand[0], hand[3] - hand[2])
    return (
        max(hand[0] - rim, whole[0]),
        min(hand[1] + rim, whole[1]),
        max(hand[2] - rim, whole[2]),
        min(hand[3] + rim, whole[3]),
    )


def _picture(
    vertices: Floats,
    faces: Indices,
    view: View,
    values: Floats,
    inside: Floats,
    window: Window,
    product: tuple[Floats, Indices] | None,
) -> Floats:
    """Return the hand, and the product with it, as `lit_skin` does."""
    from matplotlib.colors import to_rgb

    base = np.broadcast_to(SKIN, vertices.shape)
    if product is not None:
        vertices, faces = joined([(vertices, faces), product])
        base = np.vstack([base, np.broadcast_to(to_rgb(PRODUCT), product[0].shape)])
        nothing = np.zeros(len(product[0]))
        values, inside = np.append(values, nothing), np.append(inside, nothing)
    return lit_skin(vertices * MM, faces, view, values, inside, pressure_colors(), window, _PIXELS, base=base)


def _see_through(hand: Floats, both: Floats) -> Floats:
    """Return the picture of hand and product, through the product where it hides most of the hand."""
    is_hand = hand[..., 3] > 0.0
    hidden = is_hand & (np.abs(both - hand).max(axis=2) > 1e-9)
    if hidden.sum() <= _HIDDEN * is_hand.sum():
        return both
    return np.where(hidden[..., None], _OPACITY * both + (1.0 - _OPACITY) * hand, both)


def _pressed_sights(grasp: Grasp) -> list[tuple[str, Floats]]:
    """Return titles, and sights on what is pressed: the fingers from the palm's side, and thumb and palm.

    Between that side and along the force on the fingers, as along it the wrist may stand before them.
    """
    palm = np.array(grasp.posed.palm)[:3, :3]
    from_palm = palm @ _mirrored(grasp, _PALM_SIDE)
    on_fingers = _direction([part.force for name, part in grasp.digits.items() if name != "thumb"])
    on_rest = _direction([grasp.digits["thumb"].force, grasp.palm.force])
    return [
        ("pressure on the fingers", from_palm + on_fingers),
        ("pressure on thumb and palm", on_rest if on_rest.any() else from_palm),
    ]


def _direction(forces: list[Floats]) -> Floats:
    """Return that of the sum of forces, zero of none and of those that are not known."""
    total: Floats = np.nan_to_num(np.sum(forces, axis=0))
    return total / (np.linalg.norm(total) or 1.0)


def _mirrored(grasp: Grasp, sight: tuple[float, float, float]) -> Floats:
    """Return the sight on a left hand, whose thumb is on the other side."""
    x, y, z = sight
    return np.array([x if grasp.posed.hand.side == "right" else -x, y, z])
