"""The reference problems on flat skin: where the product stands, what is true, how a mesh is made."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import reference
from ...obstacle import Obstacle
from ...skin import HalfSpace, Layer
from ...surface import Surface
from ..meshes import cone, lattice
from .ellipse import EllipticHertz

if TYPE_CHECKING:
    from ...contact import Contact

__all__ = ["CONTACT_MODULUS", "DEPTH", "SPHERE_RADIUS", "G", "Scene", "scenes", "sphere_scene"]

G = 60e3
CONTACT_MODULUS = reference.contact_modulus(shear_modulus=G, poisson_ratio=0.5)
# So large that the sphere is Hertz's parabola: at most 0.0002 % off.
SPHERE_RADIUS, DEPTH = 200.0, 0.5e-3
_CONE_SLOPE = 0.005
# Half the length of the strip over half the width of the contact.
_STRIP = 6.0

Figures = tuple[float | None, float | None, float | None]


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A product in place over flat skin about the origin, G = 60 kPa, nu = 0.5.

    Attributes
    ----------
    name, truth : str
        What is pressed, and where the truth comes from.
    truth_accuracy : float
        Relative accuracy of the truth.
    obstacle : Obstacle
        The product in place.
    extents : (2,) float
        Half axes of the contact (m), along x and y.
    true : tuple
        Force (N), area (m²) and peak pressure (Pa); None where there is none to compare with. Of a strip the
        first two are by its length (N/m, m).
    response : callable
        Of the discretization.
    curvature : float
        1 / R of the skin along x, bent away from the product (1/m).
    measured : callable, optional
        Force, area and peak of a contact, with their truths; the contact's own where left out.
    reach : float
        Half the size of the mesh over `extents`.
    """

    name: str
    truth: str
    truth_accuracy: float
    obstacle: Obstacle
    extents: tuple[float, float]
    true: Figures
    response: Callable[[Any], HalfSpace | Layer] = field(default=lambda form: HalfSpace(discretization=form))
    curvature: float = 0.0
    measured: Callable[[Contact], tuple[Figures, Figures]] | None = None
    reach: tuple[float, float] = (2.2, 2.2)

    def surface(
        self, random: np.random.Generator, cells: float, jitter: float = 0.25, degrees: float = 90.0
    ) -> Surface:
        """Return a mesh of so many cells per contact radius, somewhere under the product.

        Lattices of `degrees` whose cells are cut by one diagonal, vertices moved by up to `jitter` cells.
        """
        h = math.sqrt(self.extents[0] * self.extents[1]) / cells
        second = [np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]
        edges = h * np.array([[1.0, 0.0], second])
        columns, rows = (
            2 * math.ceil(reach * extent / h) for reach, extent in zip(self.reach, self.extents, strict=True)
        )
        plane, faces = lattice(columns, rows, edges)
        plane += random.uniform(-jitter * h, jitter * h, plane.shape)
        plane += random.uniform(-0.5, 0.5, 2) @ edges
        heights = -0.5 * self.curvature * plane[:, 0] ** 2
        return Surface(np.column_stack([plane, heights]), faces)

    def figures(self, contact: Contact) -> tuple[Figures, Figures]:
        """Return force (N), area (m²) and peak (Pa) of a contact, and what is true."""
        if self.measured is not None:
            return self.measured(contact)
        return (-float(contact.force[2]), contact.contact_area, contact.max_pressure), self.true


def sphere_scene() -> Scene:
    """Return Hertz's sphere on a half-space."""
    known = reference.Hertz(radius=SPHERE_RADIUS, contact_modulus=CONTACT_MODULUS)
    radius = known.contact_radius(DEPTH)
    return Scene(
        name="sphere",
        truth="Hertz 1882; Johnson 1985, section 4.2",
        truth_accuracy=2e-6,
        obstacle=Obstacle.sphere([0, 0, SPHERE_RADIUS - DEPTH], SPHERE_RADIUS),
        extents=(radius, radius),
        true=(known.force(DEPTH), math.pi * radius**2, known.max_pressure(DEPTH)),
    )


def scenes() -> Iterator[Scene]:
    """Make the reference problems on flat skin, the sphere first."""
    yield sphere_scene()
    yield _crossed_cylinders()
    yield _cylinder()
    yield _punch()
    yield _cone()
    yield from _sphere_on_layer()


