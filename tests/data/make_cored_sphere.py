"""Print the forces of src/reference/cored_sphere.rs: a flat frictionless plate on a sphere with a rigid core.

Displacements of degree n of an elastic shell (Lur'e 1964, section 6.2), u_r times P_n, u_t times dP_n/dtheta:

    u_r:  A (n+1)(n-2+4nu) r^(n+1) + B n r^(n-1) + C n(n+3-4nu) r^-n - D (n+1) r^-(n+2)
    u_t:  A (n+5-4nu) r^(n+1)      + B r^(n-1)   + C (4-4nu-n) r^-n  + D r^-(n+2)

with u = 0 on the core. Rings of uniform pressure along the axis are expanded in them; the mean displacement
of each ring along the axis is set to the plate's wherever the pressure is positive. Needs numpy.
"""

from __future__ import annotations

import numpy as np

RADIUS, CORE, SHEAR_MODULUS = 8e-3, 3e-3, 60e3
DEPTHS = (0.1e-3, 0.3e-3, 0.6e-3, 1.12e-3)


def shell_columns(n, nu, r):
    """u_r and u_t, and the stresses rr and rt over 2 G, of A, B, C, D at radius r of a shell of radius 1."""
    core = CORE / RADIUS / r
    powers = np.array([r ** (n + 1.0), r ** (n - 1.0), core**n, core ** (n + 2.0)])
    displacement = [
        [(n + 1) * (n - 2 + 4 * nu), n, n * (n + 3 - 4 * nu), -(n + 1)],
        [n + 5 - 4 * nu, 1, 4 - 4 * nu - n, 1],
    ]
    stress = [
        [(n + 1) * (n**2 - n - 2 - 2 * nu), n * (n - 1), -n * (n**2 + 3 * n - 2 * nu), (n + 1) * (n + 2)],
        [n**2 + 2 * n - 1 + 2 * nu, n - 1, n**2 - 2 + 2 * nu, -(n + 2)],
    ]
    return powers * displacement, powers / r * stress


def surface_compliance(n, nu):
    """u_r and u_t on the surface, times 2 G / radius, under unit stresses rr (column 0) and rt (column 1)."""
    if n == 0 and nu == 0.5:
        return np.zeros((2, 2))  # incompressible tissue has nowhere to go
    on_core, _ = shell_columns(n, nu, CORE / RADIUS)
    displacement, stress = shell_columns(n, nu, 1.0)
    if n == 0:  # radial: A and D alone
        a, d = np.linalg.solve([on_core[0, ::3], stress[0, ::3]], [0, 1])
        return np.array([[displacement[0, ::3] @ [a, d], 0], [0, 0]])
    rows = np.vstack([on_core, stress])
    columns = np.abs(rows).max(axis=0)
    sizes = np.abs(rows / columns).max(axis=1)[:, None]
    loads = np.eye(4)[:, 2:]
    return displacement / columns @ np.linalg.solve(rows / columns / sizes, loads / sizes)


def ring_integrals(x, degrees):
    """Integrals over each ring x[i] > x > x[i+1], x = cos theta, of x P_n and of (1 - x^2) P_n'."""
    legendre = [np.ones_like(x), x]
    for n in range(1, degrees + 2):
        legendre.append(((2 * n + 1) * x * legendre[n] - n * legendre[n - 1]) / (n + 1))
    legendre = np.array(legendre)
    k = np.arange(1, degrees + 2)[:, None]
    # int P_n for n = -1 .. degrees + 1, the first counted as 0
    integral = np.vstack([0 * x, x, (legendre[2:] - legendre[:-2]) / (2 * k + 1)])
    n = np.arange(degrees + 1)[:, None]
    below, above = integral[:-2], integral[2:]
    moment = ((n + 1) * above + n * below) / (2 * n + 1)
    slope = n * (below - moment)
    return (part[:, :-1] - part[:, 1:] for part in (moment, slope))


def force(depth, nu, rings=80, degrees=6000):
    """Force of the plate (N)."""
    x = np.cos(np.linspace(0, 1.15 * np.sqrt(depth / RADIUS), rings + 1))
    moment, slope = ring_integrals(x, degrees)
    n = np.arange(degrees + 1)[:, None]
    radial = -(2 * n + 1) / 2 * moment
    along = -(2 * n + 1) / (2 * np.maximum(n * (n + 1), 1)) * slope
    compliance = np.array([surface_compliance(int(degree), nu) for degree in n[:, 0]])
    u_r = compliance[:, 0, :1] * radial + compliance[:, 0, 1:] * along
    u_t = compliance[:, 1, :1] * radial + compliance[:, 1, 1:] * along
    share = x[:-1] - x[1:]
    # mean displacement of ring i towards the center under unit pressure on ring j (m/Pa)
    response = -(moment.T @ u_r + slope.T @ u_t) / share[:, None] * RADIUS / (2 * SHEAR_MODULUS)
    overlap = depth - RADIUS * (1 - 0.5 * (x[:-1] + x[1:]))
    for touching in range(rings, 0, -1):
        pressure = np.linalg.solve(response[:touching, :touching], overlap[:touching])
        if pressure.min() >= 0:
            return 2 * np.pi * RADIUS**2 * (pressure @ share[:touching])
    return 0.0


if __name__ == "__main__":
    for nu in (0.5, 0.495, 0.3):
        print(f"nu {nu}:", ", ".join(f"{force(depth, nu):.5f}" for depth in DEPTHS), "N")
