"""Scaled answers: one contact in other moduli and lengths, at another place, on the same mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np

from ..._arrays import Floats
from ...contact import Contact, ContactOptions
from ...skin import Response, Skin
from ...surface import Surface
from .case import Case, Outcome, near

__all__ = ["AS_GIVEN", "Build", "Setting", "off", "rounding_limit", "scaled_cases"]


# One mesh, and no more memory than any machine has.
AS_GIVEN = ContactOptions(target_error=None, memory_limit=2**30)
# One kilometre away (m).
_FAR = (1000.0, -700.0, 500.0)
_LEAST_LIMIT = 1e-9
_ROUNDINGS = 100.0


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A contact's unit of length, place and material.

    Attributes
    ----------
    length : float
        Factor on all lengths.
    shift : (3,) float
        Of everything (m), after that factor.
    modulus : float
        G (Pa).
    nu : float
        Poisson's ratio.
    """

    length: float = 1.0
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    modulus: float = 60e3
    nu: float = 0.5

    def placed(self, points: Floats) -> Floats:
        """Return points (k, 3) or (3,) in this unit, at this place."""
        placed: Floats = self.length * points + np.asarray(self.shift)
        return placed

    def surface(self, surface: Surface) -> Surface:
        """Return a surface in this unit, at this place."""
        return Surface(self.placed(surface.vertices), surface.faces, surface.skin_mask)

    def skin(self, response: Response) -> Skin:
        """Return a skin of this material."""
        return Skin(shear_modulus=self.modulus, poisson_ratio=self.nu, response=response)


Build = Callable[[Setting], Contact]


def off(found: Contact, wanted: Contact, *, force: float = 1.0, length: float = 1.0) -> float:
    """Return how far force, area and peak are from another contact's, in units of force and length.

    It is nan or infinite where one of them is not known.
    """
    pressure = force / length**2
    pairs = (
        (found.force, force * wanted.force),
        (found.contact_area, length**2 * wanted.contact_area),
        (found.max_pressure, pressure * wanted.max_pressure),
    )
    sizes = [float(np.linalg.norm(there)) for _, there in pairs]
    ways = [float(np.linalg.norm(here - there)) for here, there in pairs]
    errors = [way / size if size > 0.0 else math.inf for way, size in zip(ways, sizes, strict=True)]
    return float(np.max(errors))


def rounding_limit(contact: Contact, smallest: float) -> float:
    """Return the larger of 1e-9 and 100 times the rounding of the coordinates over a length (m)."""
    largest = float(np.abs(contact.surface.vertices).max())
    return max(_LEAST_LIMIT, _ROUNDINGS * np.finfo(np.float64).eps * largest / smallest)


def scaled_cases(
    group: str,
    name: str,
    build: Build,
    *,
    smallest: float,
    lengths: Sequence[float] = (1e-3, 1e3),
    far: bool = True,
    quick: bool = True,
) -> Iterator[Case]:
    """Make those of one contact: another modulus, other lengths, a kilometre away.

    Parameters
    ----------
    group, name : str
        Of the cases.
    build : callable
        The contact in a setting.
    smallest : float
        How deep it is (m) in the first setting, or its shortest edge where the pressures depend on that.
    lengths : sequence of float
        Factors to try.
    far : bool
        Try a kilometre away too.
    quick : bool
        Whether a quick run has them too.
    """
    build = cache(build)
    judge = partial(modulus_judge, build, smallest, 60e9)
    yield Case(group=group, name=f"{name}: G times 1e6", judge=judge, quick=quick)
    for length in lengths:
        judge = partial(length_judge, build, smallest, length)
        yield Case(
            group=group,
            name=f"{name}: lengths times {length:g}",
            judge=judge,
            quick=quick and length == lengths[0],
        )
    if far:
        yield Case(
            group=group, name=f"{name}: 1 km away", judge=partial(place_judge, build, smallest), quick=quick
        )


def modulus_judge(build: Build, smallest: float, modulus: float) -> Outcome:
    """Compare with the contact of another modulus (Pa): force and pressure in proportion."""
    here, there = build(Setting()), build(Setting(modulus=modulus))
    error = off(there, here, force=modulus / Setting().modulus)
    return near("force in proportion to G", error, rounding_limit(here, smallest))


def length_judge(build: Build, smallest: float, length: float) -> Outcome:
    """Compare with the contact in another unit of length: force and area by its square."""
    here, there = build(Setting()), build(Setting(length=length))
    error = off(there, here, force=length**2, length=length)
    return near("force by the square of the lengths", error, rounding_limit(here, smallest))


def place_judge(build: Build, smallest: float) -> Outcome:
    """Compare with the contact a kilometre away."""
    here, there = build(Setting()), build(replace(Setting(), shift=_FAR))
    return near("the same force", off(there, here), rounding_limit(there, smallest))