def _crossed_cylinders() -> Scene:
    known = EllipticHertz(long_radius=800.0, short_radius=200.0, contact_modulus=CONTACT_MODULUS)
    long, short = known.half_axes(DEPTH)
    along = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    return Scene(
        name="crossed cylinders",
        truth="Hertz 1882; Johnson 1985, section 4.2",
        truth_accuracy=2e-6,
        obstacle=Obstacle.cylinder(20.0, 200.0).moved(along, [0, 0, 200.0 - DEPTH]),
        extents=(long, short),
        true=(known.force(DEPTH), math.pi * long * short, known.max_pressure(DEPTH)),
        curvature=1.0 / 800.0,
    )


def _cylinder() -> Scene:
    """Return a long cylinder on a strip, whose middle is Hertz's line contact."""
    radius, half_width = 200.0, 0.3
    length = _STRIP * half_width
    # Approach of a line load of that half-width and of the length of the strip, near enough.
    depth = half_width**2 / (4 * radius) * (2 * math.log(4 * _STRIP) + 1)
    across = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]

    def measured(contact: Contact) -> tuple[Figures, Figures]:
        # Averages over the middle of the strip, where the line load hardly changes.
        y = contact.surface.vertices[:, 1]
        window = np.where(np.abs(y) < 0.5 * length, 0.5 + 0.5 * np.cos(2 * np.pi * y / length), 0.0)
        weights = window * contact.surface.vertex_areas / (0.5 * length)
        load = float(contact.node_force @ window) / (0.5 * length)
        squares = float(weights @ contact.pressure**2)
        # The half-width that the pressures tell: their squares have the integral E*^2 a^3 / 3 R^2.
        from_pressure = (3 * squares * radius**2 / CONTACT_MODULUS**2) ** (1 / 3)
        # ... and the one that the load tells.
        from_load = math.sqrt(4 * load * radius / (math.pi * CONTACT_MODULUS))
        width = float(weights @ (contact.pressure > 0))
        true_load = math.pi * CONTACT_MODULUS * from_pressure**2 / (4 * radius)
        return (load, width, None), (true_load, 2 * from_load, None)

    return Scene(
        name="cylinder",
        truth="Hertz's line contact in the middle of a strip; Johnson 1985, section 4.2",
        # The ends of a strip of half-length l change the gap's curvature by about a^2 / 4 l^2.
        truth_accuracy=0.25 / _STRIP**2,
        obstacle=Obstacle.cylinder(2 * length, radius).moved(across, [0, 0, radius - depth]),
        extents=(half_width, half_width),
        true=(None, None, None),
        measured=measured,
        reach=(1.6, _STRIP),
    )


def _punch() -> Scene:
    radius, depth = 0.1, 1e-3
    known = reference.FlatPunch(radius=radius, contact_modulus=CONTACT_MODULUS)
    return Scene(
        name="flat punch",
        truth="Boussinesq 1885; Johnson 1985, section 3.8",
        truth_accuracy=1e-6,
        obstacle=Obstacle.cylinder(radius, radius).moved(np.eye(3), [0, 0, radius - depth]),
        extents=(radius, radius),
        # The pressure at the rim is infinite.
        true=(known.force(depth), math.pi * radius**2, None),
    )


def _cone() -> Scene:
    known = reference.Cone(semi_angle=math.atan(1 / _CONE_SLOPE), contact_modulus=CONTACT_MODULUS)
    radius = known.contact_radius(DEPTH)
    point = cone(4 * radius, 4 * radius * _CONE_SLOPE, sides=240).moved(np.eye(3), [0, 0, -DEPTH])
    return Scene(
        name="cone",
        truth="Sneddon 1965; Johnson 1985, section 5.2",
        # 240 sides, and slopes of 0.005.
        truth_accuracy=1e-4,
        obstacle=point,
        extents=(radius, radius),
        # The pressure at the point is infinite.
        true=(known.force(DEPTH), math.pi * radius**2, None),
    )


def _sphere_on_layer() -> Iterator[Scene]:
    sphere = sphere_scene()
    force, radius = sphere.true[0] or 0.0, sphere.extents[0]
    for known in reference.sphere_on_layer():
        thickness = radius / known.thinness

        def response(form: Any, thickness: float = thickness) -> Layer:
            return Layer(thickness=thickness, discretization=form)

        yield Scene(
            name=f"sphere on a layer of {1 / known.thinness:.2g} contact radii",
            truth="Hayes, Keer, Herrmann, Mockros 1972, with sqrt(R d) for the contact radius",
            truth_accuracy=known.accuracy,
            obstacle=sphere.obstacle,
            extents=sphere.extents,
            true=(known.force_ratio * force, None, None),
            response=response,
        )
