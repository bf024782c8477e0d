"""The cut through a contact, along the finger."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._units import MM
from ..scene import as_surface
from .style import AFTER, BEFORE, BONE, INK, PRODUCT, PRODUCT_EDGE, axes_or_new, scale_bar
from .view import View, largest_patch, view_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._arrays import Floats, Indices
    from ..contact.result import Contact
    from ..obstacle import Obstacle
    from ..surface import Surface
    from .style import Window

__all__ = ["cut_lines", "plot_section", "polylines"]

_REACH = 2.0  # of a cut beside the contact, over the skin's thickness there and the contact's width


def plot_section(
    contact: Contact,
    *,
    bone: Surface | None = None,
    ax: Axes | None = None,
    view: View | None = None,
) -> Axes:
    """Draw a cut through the contact, along the finger: skin before and after, and the product.

    It goes through the center of pressure, of several patches that of the one with the largest force. Of a
    long skin it shows what lies within twice its thickness there, or twice the width of that patch.

    A product with a material is filled as it was before, with a line where its mesh lies after.

    Parameters
    ----------
    contact : Contact
        What to draw.
    bone : Surface, optional
        Bones inside the skin, to be drawn in the cut too.
    ax : Axes, optional
        Where to draw; a new figure when left out.
    view : View, optional
        The view whose `up` and `toward` span the cut; `pad_view` when left out. The product is drawn below.

    Returns
    -------
    matplotlib.axes.Axes
        `ax`, in mm.
    """
    if bone is not None:
        as_surface("bone", bone)
    view = view_of(contact, view)
    ax = axes_or_new(ax, (4.4, 6.0))
    before, after = contact.surface.vertices, contact.deformed.vertices
    patch = largest_patch(contact) if contact.patches else None
    center = after.mean(axis=0) if patch is None else patch.center_of_pressure
    cuts = [_cut(points, contact.deformed.faces, center, view) for points in (before, after)]
    drawn = cuts[1].reshape(-1, 2) if len(cuts[1]) > 0 else _flat(after, view)
    middle = _flat(center[None], view)[0]
    reach = np.inf
    if patch is not None:
        loaded = float(np.ptp(_flat(after[patch.vertices], view), axis=0).max())
        reach = _REACH * max(_thickness(cuts[0], middle), loaded)
    window = _section_window(drawn, middle, reach)
    _draw_product(ax, contact.obstacle, center, view, window)
    if bone is not None:
        _draw_bone(ax, _cut(bone.vertices, bone.faces, center, view))
    styles = [(BEFORE, 1.1, (0, (3.5, 2.0)), "skin before"), (AFTER, 2.0, "solid", "skin after")]
    for segments, (color, thickness, dashes, name) in zip(cuts, styles, strict=True):
        _draw_cut(ax, segments, color, thickness, dashes, name)
    moved = contact.obstacle.material is not None
    ax.fill_between([], [], color=PRODUCT, label="product before" if moved else "product")
    if moved and contact.deformed_obstacle is not None:
        mesh = contact.deformed_obstacle
        cut = _cut(mesh.vertices, mesh.faces, center, view)
        _draw_cut(ax, cut, PRODUCT_EDGE, 1.6, "solid", "product after")
    ax.set_xlim(window[0], window[1])
    ax.set_ylim(window[2], window[3])
    ax.set_aspect("equal")
    ax.set_axis_off()
    scale_bar(ax, window)
    columns = 4 if bone is not None and not moved else 3
    ax.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=columns, frameon=False,
        fontsize=8.5, labelcolor=INK, handlelength=1.8, columnspacing=1.4,
    )  # fmt: skip
    return ax


def _draw_product(ax: Axes, obstacle: Obstacle, center: Floats, view: View, window: Window) -> None:
    """Fill every point of the cut inside the product."""
    along, away = np.linspace(window[0], window[1], 420), np.linspace(window[2], window[3], 300)
    grid_along, grid_away = np.meshgrid(along, away)
    points = (
        grid_along.ravel()[:, None] / MM * view.up
        - grid_away.ravel()[:, None] / MM * view.toward
        + np.dot(center, view.right) * view.right
    )
    distance = obstacle.signed_distance(points)[0].reshape(grid_along.shape)
    ax.contourf(along, away, distance, levels=[-np.inf, 0.0], colors=[PRODUCT])
    ax.contour(along, away, distance, levels=[0.0], colors=[PRODUCT_EDGE], linewidths=1.0)


def _draw_bone(ax: Axes, segments: Floats) -> None:
    outlines = polylines(segments)
    ends = np.flatnonzero(np.isnan(outlines[:, 0]))
    for first, last in zip([0, *(ends[:-1] + 1)], ends, strict=True):
        ax.fill(*outlines[first:last].T, color=BONE, zorder=2)
    ax.fill_between([], [], color=BONE, label="bone")


def _cut(vertices: Floats, faces: Indices, center: Floats, view: View) -> Floats:
    """Return segments (k, 2, 2) in mm of a mesh, cut through `center` square to the view's `right`."""
    return cut_lines(faces, (vertices - center) @ view.right, _flat(vertices, view))


