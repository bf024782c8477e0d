"""Parts of the pictures in `plot`: light, colours, scale and colour bars, cuts through a mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ..errors import MissingExtraError
from .raster import Floats, Indices, View, rasterise

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
SKIN = np.array([0.930, 0.780, 0.695])
SAMPLES = 2  # drawn pixels per shown pixel, along each side


def new_figure(size: tuple[float, float]) -> Figure:
    """A white figure of `size` (inches) that opens no window."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError("pictures need matplotlib: pip install 'quasirigid[plot]'") from error
    figure = Figure(figsize=size, dpi=150, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def axes_or_new(ax: Axes | None, size: tuple[float, float]) -> Axes:
    """The given axes, or those of a new figure."""
    return new_figure(size).subplots() if ax is None else ax


def pressure_colours() -> Colormap:
    """From pale to dark, perceptually even; pale joins the colour of the skin."""
    return _part_of("magma_r", 0.06, 0.84)


def overlap_colours() -> Colormap:
    """For depths: told apart from pressures at a glance."""
    return _part_of("GnBu", 0.12, 1.0)


def _part_of(name: str, low: float, high: float) -> Colormap:
    import matplotlib
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list(
        name + "_part", matplotlib.colormaps[name](np.linspace(low, high, 256))
    )


def window_around(projected: Floats, margin: float = 0.06) -> Window:
    """The picture's frame around projected points (n, 3)."""
    low, high = projected[:, :2].min(axis=0), projected[:, :2].max(axis=0)
    rim = margin * float((high - low).max())
    return float(low[0]) - rim, float(high[0]) + rim, float(low[1]) - 1.6 * rim, float(high[1]) + rim


def lit_skin(
    vertices: Floats,
    faces: Indices,
    view: View,
    values: Floats,
    inside: Floats,
    colours: Colormap,
    window: Window,
    height: int,
) -> Floats:
    """Picture (height, width, 4) of the skin under two lights, in colour where `inside` (n,) is above 0.

    `values` (n,) pick the colour, from 0 to their largest; `window` is in the unit of `vertices`.
    """
    width = max(1, round(height * (window[1] - window[0]) / (window[3] - window[2])))
    frame = rasterise(view.project(vertices), faces, window, width * SAMPLES, height * SAMPLES)
    normals = frame.interpolate(faces, view.project(vertex_normals(vertices, faces)))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    # Along a sharp rim the mean of both sides is neither: such faces are lit flat.
    flat = view.project(face_normals(vertices, faces))[frame.face]
    flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-12)
    normals = np.where(((normals * flat).sum(axis=1) < 0.8)[:, None], flat, normals)
    brightness = (
        0.36 + 0.56 * _lambert(normals, (-0.50, 0.55, 0.67)) + 0.22 * _lambert(normals, (0.75, -0.10, 0.65))
    )
    shine = 0.09 * _lambert(normals, (-0.27, 0.30, 0.915)) ** 40

    largest = float(values.max()) if values.max() > 0.0 else 1.0
    share = np.clip(frame.interpolate(faces, values) / largest, 0.0, 1.0)
    # Colours stay close to those of the colour bar: a part of the shading only, no shine.
    mapped = colours(share)[:, :3] * np.clip(0.66 + 0.36 * brightness, 0.0, 1.03)[:, None]
    coloured = frame.interpolate(faces, inside) > 0.0
    colour = np.where(coloured[:, None], mapped, SKIN * brightness[:, None] + shine[:, None])
    picture = np.zeros((height * width * SAMPLES**2, 4))
    picture[frame.pixel, :3] = np.clip(colour, 0.0, 1.0)
    picture[frame.pixel, 3] = 1.0
    # Average of the drawn pixels, the colour over the covered ones only so that rims do not darken.
    summed = picture.reshape(height, SAMPLES, width, SAMPLES, 4).sum(axis=(1, 3))
    summed[..., :3] /= np.maximum(summed[..., 3:], 1.0)
    summed[..., 3] /= SAMPLES**2
    averaged: Floats = summed
    return averaged


def _lambert(normals: Floats, light: tuple[float, float, float]) -> Floats:
    direction = np.asarray(light) / np.linalg.norm(light)
    brightness: Floats = np.clip(normals @ direction, 0.0, 1.0)
    return brightness


