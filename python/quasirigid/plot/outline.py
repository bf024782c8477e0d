"""The rim of a contact, found between the vertices."""

from __future__ import annotations

import numpy as np

from .._arrays import Floats, Indices
from .._geometry import sides_of


def contact_side(vertices: Floats, faces: Indices, pressure: Floats, gap: Floats) -> Floats:
    """Return a field (n,) in m that is above 0 inside the contact and crosses 0 at its rim.

    Near the rim of a smooth contact the pressure grows as the square root of the distance from it inside, and
    the gap as its 3/2 power outside (Johnson 1985, sections 4.2 and 5.1), so p^2 and g^(2/3) both grow as the
    distance itself. Their two factors come from a least-squares fit over the edges that the rim crosses.
    """
    edges = sides_of(faces)
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
