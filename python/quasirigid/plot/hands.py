"""Pictures of a hand without a product."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .shading import lit_skin
from .style import new_figure, pressure_colours
from .view import View

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from ..hand import PosedHand

__all__ = ["hand_figure"]

_SIGHTS = {"palm": (0.0, 0.0, -1.0), "back": (0.0, 0.0, 1.0), "aslant": (-0.55, -0.25, -1.0)}
_HEIGHT = 420  # pixels of each picture
_MARGIN = 0.02  # around each hand, over its length
_INCHES = 4.2  # height of each picture


def hand_figure(hand: PosedHand, *, views: Sequence[str] = ("palm", "back", "aslant")) -> Figure:
    """Return a picture of a posed hand (extra `plot`).

    Parameters
    ----------
    hand : PosedHand
        The hand.
    views : sequence of {"palm", "back", "aslant"}
        Sides to look from.

    Returns
    -------
    Figure
        One picture a view, all to one scale.
    """
    unknown = [view for view in views if view not in _SIGHTS]
    if unknown:
        raise ValueError(f"views holds {unknown[0]!r}, expected some of {', '.join(_SIGHTS)}")
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
    for ax, (name, view, (left, right, _, _)) in zip(axes, drawn, strict=True):
        window = (left, right, lowest, highest)
        picture = lit_skin(
            skin.vertices, skin.faces, view, nothing, nothing, pressure_colours(), window, _HEIGHT
        )
        ax.imshow(picture)
        ax.set_title(name)
        ax.axis("off")
    return figure
