"""A case: what is asked, what must come out, and how what came out is judged."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ...errors import QuasirigidError

__all__ = ["Case", "Outcome", "blank_row", "ends_with", "holds", "near", "row_of"]

_COLUMNS = ("group", "case", "expected", "found", "error", "limit", "seconds", "ok", "note")
# Longest time of a case (s), some ten times what the longest takes on a quiet machine.
LONGEST = 30.0


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What came out of a case, beside what was expected."""

    expected: str
    found: str
    ok: bool
    error: float | None = None
    limit: float | None = None


@dataclass(frozen=True, kw_only=True)
class Case:
    """One question with its judge.

    Attributes
    ----------
    group, name : str
        What it is of, and which.
    judge : callable
        Does the work and returns an `Outcome`.
    quick : bool
        Whether a quick run has it too.
    alone : float, optional
        Longest time (s) in a process of its own, which is ended then; for what may take all time or memory.
    """

    group: str
    name: str
    judge: Callable[[], Outcome]
    quick: bool = False
    alone: float | None = None


def near(expected: str, error: float, limit: float) -> Outcome:
    """Return the outcome of an answer that is `error` off where `limit` is allowed, both relative."""
    error, limit = float(error), float(limit)
    return Outcome(expected=expected, found=f"{error:.1e} off", ok=error <= limit, error=error, limit=limit)


def holds(expected: str, found: str, ok: bool) -> Outcome:
    """Return the outcome of a statement that is true or not."""
    return Outcome(expected=expected, found=found, ok=bool(ok))


def ends_with(work: Callable[[], object], kind: type[QuasirigidError], words: str) -> Outcome:
    """Return the outcome of work that must end in an error of a kind whose message has certain words."""
    expected = f"{kind.__name__}: ... {words} ..."
    try:
        made = work()
    except kind as error:
        message = " ".join(str(error).split())
        return Outcome(expected=expected, found=f"{type(error).__name__}: {message}", ok=words in message)
    return Outcome(expected=expected, found=f"no error: {made!r}", ok=False)


def blank_row(case: Case) -> dict[str, Any]:
    """Return the row of a case before it is carried out."""
    return dict.fromkeys(_COLUMNS) | {"group": case.group, "case": case.name, "note": ""}


def row_of(case: Case) -> dict[str, Any]:
    """Carry out a case; what it did not expect to be raised makes a row that is off, with its words."""
    started = time.perf_counter()
    row = blank_row(case)
    try:
        outcome = case.judge()
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:
        # A panic of the core is no `Exception`.
        words = f"{type(error).__name__}: {' '.join(str(error).split())}"
        row |= {"expected": "an answer", "found": words, "ok": False, "note": "unexpected"}
    else:
        row |= vars(outcome)
    row["seconds"] = time.perf_counter() - started
    if row["seconds"] > LONGEST:
        row |= {"ok": False, "note": f"took more than {LONGEST:g} s"}
    return row