def _flat(points: Floats, view: View) -> Floats:
    """Return points (n, 2) in mm: along the finger, and away from the viewer."""
    projected = view.project(points) * MM
    return np.stack([projected[:, 1], -projected[:, 2]], axis=1)


def _thickness(cut: Floats, middle: Floats) -> float:
    """Return how far the two sides of the skin beside `middle` lie apart (mm); 0 of a sheet."""
    first, second = cut[:, 0, 0] > middle[0], cut[:, 1, 0] > middle[0]
    sides = cut[first != second].mean(axis=1)[:, 1]
    nearest = sides[np.argsort(np.abs(sides - middle[1]))[:2]]
    return float(np.ptp(nearest)) if len(nearest) == 2 else 0.0


def _section_window(points: Floats, middle: Floats, reach: float) -> Window:
    """Return the window (mm) of the points of a cut within `reach` of `middle`, moved to them if need be."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle = np.clip(middle, low, high)
    low, high = np.maximum(low, middle - reach), np.minimum(high, middle + reach)
    rim = 0.08 * float((high - low).max())
    return float(low[0]) - rim, float(high[0]) + rim, float(low[1]) - 3.0 * rim, float(high[1]) + 2.0 * rim


def _draw_cut(ax: Axes, segments: Floats, color: str, thickness: float, dashes: Any, name: str) -> None:
    # Joined by nan, so that dashes run on along the line and not anew in each triangle.
    line = polylines(segments)
    ax.plot(line[:, 0], line[:, 1], color=color, linewidth=thickness, linestyle=dashes, label=name, zorder=3)


def cut_lines(faces: Indices, offset: Floats, plane: Floats) -> Floats:
    """Return the segments in which a plane cuts a mesh.

    Parameters
    ----------
    faces : (m, 3) int64
        Triangles.
    offset : (n,) float64
        Signed distance of each vertex from the cutting plane.
    plane : (n, 2) float64
        Each vertex in the coordinates in which the lines are wanted.

    Returns
    -------
    (k, 2, 2) float64
        One segment for each triangle that is cut.
    """
    above = offset > 0.0
    cut = faces[above[faces].sum(axis=1) % 3 != 0]
    # Turn each triangle until its first corner is the one alone on its side.
    side = above[cut]
    alone = np.where(side[:, 1] == side[:, 2], 0, np.where(side[:, 0] == side[:, 2], 1, 2))
    rows = np.arange(len(cut))
    first = cut[rows, alone]
    ends = []
    for step in (1, 2):
        other = cut[rows, (alone + step) % 3]
        share = (offset[first] / (offset[first] - offset[other]))[:, None]
        ends.append(plane[first] + share * (plane[other] - plane[first]))
    return np.stack(ends, axis=1)


def polylines(segments: Floats) -> Floats:
    """Return segments (k, 2, 2) strung to lines (j, 2), nan between two lines.

    Ends are matched by their place, rounded to a millionth of the extent.
    """
    if len(segments) == 0:
        return np.full((1, 2), np.nan)
    grain = 1e-6 * float(np.ptp(segments.reshape(-1, 2), axis=0).max() or 1.0)
    keys = [
        [tuple(end) for end in segment] for segment in np.round(segments / grain).astype(np.int64).tolist()
    ]
    at: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for number, pair in enumerate(keys):
        for end in (0, 1):
            at.setdefault(pair[end], []).append((number, end))
    used = np.zeros(len(segments), dtype=bool)
    lines: list[Floats] = []
    # Lines with a loose end first, from that end, then closed ones from anywhere.
    starts = [uses[0] for uses in at.values() if len(uses) == 1] + [
        (number, 0) for number in range(len(segments))
    ]
    for start, start_end in starts:
        number, end = start, start_end
        if used[number]:
            continue
        line = [segments[number, end]]
        while True:
            used[number] = True
            line.append(segments[number, 1 - end])
            following = [use for use in at[keys[number][1 - end]] if not used[use[0]]]
            if not following:
                break
            number, end = following[0]
        lines.append(np.array([*line, [np.nan, np.nan]]))
    return np.concatenate(lines)
