"""Write docs/accuracy.md and docs/accuracy.png: error against time, and how far the estimates hold.

tamaas, a solver of contacts on regular grids by fast Fourier transform, is measured beside it where it is
installed.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Literal, TypeVar

import matplotlib
import numpy as np
import quasirigid as qr
from numpy.typing import NDArray
from validation import CONTACT_MODULUS, FORMS, PLATE, UP, G, body, drawn_sphere, lattice, near_pole

matplotlib.use("Agg")
import matplotlib.pyplot as plt

try:
    import tamaas
except ImportError:
    tamaas = None
else:
    tamaas.set_log_level(tamaas.LogLevel.warning)

Floats = NDArray[np.float64]
_Form = Literal["collocation", "galerkin"]
Made = TypeVar("Made")

# So large that the sphere is Hertz's parabola.
RADIUS, DEPTH = 200.0, 0.5e-3
HERTZ = qr.reference.Hertz(radius=RADIUS, contact_modulus=CONTACT_MODULUS)
TOUCHING = HERTZ.contact_radius(DEPTH)
SPHERE = qr.Obstacle.sphere([0, 0, RADIUS - DEPTH], RADIUS)
FIGURES = ("force", "area", "peak")
TRUE = np.array([HERTZ.force(DEPTH), math.pi * TOUCHING**2, HERTZ.max_pressure(DEPTH)])

CELLS = (2, 3, 4, 6, 8, 12)
TARGETS = (0.05, 0.02, 0.01, 0.005, 0.002)
GIVEN_CELLS = 3
PIXELS = (4, 8, 16, 32, 64)
PLACES = 12
CASES = 100
AS_GIVEN = qr.ContactOptions(target_error=None)

PAGE = """\
# Accuracy

A press refines the skin's mesh around the contact until the errors of force and area that the mesh leaves are
estimated to be below `ContactOptions(target_error=0.02)`; `target_error=None` takes the mesh as it is.
`contact.accuracy` holds the estimates, `contact.refinements` what each mesh gave. Measured by
`python docs/accuracy.py`, which writes this page; times are wall times of the machine that ran it.

![Errors of force and area against Hertz over the time of a contact](accuracy.png)

## Half-space against Hertz

A sphere pressed into flat skin so little (R = 200 m, {depth:g} mm) that it is Hertz's parabola, on squares
cut by one diagonal with vertices moved by up to a quarter of a cell: root mean square errors over {places}
places of the sphere, nodes and time in the median. The refined contacts start from {given_cells} cells per
contact radius. tamaas solves on square pixels for the force of Hertz; its error of force is 3/2 of that of
the approach.

{hertz}

## Sphere with a rigid core against finite elements

A flat plate on a sphere of 8 mm radius with a core of 3 mm, G = 60 kPa, on even edges (642 vertices, core of
642): error of the force and, in brackets, its estimate. One level is the body on the skin's own mesh
(`coarse_edge_length=0`), two levels the default. Finite elements hold to 0.2 %.

{sphere}

## The estimates

{cases} random contacts of Hertz: 2 to 8 cells per contact radius, jitter up to 0.3 cells, lattices of 60 to
120 degrees, targets of 0.005 to 0.05 for the refined ones. Share of them whose error is within the estimate,
and median of estimate over error. An estimate is no bound.

{estimates}
"""


def half_space(form: _Form | None) -> qr.Skin:
    """Return the incompressible half-space; its form is the package's choice where None."""
    return qr.Skin(shear_modulus=G, poisson_ratio=0.5, response=qr.HalfSpace(discretization=form))


def jittered(
    random: np.random.Generator, cells: float, jitter: float = 0.25, degrees: float = 90.0
) -> qr.Surface:
    """Return a flat mesh of so many cells per contact radius, somewhere under the sphere."""
    h = TOUCHING / cells
    second = [np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]
    edges = h * np.array([[1.0, 0.0], second])
    count = 2 * math.ceil(2.2 * cells)
    moved = random.uniform(-jitter * h, jitter * h, ((count + 1) ** 2, 2))
    return lattice(count, edges, random.uniform(-0.5, 0.5, 2) @ edges, moved)


def figures(contact: qr.Contact) -> Floats:
    """Return force, area and peak."""
    return np.array([-contact.force[2], contact.contact_area, contact.max_pressure])


