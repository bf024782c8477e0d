"""Print the numbers of src/reference/layer.rs: point load and rigid sphere on a layer bonded to a rigid base.

The layer of thickness h has the Hankel symbol U(k) = (1 - nu) / (G k) W(k h). A point load displaces its
surface by K (1/r - phi(r/h) / h), phi(rho) = int (1 - W(t)) J0(rho t) dt. A sphere leads to Fredholm's
equation for the density f on the contact radius a (Hayes, Keer, Herrmann, Mockros 1972):

    f(x) - 1/pi int_0^a f(t) [k(x - t) + k(x + t)] dt = d - x^2 / R,   k(y) = int (1 - W(s h)) cos(s y) ds,

with f(a) = 0 and the force 2 E* int f dx. Needs mpmath and numpy.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np

mp.mp.dps = 30
END = 50  # 1 - W(t) falls as t^2 exp(-2 t)


def one_minus_symbol(t: mp.mpf, nu: mp.mpf) -> mp.mpf:
    upper = (3 - 4 * nu) * mp.sinh(2 * t) - 2 * t
    return 1 - upper / ((3 - 4 * nu) * mp.cosh(2 * t) + 2 * t**2 + 5 - 12 * nu + 8 * nu**2)


def correction(rho: mp.mpf, nu: mp.mpf) -> mp.mpf:
    """phi(rho)."""
    return mp.quad(lambda t: one_minus_symbol(t, nu) * mp.besselj(0, rho * t), mp.linspace(0, END, END + 1))


# Gauss points t over (0, END), and weights times 1 - W(t) of the incompressible layer.
T, WEIGHTS = (0.5 * END * part for part in np.polynomial.legendre.leggauss(400))
T = T + 0.5 * END
WEIGHTS = WEIGHTS * np.array([float(one_minus_symbol(mp.mpf(t), mp.mpf("0.5"))) for t in T])


def indentation(thickness: float, count: int = 24) -> tuple[float, float]:
    """Thinness sqrt(R d) / h and force over Hertz's at contact radius 1; R and E* cancel."""
    x, w = (0.5 * part for part in np.polynomial.legendre.leggauss(count))
    x = x + 0.5

    def kernel(y):
        return np.cos(np.multiply.outer(y, T / thickness)) @ WEIGHTS / thickness

    def row(at):
        return (kernel(at - x) + kernel(at + x)) * w / np.pi

    matrix = np.eye(count) - np.array([row(at) for at in x])
    flat, round_ = np.linalg.solve(matrix, np.stack([np.ones(count), x**2], axis=1)).T
    depth = (1 + row(1.0) @ round_) / (1 + row(1.0) @ flat)  # times R: f(1) = 0
    force = 2 * (w @ (depth * flat - round_))
    return np.sqrt(depth) / thickness, force / (4 / 3 * depth**1.5)


def force_ratio(thinness: float) -> float:
    """Force over Hertz's, by bisection for the thickness."""
    low, high = 0.1, 100.0
    for _ in range(60):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if indentation(middle)[0] > thinness else (low, middle)
    return indentation(low)[1]


if __name__ == "__main__":
    for nu in ("0.5", "0.45", "0.4", "0.3"):
        print(f"phi(0) at nu = {nu}: {mp.nstr(correction(mp.mpf(0), mp.mpf(nu)), 7)}")
    for rho in ("0.1", "0.5", "1", "2", "3"):
        value = 1 / mp.mpf(rho) - correction(mp.mpf(rho), mp.mpf("0.5"))
        print(f"h u / K at r / h = {rho}, nu = 0.5: {mp.nstr(value, 7)}")
    for thinness in (0.3, 0.5, 0.7):
        print(f"force over Hertz's at sqrt(R d) / h = {thinness}: {force_ratio(thinness):.6f}")
