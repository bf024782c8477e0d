"""Numbers as words, and rows as lines of a table."""

from __future__ import annotations

from collections.abc import Sequence

from .._text import as_percent

__all__ = ["as_error", "as_time", "markdown"]


def as_error(error: float | None, *, signed: bool = False) -> str:
    """Return the size of a relative error, or the error with its sign, of two figures."""
    return as_percent(error if error is None or signed else abs(error), figures=2, signed=signed)


def as_time(seconds: float | None) -> str:
    """Return a time in ms or s."""
    if seconds is None:
        return "-"
    return f"{seconds * 1e3:.3g} ms" if seconds < 0.9995 else f"{seconds:.3g} s"


def markdown(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    every = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(cell.replace("|", "/") for cell in line) + " |" for line in every)