def timed(make: Callable[[], Made], repeats: int = 3) -> tuple[Made, float]:
    """Return what is made and the median time (s) of up to `repeats`."""
    seconds = []
    for _ in range(repeats):
        started = time.perf_counter()
        made = make()
        seconds.append(time.perf_counter() - started)
        if sum(seconds) > 1.0:
            break
    return made, statistics.median(seconds)


def over_places(cells: float, form: _Form | None, options: qr.ContactOptions) -> list[float]:
    """Return nodes, rms errors of the figures and time (s) of one way to solve."""
    rows = []
    for place in range(PLACES):
        surface = jittered(np.random.default_rng(place), cells)
        contact, seconds = timed(
            partial(qr.solve_contact, surface, SPHERE, half_space(form), options=options)
        )
        rows.append([len(contact.candidates), *(figures(contact) / TRUE - 1), seconds])
    columns = np.array(rows).T
    rms = np.sqrt((columns[1:-1] ** 2).mean(axis=1))
    return [float(np.median(columns[0])), *rms.tolist(), float(np.median(columns[-1]))]


def on_pixels(pixels: int) -> list[float]:
    """Return the same of tamaas, on so many pixels per contact radius; one place."""
    size, count = 3.0 * TOUCHING, 3 * pixels
    x = (np.arange(count) + 0.5) * size / count - 0.5 * size
    heights = -(x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)

    def solve() -> Any:
        model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [size, size], [count, count])
        model.E, model.nu = CONTACT_MODULUS, 0.0
        tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
        solver = tamaas.PolonskyKeerRey(model, heights, 1e-8)
        solver.setIntegralOperator("dcfft")
        solver.solve(TRUE[0] / size**2)
        return model

    model, seconds = timed(solve)
    pressure = np.array(model.traction)
    # The solver shifts the displacement by the approach.
    displacement = np.zeros_like(pressure)
    model.operators["dcfft"](pressure, displacement)
    approach = (displacement - heights)[pressure > 0].mean()
    area = (pressure > 0).mean() * size**2
    found = [1.5 * abs(approach / DEPTH - 1), abs(area / TRUE[1] - 1), abs(pressure.max() / TRUE[2] - 1)]
    return [float(count**2), *found, seconds]


def against_hertz() -> tuple[list[str], dict[str, list[list[float]]]]:
    """Measure the half-space; return the table and the rows behind it."""
    lines = ["| mesh | how fine | nodes | force | area | peak | time |", "|---|---|---|---|---|---|---|"]
    curves: dict[str, list[list[float]]] = {}

    def add(name: str, detail: str, row: list[float]) -> None:
        curves.setdefault(name, []).append(row)
        errors = " | ".join(f"{error:.2%}" for error in row[1:-1])
        lines.append(f"| {name} | {detail} | {row[0]:.0f} | {errors} | {row[-1] * 1e3:.1f} ms |")
        print(lines[-1], flush=True)

    for form in FORMS:
        for cells in CELLS:
            add(f"as it is, {form}", f"{cells} cells", over_places(cells, form, AS_GIVEN))
    for target in TARGETS:
        options = qr.ContactOptions(target_error=target)
        add("refined", f"target {target:g}", over_places(GIVEN_CELLS, None, options))
    if tamaas is None:
        lines.append("| tamaas | not installed | | | | | |")
    else:
        for pixels in PIXELS:
            add(f"tamaas {tamaas.__version__}", f"{pixels} pixels", on_pixels(pixels))
    return lines, curves


# Axisymmetric finite elements: force (N) by Poisson's ratio and depth (m).
PLATE_ON_CORED_SPHERE = {
    0.3: {0.3e-3: 0.1248, 0.6e-3: 0.3761, 1.12e-3: 1.0192},
    0.495: {0.3e-3: 0.1670, 0.6e-3: 0.4911, 1.12e-3: 1.2877},
}


