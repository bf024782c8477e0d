"""Draw docs/hertz.png: error against Hertz and time of a press, over cells per contact radius."""

from __future__ import annotations

import statistics
import time
from pathlib import Path

import matplotlib
import numpy as np
import quasirigid as qr
from numpy.typing import NDArray

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# So shallow that the sphere is the parabola of Hertz.
RADIUS, APPROACH, SHEAR_MODULUS, POISSON_RATIO = 20.0, 20e-6, 60e3, 0.5
CELLS = (3, 4, 6, 8, 12, 16)


def grid(cells: int, spacing: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return a flat open square about the origin."""
    x = (np.arange(cells + 1) - cells / 2) * spacing
    points = np.stack([*np.meshgrid(x, x, indexing="ij"), np.zeros((cells + 1, cells + 1))], axis=-1)
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    return points.reshape(-1, 3), np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


def main() -> None:
    """Measure, print, draw."""
    modulus = qr.reference.contact_modulus(shear_modulus=SHEAR_MODULUS, poisson_ratio=POISSON_RATIO)
    hertz = qr.reference.Hertz(radius=RADIUS, contact_modulus=modulus)
    contact_radius, force, peak = (
        figure(APPROACH) for figure in (hertz.contact_radius, hertz.force, hertz.max_pressure)
    )
    skin = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=POISSON_RATIO, response=qr.HalfSpace())
    sphere = qr.Obstacle.sphere([0, 0, RADIUS - APPROACH], RADIUS)
    as_given = qr.ContactOptions(target_error=None)
    rows = []
    for cells in CELLS:
        surface = qr.Surface(*grid(3 * cells, contact_radius / cells))
        seconds = []
        for _ in range(5):
            started = time.perf_counter()
            contact = qr.solve_contact(surface, sphere, skin, options=as_given)
            seconds.append(time.perf_counter() - started)
        errors = (-contact.force[2] / force - 1, contact.max_pressure / peak - 1)
        rows.append((cells, *errors, statistics.median(seconds)))
        print(f"{cells:3d} cells: force {errors[0]:+.3%}, peak {errors[1]:+.3%}, {rows[-1][-1] * 1e3:.1f} ms")
    cells_, force_error, peak_error, seconds_ = np.array(rows).T
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.2), layout="constrained")
    left.loglog(cells_, 100 * np.abs(force_error), "o-", label="force")
    left.loglog(cells_, 100 * np.abs(peak_error), "s-", label="peak pressure")
    left.set(xlabel="cells per contact radius", ylabel="error against Hertz (%)")
    left.legend(frameon=False)
    right.loglog(1e3 * seconds_, 100 * np.abs(peak_error), "s-", color="C1")
    for cells, x, y in zip(cells_, 1e3 * seconds_, 100 * np.abs(peak_error), strict=True):
        right.annotate(f"{int(cells)}", (x, y), textcoords="offset points", xytext=(5, 4), fontsize=8)
    right.set(xlabel="time of a contact (ms)", ylabel="error of the peak pressure (%)")
    left.set_xticks(CELLS, [str(cells) for cells in CELLS])
    left.minorticks_off()
    left.set_yticks([0.05, 0.1, 0.2, 0.5, 1, 2], ["0.05", "0.1", "0.2", "0.5", "1", "2"])
    right.minorticks_off()
    right.set_yticks([0.2, 0.5, 1, 2], ["0.2", "0.5", "1", "2"])
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(Path(__file__).parents[1] / "hertz.png", dpi=150)


if __name__ == "__main__":
    main()
