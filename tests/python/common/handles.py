"""A handle, the skin that closes on it, and what its digits hold."""

import numpy as np
import quasirigid as qr

FINGERS = ("index", "middle", "ring", "little")


def skin(response=None):
    return qr.Skin(shear_modulus=60e3, poisson_ratio=0.495, response=response or qr.HalfSpace())


ENDS = np.array([[-0.05, 0.0, 0.0], [0.05, 0.0, 0.0]])
RADIUS = 0.018


def forces(grasp):
    return {name: float(np.linalg.norm(part.force)) for name, part in grasp.digits.items()}
