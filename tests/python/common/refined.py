"""Skins of irregular meshes, and the plate that presses them."""

from __future__ import annotations

import numpy as np
import quasirigid as qr
from numpy.typing import NDArray
from shapes import ball

MATERIAL = {"shear_modulus": 60e3, "poisson_ratio": 0.5}
UP = np.array([0.0, 0.0, 1.0])
TARGET = 0.02
Floats = NDArray[np.float64]


def jittered_ball(seed: int) -> qr.Surface:
    """A ball with an irregular mesh, which stands on the origin."""
    vertices, faces = ball(1.0, 3)
    out = vertices - UP + np.random.default_rng(seed).uniform(-0.03, 0.03, vertices.shape)
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    out[:, 2] -= out[:, 2].min()
    return qr.Surface(8e-3 * out, faces)
