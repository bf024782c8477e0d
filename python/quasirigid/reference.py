"""Closed-form and tabulated answers to check against: Hertz, flat punch, cone, layer, sphere on a rigid core.

All are frictionless indentations of an elastic body by a rigid indenter; numbers are SI: m, N, Pa, rad, J.
"""

from __future__ import annotations

from typing import NamedTuple

from . import _core
from ._core import Cone, FlatPunch, Hertz, contact_modulus

__all__ = [
    "Cone",
    "CoredSphere",
    "FlatPunch",
    "Hertz",
    "LayerIndentation",
    "ball_on_cored_sphere",
    "contact_modulus",
    "plate_on_cored_sphere",
    "point_load_on_layer",
    "sphere_on_layer",
]


class LayerIndentation(NamedTuple):
    """A rigid sphere of radius R on an incompressible layer of thickness h bonded to a rigid base, d deep.

    Attributes
    ----------
    thinness : float
        sqrt(R d) / h.
    force_ratio : float
        Force over Hertz's force on a half-space of the same material.
    accuracy : float
        Relative accuracy of `force_ratio`.
    """

    thinness: float
    force_ratio: float
    accuracy: float


class CoredSphere(NamedTuple):
    """A rigid frictionless indenter pressed against an elastic sphere bonded to a rigid concentric core.

    Attributes
    ----------
    radius : float
        Radius of the sphere (m).
    core_radius : float
        Radius of the core (m).
    indenter_radius : float
        Radius of the indenter (m), inf for a flat plate.
    shear_modulus : float
        Shear modulus (Pa).
    accuracy : float
        Relative accuracy of the forces.
    poisson_ratio : float
        Poisson's ratio.
    indentations : dict of float to float
        Force (N) at each depth (m).
    """

    radius: float
    core_radius: float
    indenter_radius: float
    shear_modulus: float
    accuracy: float
    poisson_ratio: float
    indentations: dict[float, float]


def sphere_on_layer() -> tuple[LayerIndentation, ...]:
    """Return the forces of a rigid sphere on an incompressible bonded layer, over Hertz's.

    References
    ----------
    Hayes, Keer, Herrmann, Mockros 1972, J. Biomechanics 5; Garcia, Garcia 2018, Biophysical J. 114.

    Examples
    --------
    >>> import quasirigid as qr
    >>> [(case.thinness, case.force_ratio) for case in qr.reference.sphere_on_layer()]
    [(0.3, 1.51822), (0.5, 2.15622), (0.7, 3.09818)]
    """
    return tuple(LayerIndentation(*row) for row in _core.sphere_on_layer())


def point_load_on_layer() -> dict[float, float]:
    """Return h u / K at each r / h on an incompressible bonded layer under a point load.

    u is the surface displacement per newton at distance r, h the thickness, K = (1 - nu) / (2 pi G).

    Examples
    --------
    >>> import quasirigid as qr
    >>> qr.reference.point_load_on_layer()[2.0]
    -0.05275
    """
    return dict(_core.point_load_on_layer())


def plate_on_cored_sphere() -> tuple[CoredSphere, ...]:
    """Return the forces of a flat plate on a sphere with a rigid core at several Poisson's ratios.

    Axisymmetric finite elements and the exact series of the shell agree to the stated accuracy.

    Examples
    --------
    >>> import quasirigid as qr
    >>> soft = qr.reference.plate_on_cored_sphere()[-1]
    >>> soft.poisson_ratio, soft.indentations[1.12e-3]
    (0.3, 1.02)
    """
    return tuple(CoredSphere(*row[:-1], dict(row[-1])) for row in _core.plate_on_cored_sphere())


def ball_on_cored_sphere() -> tuple[CoredSphere, ...]:
    """Return the forces of a ball on a sphere with a rigid core at two Poisson's ratios.

    Of axisymmetric finite elements, with the contact solved to the end.
    """
    return tuple(CoredSphere(*row[:-1], dict(row[-1])) for row in _core.ball_on_cored_sphere())
