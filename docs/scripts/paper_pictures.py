"""The pictures of docs/paper.md."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import quasirigid as qr
from numpy.typing import NDArray
from PIL import Image
from quasirigid.plot import View, plot_footprint, plot_section
from quasirigid.plot.section import cut_lines, polylines
from quasirigid.plot.shading import lit_skin
from quasirigid.plot.style import AFTER, BEFORE, INK, PRODUCT, PRODUCT_EDGE, color_bar, pressure_colors

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

Floats = NDArray[np.float64]
LARGEST = 195_000  # bytes of a picture in full colors
X, Y, Z = np.eye(3)
GREY = LinearSegmentedColormap.from_list("product", ["#aab2bd", "#aab2bd"])
HALF_COLOR = "#2f6f9f"
COLORS = {
    "half-space": HALF_COLOR,
    "Gaussian, balanced": "#5b8c3a",
    "printed constants": "#7a4fa3",
    "body": AFTER,
}
CURVES = {"printed, cut off at 15 mm": "#7a4fa3", "half-space, one-rings": "#8fb8d4"}


def save(figure: Figure, name: str) -> None:
    """Write docs/paper_<name>.png."""
    target, drawn = Path(__file__).parents[1] / f"paper_{name}.png", BytesIO()
    figure.savefig(drawn, dpi=100)
    plt.close(figure)
    picture = Image.open(drawn).convert("RGB")
    if drawn.getbuffer().nbytes > LARGEST:
        picture = picture.quantize(256, dither=Image.Dither.NONE)
    picture.save(target, optimize=True)


def draw_kernels(k: float, height: float, width: float, cutoff: float) -> dict[str, str]:
    """Draw the paper's kernel and its symbol; return the wavelengths (mm) at which the symbol is negative."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4), layout="constrained")
    r = np.linspace(0.8e-3, 20e-3, 600)
    f, g = k / r, height * np.exp(-(r**2) / (2 * width**2))
    left.plot(r * 1e3, f * 1e3, color=HALF_COLOR, label="f, half-space")
    left.plot(r * 1e3, g * 1e3, color=BEFORE, linestyle="--", label="g, Gaussian")
    left.plot(r * 1e3, (f - g) * 1e3, color=AFTER, linewidth=2.0, label="f - g")
    left.axhline(0.0, color=INK, linewidth=0.6)
    left.axvline(cutoff * 1e3, color=BEFORE, linewidth=0.8, linestyle=":")
    left.set(xlabel="distance (mm)", ylabel="displacement (mm/N)", xlim=(0, 20), ylim=(-0.6, 1.4))
    left.legend(frameon=False)
    wave = np.geomspace(4e-3, 150e-3, 700)
    number = 2 * np.pi / wave
    s = (np.arange(3000) + 0.5) / 3000 * cutoff
    # J0(x) is the mean of cos(x sin t).
    turn = np.sin((np.arange(64) + 0.5) * np.pi / 64)
    bessel = np.array([np.cos(n * s[:, None] * turn).mean(axis=1) for n in number])
    cut = 2 * np.pi * bessel @ (k - height * s * np.exp(-(s**2) / (2 * width**2))) * (cutoff / 3000)
    endless = 2 * np.pi * (k / number - height * width**2 * np.exp(-((number * width) ** 2) / 2))
    bands = {}
    for name, symbol, color in (("cut off", cut, AFTER), ("no cutoff", endless, HALF_COLOR)):
        right.semilogx(wave * 1e3, symbol * number / (2 * np.pi * k), color=color, label=name)
        ends = wave[np.flatnonzero(np.diff(symbol < 0.0))] * 1e3
        bands[name] = " to ".join(f"{end:.0f}" for end in ends) if len(ends) > 1 else f"{ends[0]:.0f}"
    right.axhline(0.0, color=INK, linewidth=0.6)
    right.set(
        xlabel="wavelength of the pressure (mm)", ylabel="give, over the half-space's", ylim=(-1.1, 1.5)
    )
    right.set_xticks([5, 10, 20, 50, 100], ["5", "10", "20", "50", "100"])
    right.minorticks_off()
    right.legend(frameon=False)
    plain(left, right)
    save(figure, "kernel")
    return bands


