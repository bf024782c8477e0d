"""Two cylinders crossed at right angles: Hertz's elliptic contact."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["EllipticHertz"]


@dataclass(frozen=True, kw_only=True)
class EllipticHertz:
    """An elastic half-space pressed to a gap of ``x^2 / 2 R1 + y^2 / 2 R2``, R1 > R2.

    Parameters
    ----------
    long_radius, short_radius : float
        R1 and R2 (m).
    contact_modulus : float
        E* (Pa).

    References
    ----------
    Johnson 1985, "Contact Mechanics", section 4.2, equations 4.25 to 4.32.
    """

    long_radius: float
    short_radius: float
    contact_modulus: float

    @property
    def axis_ratio(self) -> float:
        """Return b / a of the ellipse of contact, at most 1."""
        wanted = self.long_radius / self.short_radius
        low, high = 1e-6, 1.0 - 1e-9
        for _ in range(200):
            middle = 0.5 * (low + high)
            first, second = _integrals(middle)
            # B / A, which falls from infinity to 1 as the ellipse becomes a circle.
            found = (second / middle**2 - first) / (first - second)
            low, high = (middle, high) if found > wanted else (low, middle)
        return 0.5 * (low + high)

    def half_axes(self, approach: float) -> tuple[float, float]:
        """Return a and b (m) at an approach (m)."""
        ratio = self.axis_ratio
        first, second = _integrals(ratio)
        # p0 b / E* = approach / K
        slope = approach / first
        product = (second / ratio**2 - first) * (first - second)
        long = math.sqrt(
            2.0
            * math.sqrt(self.long_radius * self.short_radius)
            * slope
            * math.sqrt(product)
            / (1.0 - ratio**2)
        )
        return long, ratio * long

    def max_pressure(self, approach: float) -> float:
        """Return the peak pressure (Pa) at an approach (m)."""
        first, _ = _integrals(self.axis_ratio)
        return self.contact_modulus * approach / (first * self.half_axes(approach)[1])

    def force(self, approach: float) -> float:
        """Return the force (N) at an approach (m)."""
        long, short = self.half_axes(approach)
        return 2.0 / 3.0 * math.pi * self.max_pressure(approach) * long * short


def _integrals(axis_ratio: float) -> tuple[float, float]:
    """Return the complete elliptic integrals K and E of modulus sqrt(1 - axis_ratio^2), by means."""
    a, b, power = 1.0, axis_ratio, 0.5
    total = power * (1.0 - axis_ratio**2)
    while abs(a - b) > 1e-16 * a:
        a, b, difference = 0.5 * (a + b), math.sqrt(a * b), 0.5 * (a - b)
        power *= 2.0
        total += power * difference**2
        if difference < 1e-12 * a:
            break
    first = 0.5 * math.pi / a
    return first, first * (1.0 - total)
