"""A ball with a core, and skins of every response that can be prepared for it."""

from __future__ import annotations

import numpy as np
import quasirigid as qr
from shapes import ball

SHEAR_MODULUS = 60e3


def skin_of(response: qr.Response) -> qr.Skin:
    return qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.45, response=response)


def core() -> qr.Surface:
    vertices, faces = ball(3e-3, 2)
    return qr.Surface(vertices + np.array([0, 0, 5e-3]), faces)


RESPONSES = {
    "half_space": qr.HalfSpace(),
    "layer": qr.Layer(thickness=20e-3),
    "field": qr.Layer(thickness=np.full(642, 20e-3)),
    "body": qr.Body(bone=core()),
    "averaged_body": qr.Body(bone=core(), discretization="galerkin"),
}