def draw_finger(
    contacts: Mapping[str, qr.Contact], shallow: qr.Contact, direction: Floats, bone: qr.Surface
) -> None:
    """Draw finger and product, the body's cut and pressure, and cuts of all answers close up.

    `contacts` by the name of their response, the body among them; `shallow`: of the printed kernel.
    """
    along, across = View.along(direction, Y), View.along(direction, X)
    body = contacts["body"]
    figure = plt.figure(figsize=(11.0, 6.2), layout="constrained")
    axes = figure.subplot_mosaic(
        [["scene", "cut", "print"], ["along", "across", "shallow"]], height_ratios=[1.2, 1.0]
    )
    draw_scene(axes["scene"], body, View.along(np.array([-0.85, 0.35, -0.25]), Z))
    plot_section(body, bone=bone, ax=axes["cut"], view=along)
    plot_footprint(body, ax=axes["print"], view=along)
    close_up(axes["along"], contacts, along)
    close_up(axes["across"], contacts, across, reach=8.0, label="across (mm)")
    close_up(axes["shallow"], {"printed constants": shallow}, across, reach=8.0, label="across (mm)")
    for name in ("across", "shallow"):
        axes[name].set(xlim=(1.0, 7.4), ylim=(-0.8, 2.2))
    titles = {
        "scene": "finger and product",
        "cut": "cut, body",
        "print": "pressure, body",
        "along": "close up, along the finger",
        "across": "close up, across, one rim",
        "shallow": f"the same, printed constants, {shallow.max_penetration_before * 1e3:.1f} mm",
    }
    for name, title in titles.items():
        axes[name].set_title(title, fontsize=10, color=INK)
    legend(figure, axes["along"], axes["shallow"])
    save(figure, "finger")


def draw_depths(
    name: str,
    steps: Sequence[Mapping[str, qr.Contact]],
    direction: Floats,
    bone: qr.Surface,
    *,
    sight: Floats,
) -> None:
    """Draw a scene and, depth by depth, the body's pressure and the cut of all answers close up."""
    view = View.along(direction, Y)
    cut = View.along(direction, X)
    bodies = [step["body"] for step in steps]
    figure = plt.figure(figsize=(12.0, 5.4), layout="constrained")
    grid = figure.subplots(
        2, len(steps) + 1, height_ratios=[1.2, 1.0], width_ratios=[1.15, *(1.0 for _ in steps)]
    )
    draw_scene(grid[0, 0], bodies[-1], View.along(sight, Z))
    plot_section(bodies[-1], bone=bone, ax=grid[1, 0], view=view)
    top = max(body.max_pressure for body in bodies) * 1e-3
    reach = reach_of(bodies[-1], cut)
    for column, (step, body) in enumerate(zip(steps, bodies, strict=True), 1):
        plot_footprint(body, ax=grid[0, column], view=view, with_color_bar=False, top=top)
        title = f"{body.max_penetration_before * 1e3:.2f} mm, {body.force @ direction:.3g} N (body)"
        grid[0, column].set_title(title, fontsize=10, color=INK)
        close_up(grid[1, column], step, cut, reach=reach, label="across (mm)")
    extent = max(max(map(abs, (*ax.get_xlim(), *ax.get_ylim()))) for ax in grid[0, 1:])
    for ax in grid[0, 1:]:
        ax.set(xlim=(-extent, extent), ylim=(-extent, extent))
    color_bar(grid[0, -1], pressure_colors(), top, "pressure (kPa)", beside=True)
    legend(figure, grid[1, -1])
    save(figure, name)


def legend(figure: Figure, *axes: Axes) -> None:
    """Draw one legend for axes under the figure."""
    found: dict[str, Artist] = {}
    for ax in axes:
        handles, labels = ax.get_legend_handles_labels()
        found.update(zip(labels, handles, strict=True))
    style: dict[str, Any] = {"ncols": len(found), "frameon": False, "fontsize": 8.5}
    figure.legend(list(found.values()), list(found), loc="outside lower right", **style)


