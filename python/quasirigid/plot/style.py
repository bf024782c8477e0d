"""What all pictures share: figures, colors, frames, scale and color bars."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from .._arrays import Floats
from .._check import as_kind, kind_of
from .._extras import need_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

Window: TypeAlias = tuple[float, float, float, float]  # left, right, bottom, top (mm)

INK = "#23262b"
FAINT = "#8a8f98"
BEFORE = "#8a8f98"
AFTER = "#b4533c"
BONE = "#e8dcc4"
PRODUCT = "#ccd1d9"
PRODUCT_EDGE = "#7d8590"
_MARGIN = 0.06  # around what is drawn, over its longer side


def new_figure(size: tuple[float, float]) -> Figure:
    """Return a white figure of `size` (inches) that opens no window."""
    need_matplotlib()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, dpi=150, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def axes_or_new(ax: Axes | None, size: tuple[float, float]) -> Axes:
    """Return the given axes, or those of a new figure; a TypeError of what are no flat axes."""
    if ax is None:
        return new_figure(size).subplots()
    need_matplotlib()
    from matplotlib.axes import Axes

    remedy = "plt.subplots() makes a figure and one"
    if as_kind("ax", ax, Axes, remedy).name != "rectilinear":
        raise TypeError(f"ax is {kind_of(ax)} of projection {ax.name!r}, expected flat axes: {remedy}")
    return ax


def pressure_colors() -> Colormap:
    """Return colors from pale to dark, perceptually even; pale joins the color of the skin."""
    return _color_range("magma_r", 0.06, 0.84)


def overlap_colors() -> Colormap:
    """Return colors for depths, which nobody takes for pressures."""
    return _color_range("GnBu", 0.12, 1.0)


def _color_range(name: str, low: float, high: float) -> Colormap:
    import matplotlib
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list(
        name + "_part", matplotlib.colormaps[name](np.linspace(low, high, 256))
    )


def window_around(projected: Floats) -> Window:
    """Return the picture's frame around projected points (n, 3)."""
    low, high = projected[:, :2].min(axis=0), projected[:, :2].max(axis=0)
    rim = _MARGIN * float((high - low).max())
    return float(low[0]) - rim, float(high[0]) + rim, float(low[1]) - 1.6 * rim, float(high[1]) + rim


def scale_bar(ax: Axes, window: Window) -> None:
    """Draw a bar of a round number of mm in the lower left corner of axes in mm; these stay as they are."""
    width, height = window[1] - window[0], window[3] - window[2]
    power = 10.0 ** np.floor(np.log10(0.42 * width))
    length = max(step * power for step in (1, 2, 5) if step * power <= 0.42 * width * (1 + 1e-12))
    left, bottom = window[0] + 0.03 * width, window[2] + 0.03 * height
    ax.plot(
        [left, left + length], [bottom, bottom], color=INK, linewidth=2.2, solid_capstyle="butt", zorder=6,
        scalex=False, scaley=False,
    )  # fmt: skip
    ax.annotate(
        f"{length:g} mm", (left + length / 2, bottom), xytext=(0, 4), textcoords="offset points", ha="center",
        va="bottom", fontsize=8.5, color=INK, zorder=6,
    )  # fmt: skip


def color_bar(
    ax: Axes | list[Axes], colors: Colormap, largest: float, label: str, *, beside: bool = False
) -> None:
    """Draw a color bar from 0 to `largest`, under the picture or beside one or a column, and its label."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    column = ax if isinstance(ax, list) else [ax]
    figure = column[0].get_figure()
    assert figure is not None, "axes that are drawn on belong to a figure"
    bar = figure.colorbar(
        ScalarMappable(Normalize(0.0, largest), colors),
        ax=column,
        location="right" if beside else "bottom",
        shrink=0.78,
        aspect=28 * len(column),
        pad=0.03,
    )
    bar.set_label(label, fontsize=9, color=INK)
    bar.ax.tick_params(labelsize=8.5, colors=INK, length=3)
    plain_numbers(bar.ax)
    outline: Any = bar.outline
    outline.set_visible(False)


def label_axes(ax: Axes, across: str, up: str) -> None:
    """Name the axes, without the frame above and to the right."""
    ax.set_xlabel(across, color=INK)
    ax.set_ylabel(up, color=INK)
    ax.tick_params(colors=INK)
    ax.spines[["top", "right"]].set_visible(False)
    plain_numbers(ax)


def plain_numbers(ax: Axes) -> None:
    """Write each number in full, as in 2e-10: a power of ten apart would lie on the axis' label."""
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter("{x:g}")


def round_steps(largest: float) -> Floats:
    """Return four to eight round levels between 0 and `largest`."""
    raw = largest / 5.0
    power = 10.0 ** np.floor(np.log10(raw))
    step = power * min((1.0, 2.0, 2.5, 5.0, 10.0), key=lambda factor: abs(factor * power - raw))
    return np.arange(step, largest, step)
