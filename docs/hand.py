"""Draw docs/hand.png: the built-in hand from the palm, the back and aslant, and in two poses."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
import quasirigid as qr
from quasirigid.plot.shading import lit_skin
from quasirigid.plot.view import View

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HEIGHT = 420  # pixels of each picture
MARGIN = 4e-3  # around each hand (m)


def main() -> None:
    """Build, pose, draw."""
    hand = qr.models.hand(edge_length=1.4e-3)
    up = np.array([0.0, 1.0, 0.0])
    shown = [
        ("palm", hand.surface, (0.0, 0.0, 1.0)),
        ("back", hand.surface, (0.0, 0.0, -1.0)),
        ("aslant", hand.surface, (0.55, -0.25, 1.0)),
        ('posed("cylinder")', hand.posed("cylinder").surface, (0.75, -0.2, 0.8)),
        ('posed("fist")', hand.posed("fist").surface, (0.5, -0.3, 1.0)),
    ]
    views = [View.along(np.array(sight), up) for _, _, sight in shown]
    places = [view.project(skin.vertices) for view, (_, skin, _) in zip(views, shown, strict=True)]
    low = min(place[:, 1].min() for place in places) - MARGIN
    high = max(place[:, 1].max() for place in places) + MARGIN
    windows = [(place[:, 0].min() - MARGIN, place[:, 0].max() + MARGIN, low, high) for place in places]
    widths = [window[1] - window[0] for window in windows]
    inches = 4.2 / (high - low)
    figure, axes = plt.subplots(
        1, len(shown), figsize=(inches * sum(widths), 4.4), width_ratios=widths, layout="constrained"
    )
    for ax, (title, skin, _), view, window in zip(axes, shown, views, windows, strict=True):
        nothing = np.zeros(len(skin.vertices))
        picture = lit_skin(skin.vertices, skin.faces, view, nothing, nothing, plt.cm.viridis, window, HEIGHT)
        ax.imshow(picture)
        ax.set_title(title, fontsize=9)
        ax.axis("off")
    figure.savefig(Path(__file__).with_suffix(".png"), dpi=100)


if __name__ == "__main__":
    main()
