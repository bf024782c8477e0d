"""Pictures of a hand without a product."""

from __future__ import annotations

import colorsys
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from .._check import as_kind, short
from ..errors import HandError
from ..hand import PosedHand
from .shading import lit_skin
from .style import new_figure, pressure_colors
from .view import View

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .._arrays import Floats

__all__ = ["hand_figure"]

_SIGHTS = {"palm": (0.0, 0.0, -1.0), "back": (0.0, 0.0, 1.0), "aslant": (-0.55, -0.25, -1.0)}
_HEIGHT = 420  # pixels of each picture
_MARGIN = 0.02  # around each hand, over its length
_INCHES = 4.2  # height of each picture


def hand_figure(
    hand: PosedHand, *, views: Sequence[str] = ("palm", "back", "aslant"), regions: bool = False
) -> Figure:
    """Return a picture of a posed hand (extra `plot`).

    Parameters
    ----------
    hand : PosedHand
        The hand.
    views : sequence of {"palm", "back", "aslant"}
        Sides to look from.
    regions : bool
        Each region of the skin in a color of its own, and dots where the joints are.

    Returns
    -------
    Figure
        One picture a view, all to one scale.

    Raises
    ------
    HandError
        If there is no such view, or none at all; a TypeError if `hand` is not posed, or `views` no sequence.
    MissingExtraError
        If matplotlib is not installed.
    """
    as_kind("hand", hand, PosedHand, "hand.posed(pose) makes one of a Hand")
    views = _known(views)
    palm, skin = hand.palm, hand.surface
    margin = _MARGIN * hand.hand.length
    drawn = []
    for name in views:
        view = View.along(palm[:3, :3] @ np.array(_SIGHTS[name]), palm[:3, 1])
        places = view.project(skin.vertices)
        (left, low), (right, high) = places[:, :2].min(axis=0) - margin, places[:, :2].max(axis=0) + margin
        drawn.append((name, view, (left, right, low, high)))
    lowest, highest = min(one[2][2] for one in drawn), max(one[2][3] for one in drawn)
    widths = [window[1] - window[0] for _, _, window in drawn]
    scale = _INCHES / (highest - lowest)
    figure = new_figure((scale * sum(widths), _INCHES + 0.3))
    axes = figure.subplots(1, len(drawn), width_ratios=widths, squeeze=False)[0]
    nothing = np.zeros(len(skin.vertices))
    base = _color_of_each(hand.labels) if regions else None
    for ax, (name, view, (left, right, _, _)) in zip(axes, drawn, strict=True):
        window = (left, right, lowest, highest)
        picture = lit_skin(
            skin.vertices, skin.faces, view, nothing, nothing, pressure_colors(), window, _HEIGHT, base=base
        )
        ax.imshow(picture, extent=window)
        if regions:
            joints = view.project(hand.joints[:, :3, 3])
            ax.plot(joints[:, 0], joints[:, 1], "o", color="black", markersize=3.0)
            ax.axis(window)
        ax.set_title(name)
        ax.axis("off")
    return figure


def _known(views: Sequence[str]) -> list[str]:
    """Return the names of views, one or more."""
    names = ", ".join(_SIGHTS)
    if isinstance(views, str) or not isinstance(views, Iterable):
        raise TypeError(f"views is {short(views)}, expected a sequence of some of {names}")
    listed = list(views)
    if not listed:
        raise HandError(f"views is empty, expected some of {names}")
    unknown = [view for view in listed if not isinstance(view, str) or view not in _SIGHTS]
    if unknown:
        raise HandError(f"views holds {short(unknown[0])}, expected some of {names}")
    return listed


def _color_of_each(labels: NDArray[np.str_]) -> Floats:
    """Return colors (n, 3) by label, far apart for labels that follow each other, and none twice."""
    names, of_vertex = np.unique(labels, return_inverse=True)
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    tones = ((0.45, 0.95), (0.75, 0.8), (0.3, 0.7))  # saturation and value
    colors = np.array(
        [colorsys.hsv_to_rgb(golden * at % 1.0, *tones[at % len(tones)]) for at in range(len(names))]
    )
    return colors[of_vertex]
