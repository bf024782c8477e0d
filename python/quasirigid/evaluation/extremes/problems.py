"""Complementarity problems that are known to be hard, and others whose solution is chosen first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ..._arrays import Floats
from ..memo import remembered

__all__ = ["Problem", "all_in_contact", "infeasible", "problems"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """Find ``w = M z + q, w >= 0, z >= 0, w'z = 0``.

    Attributes
    ----------
    name : str
        Where it comes from.
    matrix, vector : array
        M (n, n) and q (n,).
    solution : (n,) array, optional
        z where it is the only one and known.
    symmetric : bool
        Whether M is symmetric positive semidefinite.
    """

    name: str
    matrix: Floats = field(repr=False)
    vector: Floats = field(repr=False)
    solution: Floats | None = field(default=None, repr=False)
    symmetric: bool = False


def problems() -> Iterator[Problem]:
    """Make the problems of moderate size."""
    yield from _exponential()
    for count in (3, 9, 51):
        # Murty's circulant, on which single exchanges in a fixed order run in circles (Kostreva 1979).
        matrix = np.eye(count) + 2 * np.roll(np.eye(count), 1, axis=0)
        solution = np.full(count, 1 / 3)
        yield Problem(name=f"Kostreva, n = {count}", matrix=matrix, vector=-np.ones(count), solution=solution)
    yield from _ties()
    yield from _scaled()
    yield from _semidefinite()


def _exponential() -> Iterator[Problem]:
    """Make those on which pivots grow as 2^n: Murty 1978, Fathi 1979, Chandrasekaran, Pang, Stone 1987."""
    for count in (8, 20, 50):
        below = np.eye(count) + 2 * np.tril(np.ones((count, count)), -1)
        first = np.zeros(count)
        first[0] = 1.0
        powers = -np.cumsum(2.0 ** np.arange(count, 0, -1))
        alternating = (np.arange(count) % 2 == 0).astype(np.float64)
        # With q = -1 the first unknown alone carries; of the transpose, the last.
        yield Problem(name=f"Murty, n = {count}", matrix=below, vector=-np.ones(count), solution=first)
        yield Problem(name=f"Murty with powers of 2, n = {count}", matrix=below, vector=powers)
        yield Problem(
            name=f"Stone, n = {count}",
            matrix=below.T.copy(),
            vector=-np.ones(count),
            solution=first[::-1].copy(),
        )
        yield Problem(name=f"Stone with powers of 2, n = {count}", matrix=below.T.copy(), vector=powers)
        product = below @ below.T
        yield Problem(
            name=f"Fathi, n = {count}", matrix=product, vector=-np.ones(count), solution=first, symmetric=True
        )
        yield Problem(
            name=f"Fathi with a chosen answer, n = {count}",
            matrix=product,
            vector=-product @ alternating,
            solution=alternating,
            symmetric=True,
        )


def _ties() -> Iterator[Problem]:
    """Make problems with many equal ratios, and with unknowns where both z and w are 0."""
    matrix = np.array([[11.0, 0, 10, -1], [0, 11, 10, -1], [10, 10, 21, -1], [1, 1, 1, 0]])
    yield Problem(name="tied rows, n = 4", matrix=matrix, vector=np.array([50.0, 50, 50, -6]))
    for count in (40, 200):
        equal = np.eye(count) + 1.0
        solution = np.full(count, 1 / (count + 1))
        yield Problem(
            name=f"all rows alike, n = {count}",
            matrix=equal,
            vector=-np.ones(count),
            solution=solution,
            symmetric=True,
        )
        chain = 2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
        # Every second run of unknowns is 0 with w = 0 beside it: nothing is strict.
        chosen = np.where(np.arange(count) // 5 % 2 == 0, 1.0, 0.0)
        slack = np.where(chosen > 0, 0.0, np.arange(count) % 2)
        yield Problem(
            name=f"chain with z = w = 0, n = {count}",
            matrix=chain,
            vector=slack - chain @ chosen,
            solution=chosen,
            symmetric=True,
        )


def _scaled() -> Iterator[Problem]:
    """Make rows from 1e-12 to 1e12, and everything in other units."""
    count = 25
    random = np.random.default_rng(3)
    half = random.uniform(-1, 1, (count, count))
    matrix = half @ half.T / count + np.eye(count)
    chosen = np.where(np.arange(count) % 3 == 0, 0.0, random.uniform(0.5, 1.5, count))
    slack = np.where(chosen > 0, 0.0, random.uniform(0.5, 1.5, count))
    vector = slack - matrix @ chosen
    rows = 10.0 ** np.linspace(-12, 12, count)
    random.shuffle(rows)
    yield Problem(
        name="rows times 1e-12 to 1e12", matrix=rows[:, None] * matrix, vector=rows * vector, solution=chosen
    )
    yield Problem(
        name="rows and columns times 1e-6 to 1e6",
        matrix=matrix * np.outer(np.sqrt(rows), np.sqrt(rows)),
        vector=np.sqrt(rows) * vector,
        solution=chosen / np.sqrt(rows),
        symmetric=True,
    )
    for factor, other in ((1e-100, 1.0), (1e100, 1.0), (1.0, 1e-100), (1.0, 1e100), (1e-12, 1e12)):
        yield Problem(
            name=f"M times {factor:g}, q times {other:g}",
            matrix=factor * matrix,
            vector=other * vector,
            solution=other / factor * chosen,
            symmetric=True,
        )


def _semidefinite() -> Iterator[Problem]:
    """Make matrices of half their rank; a solution exists, its M z alone is the only one."""
    for count in (6, 40, 120):
        random = np.random.default_rng(count)
        thin = random.uniform(-1, 1, (count, count // 2))
        chosen = np.where(np.arange(count) % 2 == 0, random.uniform(0.5, 1.5, count), 0.0)
        slack = np.where(chosen > 0, 0.0, random.uniform(0.5, 1.5, count))
        matrix = thin @ thin.T
        yield Problem(
            name=f"semidefinite, n = {count}", matrix=matrix, vector=slack - matrix @ chosen, symmetric=True
        )


def infeasible() -> Iterator[Problem]:
    """Make semidefinite problems without a solution: along (1, 1, ..) M does nothing and q pushes."""
    for count in (2, 30):
        random = np.random.default_rng(count)
        thin = random.integers(-3, 4, (count, max(1, count // 2))).astype(np.float64)
        thin[-1] -= thin.sum(axis=0)
        vector = -np.ones(count)
        yield Problem(
            name=f"semidefinite without a solution, n = {count}", matrix=thin @ thin.T, vector=vector
        )


@remembered  # the matrix of the largest takes 200 MB
def all_in_contact(count: int) -> Problem:
    """Return a problem whose every unknown is above 0, its matrix falling off along a line."""
    place = np.arange(count) / 20.0
    matrix = np.exp(-np.abs(place[:, None] - place))
    chosen = 1.0 + 0.5 * np.sin(np.arange(count))
    return Problem(
        name=f"all in contact, n = {count}",
        matrix=matrix,
        vector=-matrix @ chosen,
        solution=chosen,
        symmetric=True,
    )