def sphere_with_core() -> list[str]:
    """Measure forces, estimates and times of the body on one level and on two."""
    skin, bone = drawn_sphere(8e-3, 3, 1.0), drawn_sphere(3e-3, 3, 1.0)
    depths = list(PLATE_ON_CORED_SPHERE[0.3])
    heads = [f"{depth * 1e3:g} mm" for depth in depths]
    lines = [
        "| nu | levels | mesh | set-up | " + " | ".join(heads) + " |",
        "|---|---|---|---|" + "---|" * len(depths),
    ]
    for nu, forces in PLATE_ON_CORED_SPHERE.items():
        for levels, length in (("one", 0.0), ("two", None)):
            started = time.perf_counter()
            prepared = body(skin, nu, near_pole(skin, 4e-3), bone=bone, coarse_edge_length=length)
            setup = time.perf_counter() - started
            for mesh, options in (("as it is", AS_GIVEN), ("refined", qr.ContactOptions())):
                cells = []
                for depth in depths:
                    press = partial(qr.press, skin, PLATE, prepared, UP, depth=depth, options=options)
                    contact, seconds = timed(press)
                    error = contact.force[2] / forces[depth] - 1
                    estimate = contact.accuracy.force_error
                    cells.append(f"{error:+.1%} ({estimate:.1%}), {seconds * 1e3:.2g} ms")
                lines.append(f"| {nu} | {levels} | {mesh} | {setup:.1f} s | " + " | ".join(cells) + " |")
                print(lines[-1], flush=True)
    return lines


def estimates() -> list[str]:
    """Measure how often the errors of random contacts are within their estimates, and by how much."""
    lines = ["| mesh | form | force | area | peak |", "|---|---|---|---|---|"]
    for is_refined in (False, True):
        for form in FORMS:
            random = np.random.default_rng(1)
            errors, known = np.empty((2, CASES, len(FIGURES)))
            for case in range(CASES):
                cells = math.exp(random.uniform(math.log(2), math.log(8)))
                surface = jittered(random, cells, random.uniform(0.0, 0.3), random.uniform(60.0, 120.0))
                target = math.exp(random.uniform(math.log(0.005), math.log(0.05)))
                options = qr.ContactOptions(target_error=target) if is_refined else AS_GIVEN
                contact = qr.solve_contact(surface, SPHERE, half_space(form), options=options)
                accuracy = contact.accuracy
                errors[case] = np.abs(figures(contact) / TRUE - 1)
                known[case] = [accuracy.force_error, accuracy.area_error, accuracy.max_pressure_error]
            within, ratio = (errors <= known).mean(axis=0), np.median(known / errors, axis=0)
            cells_ = [f"{share:.0%}, {median:.2g}" for share, median in zip(within, ratio, strict=True)]
            mesh = "refined" if is_refined else "as it is"
            lines.append(f"| {mesh} | {form} | " + " | ".join(cells_) + " |")
            print(lines[-1], flush=True)
    return lines


def draw(curves: dict[str, list[list[float]]]) -> None:
    """Draw errors of force and area over time."""
    figure, axes = plt.subplots(1, 2, figsize=(8.5, 3.4), layout="constrained", sharex=True)
    markers = dict(zip(curves, "os^Dv", strict=False))
    for ax, at, name in zip(axes, (1, 2), FIGURES, strict=False):
        for label, rows in curves.items():
            columns = np.array(rows).T
            width = 2.2 if label == "refined" else 1.2
            ax.loglog(
                1e3 * columns[-1],
                100 * columns[at],
                f"{markers[label]}-",
                label=label,
                linewidth=width,
                markersize=4,
            )
        ax.set(xlabel="time of a contact (ms)", ylabel=f"error of the {name} (%)")
        ax.spines[["top", "right"]].set_visible(False)
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_formatter("{x:g}")
    axes[0].legend(frameon=False, fontsize=7.5)
    figure.savefig(Path(__file__).with_name("accuracy.png"), dpi=130)


def main() -> None:
    """Measure, print, draw, write."""
    # The coarsest meshes say that they are coarse.
    warnings.simplefilter("ignore", qr.QuasirigidWarning)
    hertz, curves = against_hertz()
    draw(curves)
    page = PAGE.format(
        depth=DEPTH * 1e3,
        places=PLACES,
        given_cells=GIVEN_CELLS,
        cases=CASES,
        hertz="\n".join(hertz),
        sphere="\n".join(sphere_with_core()),
        estimates="\n".join(estimates()),
    )
    target = Path(__file__).with_name("accuracy.md")
    target.write_text(page, encoding="utf-8")
    print(f"wrote {target}", file=sys.stderr)


if __name__ == "__main__":
    main()
