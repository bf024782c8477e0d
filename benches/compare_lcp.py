"""Time `quasirigid.solve_lcp` against peers on PyPI: same problems, same run, ratios.

A rigid sphere on an elastic half-space (G = 60 kPa, nu = 0.5) over a flat 0.8 mm grid, M = (R + R') / 2 as
most peers need symmetry, q the parabolic gap. Every answer is judged alike, by its natural residual
max |min(M_ii z_i, w_i)| / max(-q).

    pip install quantecon drake mujoco piqp scipy     # any of them; what is missing is left out
    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 RAYON_NUM_THREADS=1 python benches/compare_lcp.py
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
import quasirigid as qr

Solver = Callable[[np.ndarray, np.ndarray], np.ndarray]


def sphere_on_grid(side: int, radius: float, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Symmetrised response (m/N) of a side x side grid and the gap (m) under a sphere."""
    step = 0.8e-3
    ticks = (np.arange(side) - side // 2) * step
    x, y = (a.ravel() for a in np.meshgrid(ticks, ticks, indexing="ij"))
    index = np.arange(side * side).reshape(side, side)
    a, b = index[:-1, :-1].ravel(), index[1:, :-1].ravel()
    c, d = index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    surface = qr.Surface(np.column_stack([x, y, np.zeros_like(x)]), faces)
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    response = qr.response_matrix(surface, skin, np.arange(side * side))
    return np.ascontiguousarray(0.5 * (response + response.T)), (x * x + y * y) / (2 * radius) - depth


def peers() -> dict[str, Solver]:
    """Every peer that is installed."""
    found: dict[str, Solver] = {}
    try:
        from quantecon.optimize import lcp_lemke

        found["quantecon lcp_lemke"] = lambda M, q: lcp_lemke(M, q).z
    except ImportError:
        pass
    try:
        from pydrake.solvers import MathematicalProgram, UnrevisedLemkeSolver

        def drake(M: np.ndarray, q: np.ndarray) -> np.ndarray:
            program = MathematicalProgram()
            z = program.NewContinuousVariables(len(q))
            program.AddLinearComplementarityConstraint(M, q, z)
            result = UnrevisedLemkeSolver().Solve(program)
            return np.asarray(result.GetSolution(z))

        found["drake UnrevisedLemke"] = drake
    except ImportError:
        pass
    try:
        import mujoco

        def box_qp(M: np.ndarray, q: np.ndarray) -> np.ndarray:
            n = len(q)
            z, factor = np.zeros(n), np.zeros((n, n + 7))
            mujoco.mju_boxQP(z, factor, np.zeros(n, np.int32), M, q, np.zeros(n), np.full(n, 1e10))
            return z

        found["mujoco mju_boxQP"] = box_qp
    except ImportError:
        pass
    try:
        import piqp

        def interior_point(M: np.ndarray, q: np.ndarray) -> np.ndarray:
            solver = piqp.DenseSolver()
            solver.settings.eps_abs = solver.settings.eps_rel = 1e-12
            # In units of the deepest point, or its tolerances mean nothing.
            length, unit = float(np.max(-q)), float(M[0, 0])
            solver.setup(M / unit, q / length, x_l=np.zeros(len(q)))
            solver.solve()
            return np.maximum(solver.result.x, 0.0) * (length / unit)

        found["piqp"] = interior_point
    except ImportError:
        pass
    try:
        from scipy.optimize import nnls

        # min |L'z + L^-1 q| over z >= 0 has the same conditions.
        def least_squares(M: np.ndarray, q: np.ndarray) -> np.ndarray:
            scale = M[0, 0]
            factor = np.linalg.cholesky(M / scale)
            return nnls(factor.T, -np.linalg.solve(factor, q / scale), maxiter=10 * len(q))[0]

        found["scipy nnls"] = least_squares
    except ImportError:
        pass
    return found


def natural_residual(M: np.ndarray, q: np.ndarray, z: np.ndarray) -> float:
    if not np.all(np.isfinite(z)) or z.min() < 0:
        z = np.where(np.isfinite(z), z, 0.0)
    return float(np.abs(np.minimum(np.diag(M) * z, M @ z + q)).max() / (-q).max())


def best_of(solver: Solver, M: np.ndarray, q: np.ndarray, budget: float) -> tuple[float, np.ndarray]:
    """Shortest time (s) of as many runs as fit the budget (s), and the answer."""
    best, spent, runs = np.inf, 0.0, 0
    while runs == 0 or (spent < budget and runs < 20):
        start = time.perf_counter()
        z = solver(M, q)
        took = time.perf_counter() - start
        best, spent, runs = min(best, took), spent + took, runs + 1
    return best, z


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sides", type=int, nargs="+", default=[15, 30, 50, 71], help="nodes along a side")
    parser.add_argument("--budget", type=float, default=2.0, help="seconds for each solver and problem")
    arguments = parser.parse_args()
    # "auto" comes first: the others are measured by it.
    methods = ("auto", "lemke", "block_pivoting", "projected_cg")
    ours: dict[str, Solver] = {
        f"quasirigid {method}": lambda M, q, method=method: qr.solve_lcp(M, q, method=method).z
        for method in methods
    }
    plain = qr.LcpOptions(crash=False)
    ours["quasirigid lemke, no crash"] = lambda M, q: qr.solve_lcp(M, q, options=plain).z
    scenes = [(10e-3, depth, side) for side in arguments.sides for depth in (0.5e-3, 1.12e-3, 2e-3)]
    scenes += [(200e-3, 0.5e-3, side) for side in arguments.sides if side in (30, 50)]
    for radius, depth, side in scenes:
        M, q = sphere_on_grid(side, radius, depth)
        print(f"\nN = {side * side}, sphere {radius * 1e3:g} mm, depth {depth * 1e3:g} mm")
        auto = np.inf
        for name, solver in {**ours, **peers()}.items():
            try:
                seconds, z = best_of(solver, M, q, arguments.budget)
            except Exception as error:
                print(f"  {name:27} failed: {error}")
                continue
            auto = seconds if name == "quasirigid auto" else auto
            contacts, residual = int(np.count_nonzero(z > 1e-9 * z.max())), natural_residual(M, q, z)
            print(
                f"  {name:27} {seconds * 1e3:10.3f} ms  {seconds / auto:8.1f} x auto"
                f"  {contacts:4} contacts  residual {residual:.1e}"
            )


if __name__ == "__main__":
    main()
