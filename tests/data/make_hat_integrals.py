"""Fill in the integrals of hat_integrals.csv from the triangles, points and widths that stand in it.

Each row: corners a, b, c (m), a point x (m), a width s (m); the integrals of the three hats over the triangle
against 1/r (m) and against exp(-r^2 / 2 s^2) (m^2), r the distance from x. The rows are five triangles (well
shaped, random, two slivers, one 2e-6 m high) at 13 points each: vertices, edges, face, 1e-9 m off the plane,
near, and up to three edge lengths away.

A hat is linear in the plane, h0 + g.e rho in polar coordinates (rho, e) about the projection of x, so the
radial integrals are elementary; those along the edges are taken by Gauss-Legendre rules at 60 digits. Needs
mpmath. `--check` recomputes and compares instead of writing.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

from mpmath import asinh, cosh, erf, exp, mp, mpf, pi, quad, sinh, sqrt

mp.dps = 60
TABLE = Path(__file__).with_name("hat_integrals.csv")


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def inverse_radial(reach, height):
    """Integrals of rho / r and rho^2 / r over rho from 0 to `reach`, r^2 = rho^2 + height^2."""
    r = sqrt(reach**2 + height**2)
    if height == 0:
        return reach, reach**2 / 2
    return r - height, (reach * r - height**2 * asinh(reach / height)) / 2


def gaussian_radial(reach, height, width):
    """Integrals of rho and rho^2 against exp(-(rho^2 + height^2) / 2 width^2)."""
    at_height = exp(-(height**2) / (2 * width**2))
    fall = exp(-(reach**2) / (2 * width**2))
    second = width * sqrt(pi / 2) * erf(reach / (width * sqrt(2))) - reach * fall
    return width**2 * at_height * (1 - fall), width**2 * at_height * second


def hat_integrals(corners, point, radial):
    """Integrals of the three hats against the kernel that `radial(reach, height)` integrates."""
    normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]))
    doubled_area = sqrt(dot(normal, normal))
    normal = [component / doubled_area for component in normal]
    height = dot(minus(point, corners[0]), normal)
    foot = [x - height * n for x, n in zip(point, normal, strict=True)]
    # hat k: its value at the foot and its gradient
    hats = []
    for k in range(3):
        b, c = corners[(k + 1) % 3], corners[(k + 2) % 3]
        gradient = [component / doubled_area for component in cross(normal, minus(c, b))]
        hats.append((dot(gradient, minus(foot, b)), gradient))
    sums = [mpf(0)] * 3
    for k in range(3):
        a, b = corners[k], corners[(k + 1) % 3]
        length = sqrt(dot(minus(b, a), minus(b, a)))
        along = [component / length for component in minus(b, a)]
        outward = cross(along, normal)
        distance = dot(minus(a, foot), outward)
        if abs(distance) < mpf(10) ** -50:
            continue  # the edge is seen end on: no angle
        # Along the edge s = |d| sinh w, so rho = |d| cosh w and the angle grows by dw / cosh w.
        reach, sign = abs(distance), 1 if distance > 0 else -1
        ends = [asinh(dot(minus(corner, foot), along) / reach) for corner in (a, b)]
        pieces = max(1, int(ends[1] - ends[0]) + 1)
        cuts = [ends[0] + (ends[1] - ends[0]) * i / pieces for i in range(pieces + 1)]

        for j, (value, gradient) in enumerate(hats):
            slopes = sign * dot(gradient, outward), dot(gradient, along)

            def ray(w, value=value, slopes=slopes, reach=reach):
                first, second = radial(reach * cosh(w), abs(height))
                slope = (slopes[0] + slopes[1] * sinh(w)) / cosh(w)
                return (value * first + slope * second) / cosh(w)

            sums[j] += sign * quad(ray, cuts, method="gauss-legendre")
    return sums


def row_of(numbers):
    corners = [[mpf(x) for x in numbers[i : i + 3]] for i in (0, 3, 6)]
    point, width = [mpf(x) for x in numbers[9:12]], mpf(numbers[12])
    inverse = hat_integrals(corners, point, inverse_radial)
    gaussian = hat_integrals(corners, point, lambda reach, height: gaussian_radial(reach, height, width))
    return [float(value) for value in inverse + gaussian]


def main(check: bool) -> None:
    with TABLE.open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    worst = 0.0
    for row in rows:
        found = row_of([float(cell) for cell in row[:13]])
        worst = max(worst, *(abs(new / float(old) - 1) for new, old in zip(found, row[13:], strict=True)))
        row[13:] = [repr(value) for value in found]
    print(f"largest relative difference to the numbers that stood there: {worst:.1e}")
    if not check:
        TABLE.write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main("--check" in sys.argv[1:])