def contact_side(vertices: Floats, faces: Indices, pressure: Floats, gap: Floats) -> Floats:
    """A field (n,) in m that is above 0 inside the contact and crosses 0 at its rim.

    Near the rim of a smooth contact the pressure grows as the square root of the distance from it inside, and
    the gap as its 3/2 power outside (Johnson 1985, sections 4.2 and 5.1), so p^2 and g^(2/3) both grow as the
    distance itself. Their two factors come from a least-squares fit over the edges that the rim crosses.
    """
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = edges[(pressure[edges[:, 0]] > 0.0) & ~(pressure[edges[:, 1]] > 0.0)]
    squared = np.maximum(pressure, 0.0) ** 2
    opened = np.where(np.isfinite(gap), np.maximum(gap, 0.0), 0.0) ** (2.0 / 3.0)
    if len(edges) == 0 or not squared.any():
        return np.where(pressure > 0.0, 1.0, -1.0)
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    terms = np.stack([squared[edges[:, 0]], opened[edges[:, 1]]], axis=1)
    scale = np.maximum(terms.mean(axis=0), np.finfo(float).tiny)
    factors = np.linalg.lstsq(terms / scale, lengths, rcond=None)[0] / scale
    # A fit without sense (a flat punch, say) falls back to equal shares of the edges.
    half = 0.5 * lengths.mean() / scale
    factors = np.where(factors > 0.05 * half, factors, half)
    far = float(lengths.mean())
    outside = np.where(np.isfinite(gap), np.minimum(factors[1] * opened, far), far)
    side: Floats = np.where(pressure > 0.0, np.minimum(factors[0] * squared, far), -outside)
    return side


def face_normals(vertices: Floats, faces: Indices) -> Floats:
    """Normals (m, 3) of the faces, as long as twice their area."""
    corners = vertices[faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def vertex_normals(vertices: Floats, faces: Indices) -> Floats:
    """Sums (n, 3) of the face normals around each vertex, not normalised."""
    summed = np.zeros_like(vertices)
    normals = face_normals(vertices, faces)
    for corner in range(3):
        np.add.at(summed, faces[:, corner], normals)
    return summed


def scale_bar(ax: Axes, window: Window) -> None:
    """A bar of a round number of mm in the lower left corner; axes are in mm."""
    width, height = window[1] - window[0], window[3] - window[2]
    length = max((step for step in (0.5, 1, 2, 5, 10, 20, 50, 100) if step <= 0.42 * width), default=0.5)
    left, bottom = window[0] + 0.03 * width, window[2] + 0.03 * height
    ax.plot(
        [left, left + length], [bottom, bottom], color=INK, linewidth=2.2, solid_capstyle="butt", zorder=6
    )
    ax.annotate(
        f"{length:g} mm", (left + length / 2, bottom), xytext=(0, 4), textcoords="offset points", ha="center",
        va="bottom", fontsize=8.5, color=INK, zorder=6,
    )  # fmt: skip


def colour_bar(ax: Axes, colours: Colormap, largest: float, label: str, *, beside: bool = False) -> None:
    """A colour bar from 0 to `largest`, under the picture or beside it, its label with the unit."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    figure = ax.get_figure()
    assert figure is not None, "axes that are drawn on belong to a figure"
    bar = figure.colorbar(
        ScalarMappable(Normalize(0.0, largest), colours),
        ax=ax,
        location="right" if beside else "bottom",
        shrink=0.78,
        aspect=28,
        pad=0.03,
    )
    bar.set_label(label, fontsize=9, color=INK)
    bar.ax.tick_params(labelsize=8.5, colors=INK, length=3)
    outline: Any = bar.outline
    outline.set_visible(False)


def cut_lines(faces: Indices, offset: Floats, plane: Floats) -> Floats:
    """Where a plane cuts a mesh.

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


def joined(segments: Floats) -> Floats:
    """Segments (k, 2, 2) strung to lines (j, 2), nan between two lines.

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


def round_steps(largest: float) -> Floats:
    """Four to eight round levels between 0 and `largest`."""
    raw = largest / 5.0
    power = 10.0 ** np.floor(np.log10(raw))
    step = power * min((1.0, 2.0, 2.5, 5.0, 10.0), key=lambda factor: abs(factor * power - raw))
    return np.arange(step, largest, step)
