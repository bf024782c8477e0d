"""The skin under two lights, as a picture of pixels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._arrays import Floats, Indices
from .._geometry import face_normals
from .raster import rasterise
from .style import Window
from .view import View

if TYPE_CHECKING:
    from matplotlib.colors import Colormap

SKIN = np.array([0.930, 0.780, 0.695])
SAMPLES = 2  # drawn pixels per shown pixel, along each side


def lit_skin(
    vertices: Floats,
    faces: Indices,
    view: View,
    values: Floats,
    inside: Floats,
    colors: Colormap,
    window: Window,
    height: int,
    *,
    base: Floats | None = None,
) -> Floats:
    """Return a picture (height, width, 4) of the lit skin, in color where `inside` (n,) is above 0.

    `values` (n,) pick the color, from 0 to their largest; `window` is in the unit of `vertices`; `base`
    (n, 3) is the color elsewhere, that of skin when left out.
    """
    width = max(1, round(height * (window[1] - window[0]) / (window[3] - window[2])))
    frame = rasterise(view.project(vertices), faces, window, width * SAMPLES, height * SAMPLES)
    normals = _unit(frame.interpolate(faces, view.project(vertex_normals(vertices, faces))))
    # Along a sharp rim the mean of both sides is neither: such faces are lit flat.
    flat = _unit(view.project(face_normals(vertices, faces))[frame.face])
    normals = np.where(((normals * flat).sum(axis=1) < 0.8)[:, None], flat, normals)
    brightness = (
        0.36 + 0.56 * _lambert(normals, (-0.50, 0.55, 0.67)) + 0.22 * _lambert(normals, (0.75, -0.10, 0.65))
    )
    shine = 0.09 * _lambert(normals, (-0.27, 0.30, 0.915)) ** 40

    largest = float(values.max()) if values.max() > 0.0 else 1.0
    share = np.clip(frame.interpolate(faces, values) / largest, 0.0, 1.0)
    # Colors stay close to those of the color bar: a part of the shading only, no shine.
    mapped = colors(share)[:, :3] * np.clip(0.66 + 0.36 * brightness, 0.0, 1.03)[:, None]
    colored = frame.interpolate(faces, inside) > 0.0
    bare = SKIN if base is None else frame.interpolate(faces, base)
    color = np.where(colored[:, None], mapped, bare * brightness[:, None] + shine[:, None])
    picture = np.zeros((height * width * SAMPLES**2, 4))
    picture[frame.pixel, :3] = np.clip(color, 0.0, 1.0)
    picture[frame.pixel, 3] = 1.0
    # Average of the drawn pixels, the color over the covered ones only so that rims do not darken.
    summed = picture.reshape(height, SAMPLES, width, SAMPLES, 4).sum(axis=(1, 3))
    summed[..., :3] /= np.maximum(summed[..., 3:], 1.0)
    summed[..., 3] /= SAMPLES**2
    averaged: Floats = summed
    return averaged


def _unit(vectors: Floats) -> Floats:
    """Return vectors (k, 3) of length 1; those of length 0 stay, whatever the unit."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths > 0.0, lengths, 1.0)


def _lambert(normals: Floats, light: tuple[float, float, float]) -> Floats:
    direction = np.asarray(light) / np.linalg.norm(light)
    brightness: Floats = np.clip(normals @ direction, 0.0, 1.0)
    return brightness


def vertex_normals(vertices: Floats, faces: Indices) -> Floats:
    """Return the sums (n, 3) of the face normals around each vertex, not normalised."""
    summed = np.zeros_like(vertices)
    normals = face_normals(vertices, faces)
    for corner in range(3):
        np.add.at(summed, faces[:, corner], normals)
    return summed
