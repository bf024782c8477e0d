"""Curves over the steps of a sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._check import as_kind
from .._units import MM
from ..contact.swept import Sweep
from .style import AFTER, BEFORE, INK, label_axes, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["sweep_figure"]


def sweep_figure(sweep: Sweep) -> Figure:
    """Return a figure of force and contact area over the depth of a sweep.

    Parameters
    ----------
    sweep : Sweep
        What to draw; steps without figures are left out, and the title counts them.

    Returns
    -------
    matplotlib.figure.Figure
        Depths in mm, forces in N, areas in mm²; bars show the estimated errors that are finite.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    as_kind("sweep", sweep, Sweep, "qr.sweep returns one")
    figure = new_figure((9.0, 4.0))
    curves = (
        ("force along the press (N)", sweep.normal_force, sweep.force_error, AFTER),
        ("contact area (mm²)", sweep.contact_area * MM**2, sweep.area_error, BEFORE),
    )
    good = np.flatnonzero(np.isfinite(sweep.normal_force) & np.isfinite(sweep.depth))
    if missing := len(sweep) - len(good):
        title = f"{missing} of {len(sweep)} steps without figures are not drawn"
        figure.suptitle(title, fontsize=11, color=INK, x=0.02, ha="left")
    order = good[np.argsort(sweep.depth[good], kind="stable")]
    for ax, (label, values, errors, color) in zip(figure.subplots(1, 2), curves, strict=True):
        bars = np.nan_to_num(errors[order], posinf=0.0) * np.abs(values[order])
        ax.errorbar(
            sweep.depth[order] * MM, values[order], bars, color=color, marker="o", markersize=4, capsize=2
        )
        ax.set_xlim(left=0.0)
        ax.set_ylim(bottom=0.0)
        label_axes(ax, "depth (mm)", label)
    return figure
