"""tamaas, a solver on regular grids by fast Fourier transform, on the sphere where it is installed."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from .kernels import Task
from .rows import make_row, timed
from .scenes import CONTACT_MODULUS, DEPTH, SPHERE_RADIUS, sphere_scene

__all__ = ["pixel_tasks"]


def pixel_tasks(quick: bool) -> Iterator[Task]:
    """Make the ladder of pixels per contact radius; none without tamaas."""
    try:
        import tamaas
    except ImportError:
        return
    tamaas.set_log_level(tamaas.LogLevel.warning)
    for pixels in (4, 8, 16) if quick else (4, 8, 16, 32, 64):
        yield f"sphere, tamaas, {pixels} pixels", partial(_on_pixels, tamaas, pixels)


def _on_pixels(tamaas: Any, pixels: int) -> dict[str, Any]:
    """Return the errors on square pixels under the force of Hertz; that of force is 3/2 of the approach's."""
    scene = sphere_scene()
    force, area, peak = (figure or 0.0 for figure in scene.true)
    size, count = 3.0 * scene.extents[0], 3 * pixels
    x = (np.arange(count) + 0.5) * size / count - 0.5 * size
    heights = -(x[:, None] ** 2 + x[None, :] ** 2) / (2 * SPHERE_RADIUS)

    def solve() -> Any:
        model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [size, size], [count, count])
        model.E, model.nu = CONTACT_MODULUS, 0.0
        tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
        solver = tamaas.PolonskyKeerRey(model, heights, 1e-8)
        solver.setIntegralOperator("dcfft")
        solver.solve(force / size**2)
        return model

    model, seconds = timed(solve)
    pressure = np.array(model.traction)
    # The solver shifts the displacement by the approach.
    displacement = np.zeros_like(pressure)
    model.operators["dcfft"](pressure, displacement)
    approach = float((displacement - heights)[pressure > 0].mean())
    return make_row(
        scene=scene.name,
        response=f"tamaas {tamaas.__version__}",
        discretization="pixels",
        solver="Polonsky, Keer",
        mesh="regular grid",
        cells_per_radius=pixels,
        nodes=count**2,
        force=force,
        true_force=force,
        force_error=1.5 * abs(approach / DEPTH - 1.0),
        area_error=abs(float((pressure > 0).mean()) * size**2 / area - 1.0),
        max_pressure_error=abs(float(pressure.max()) / peak - 1.0),
        seconds=seconds,
        truth=scene.truth,
        truth_accuracy=scene.truth_accuracy,
    )