def draw_scene(ax: Axes, contact: qr.Contact, view: View) -> None:
    """Draw the deformed skin and the product in light."""
    triangles = contact.obstacle.triangles()
    assert triangles is not None, "the products here are meshes"
    skin = contact.deformed
    vertices = np.concatenate([skin.vertices, triangles[0]]) * 1e3
    faces = np.concatenate([skin.faces, triangles[1] + len(skin.vertices)])
    product = np.where(np.arange(len(vertices)) < len(skin.vertices), -1.0, 1.0)
    shown = view.project(skin.vertices * 1e3)[:, :2]
    low, high = shown.min(axis=0), shown.max(axis=0)
    rim = 0.12 * float((high - low).max())
    window = (low[0] - rim, high[0] + rim, low[1] - rim, high[1] + rim)
    picture = lit_skin(vertices, faces, view, np.ones(len(vertices)), product, GREY, window, 500)
    ax.imshow(picture, extent=window, interpolation="antialiased")
    ax.set_axis_off()


def reach_of(contact: qr.Contact, view: View) -> float:
    """Return half the width of a close up (mm), a little wider than the contact."""
    touched = view.project(contact.deformed.vertices[contact.active] - contact.center_of_pressure)[:, 1]
    return 1.25e3 * float(np.abs(touched).max()) + 2.0


def close_up(
    ax: Axes,
    contacts: Mapping[str, qr.Contact],
    view: View,
    *,
    reach: float | None = None,
    label: str = "along (mm)",
) -> None:
    """Draw the cut through the last contact's center of pressure: product, skin before, skins after."""
    last = list(contacts.values())[-1]
    center = last.center_of_pressure
    reach = reach_of(last, view) if reach is None else reach
    x, y = np.linspace(-reach, reach, 500), np.linspace(-0.35 * reach, 0.6 * reach, 240)
    a, b = np.meshgrid(x, y)
    points = (a.ravel()[:, None] * view.up - b.ravel()[:, None] * view.toward) * 1e-3 + center
    distance = last.obstacle.signed_distance(points)[0].reshape(a.shape)
    ax.contourf(x, y, distance, levels=[-np.inf, 0.0], colors=[PRODUCT])
    ax.contour(x, y, distance, levels=[0.0], colors=[PRODUCT_EDGE], linewidths=1.0)
    ax.fill_between([], [], color=PRODUCT, label="product")
    lines = {"skin before": (last.surface, BEFORE, 1.1)}
    for name, contact in contacts.items():
        lines[f"after, {name}"] = (contact.deformed, COLORS[name], 1.4)
    for name, (mesh, color, thickness) in lines.items():
        placed = view.project(mesh.vertices - center) * 1e3
        line = polylines(cut_lines(mesh.faces, placed[:, 0], np.stack([placed[:, 1], -placed[:, 2]], axis=1)))
        style = "--" if name == "skin before" else "-"
        ax.plot(*line.T, color=color, linestyle=style, linewidth=thickness, label=name)
    ax.set(xlim=(-reach, reach), ylim=(-0.35 * reach, 0.6 * reach), aspect="equal")
    ax.set_xlabel(label, color=INK)
    ax.tick_params(labelsize=8.5, colors=INK)
    plain(ax)


def draw_sweep(curves: Mapping[str, qr.Sweep]) -> None:
    """Draw force and area over the overlap, a cross where a curve ends without an answer."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
    for name, curve in curves.items():
        color = COLORS.get(name, CURVES.get(name))
        good = np.isfinite(curve.normal_force)
        for ax, values in ((left, curve.normal_force), (right, curve.contact_area * 1e6)):
            ax.plot(curve.depth[good] * 1e3, values[good], "o-", markersize=3.5, color=color, label=name)
            if not good.all():
                ends = int(np.flatnonzero(good)[-1])
                ax.plot(curve.depth[ends] * 1e3, values[ends], "x", markersize=10, color=color)
    left.set(xlabel="largest overlap (mm)", ylabel="force (N)", xlim=(0, 2.1), ylim=(0, 8))
    right.set(xlabel="largest overlap (mm)", ylabel="contact area (mm²)", xlim=(0, 2.1), ylim=(0, 120))
    left.legend(frameon=False, fontsize=8.5)
    plain(left, right)
    save(figure, "sweep")


def plain(*axes: Axes) -> None:
    """Take the frame off above and to the right."""
    for ax in axes:
        ax.spines[["top", "right"]].set_visible(False)
