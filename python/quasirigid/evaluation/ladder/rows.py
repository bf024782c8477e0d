"""The rows of `accuracy`: one way to solve one problem, its errors, its price and its bound."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

__all__ = ["limit_of", "make_row", "mark_knee", "refused", "timed"]

_COLUMNS = (
    *("scene", "response", "discretization", "solver", "mesh", "cells_per_radius", "target_error", "depth"),
    *("nodes", "force", "true_force", "force_error", "area_error", "max_pressure_error"),
    *("estimated_force_error", "seconds", "setup_seconds", "truth", "truth_accuracy", "limit"),
    *("within", "ratio", "knee", "ok", "note"),
)

Made = TypeVar("Made")


def make_row(**given: Any) -> dict[str, Any]:
    """Return a row of all columns; what is not given is None.

    A row is off where its force is further from the truth than `limit`, or known not at all.
    """
    row = dict.fromkeys(_COLUMNS) | {"knee": False, "ok": True, "note": ""} | given
    if row["limit"] is not None and "ok" not in given:
        error = row["force_error"]
        row["ok"] = error is not None and abs(error) <= row["limit"]
    return row


def limit_of(*, cells: float, target: float | None, accuracy: float) -> float:
    """Return how far a force may be from a truth of an `accuracy`.

    Twice the target of a refined contact; on a mesh as it is one cell of the contact's radius.
    """
    return accuracy + (2.0 * target if target is not None else 1.0 / (cells or 1.0))


def refused(error: BaseException, **given: Any) -> dict[str, Any]:
    """Return the row of a problem that ended in an exception."""
    return make_row(**given, ok=False, note=f"{type(error).__name__}: {' '.join(str(error).split())}")


def timed(make: Callable[[], Made]) -> tuple[Made, float]:
    """Return what is made and the median time (s) of up to three times; what is slow is made once."""
    seconds = []
    for _ in range(3):
        started = time.perf_counter()
        made = make()
        seconds.append(time.perf_counter() - started)
        if sum(seconds) > 0.2:
            break
    return made, float(np.median(seconds))


def mark_knee(rows: Sequence[dict[str, Any]]) -> None:
    """Mark the row at the knee of error against time: beyond it a smaller error costs more than it did.

    Of the rows that no other beats in both, the one farthest below the line from the cheapest to the most
    exact, in logarithms.
    """
    known = [row for row in rows if row["force_error"] and row["seconds"]]
    best: list[dict[str, Any]] = []
    for row in sorted(known, key=lambda one: (one["seconds"], abs(one["force_error"]))):
        if not best or abs(row["force_error"]) < abs(best[-1]["force_error"]):
            best.append(row)
    if len(best) < 3:
        return
    points = [(math.log(row["seconds"]), math.log(abs(row["force_error"]))) for row in best]
    (x0, y0), (x1, y1) = points[0], points[-1]
    below = [(y0 - y) / (y0 - y1) - (x - x0) / (x1 - x0) for x, y in points]
    best[int(np.argmax(below))]["knee"] = True
