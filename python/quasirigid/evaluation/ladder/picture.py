"""Error against time, with the knee marked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ...plot.style import AFTER, BEFORE, FAINT, INK, label_axes, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["accuracy_figure"]

Row = Mapping[str, Any]
_FIGURES = {"force_error": "error of the force (%)", "area_error": "error of the area (%)"}


def accuracy_figure(rows: Sequence[Row]) -> Figure:
    """Return a figure of the sphere's errors of force and area over the time of a contact.

    Parameters
    ----------
    rows : sequence of dict
        Of a table of `accuracy`.

    Returns
    -------
    matplotlib.figure.Figure
        Times in ms, errors in percent; a ring marks the knee.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    figure = new_figure((9.0, 3.8))
    curves: dict[str, list[Row]] = {}
    for row in rows:
        if row["scene"] == "sphere" and row["force_error"] is not None:
            curves.setdefault(_label(row), []).append(row)
    for ax, (error, label) in zip(figure.subplots(1, 2, sharex=True), _FIGURES.items(), strict=True):
        _draw(ax, curves, error)
        label_axes(ax, "time of a contact (ms)", label)
        if error == "force_error":
            ax.legend(frameon=False, fontsize=7.5)
    return figure


def _draw(ax: Axes, curves: Mapping[str, Sequence[Row]], error: str) -> None:
    colors = {"refined": AFTER, "collocation": INK, "galerkin": BEFORE}
    for (label, rows), marker in zip(curves.items(), "os^Dv<>", strict=False):
        color = next((value for key, value in colors.items() if key in label), FAINT)
        ax.loglog(
            [1e3 * row["seconds"] for row in rows],
            [100 * abs(row[error]) for row in rows],
            marker=marker,
            color=color,
            label=label,
            linestyle="--" if label.startswith("tamaas") else "-",
            linewidth=2.2 if label == "refined, collocation" else 1.2,
            markersize=4,
        )
        for row in rows:
            if row["knee"]:
                at = (1e3 * row["seconds"], 100 * abs(row[error]))
                ax.plot(*at, "o", markersize=12, markerfacecolor="none", markeredgecolor=INK)
                ax.annotate("knee", at, xytext=(-34, -12), textcoords="offset points", fontsize=8, color=INK)


def _label(row: Row) -> str:
    if str(row["response"]).startswith("tamaas"):
        return str(row["response"])
    mesh = "refined" if row["mesh"] == "refined" else "as it is"
    return f"{mesh}, {row['discretization']}"
