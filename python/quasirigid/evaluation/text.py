"""Numbers as words, and rows as lines of a table."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["as_error", "as_time", "markdown", "plain"]


def as_error(error: float | None, *, signed: bool = False) -> str:
    """Return a relative error in percent, two figures of it."""
    if error is None:
        return "-"
    percent = 100 * (error if signed else abs(error))
    sign = "+" if signed else ""
    return f"{percent:{sign}.0f} %" if abs(percent) >= 9.95 else f"{percent:{sign}.2g} %"


def as_time(seconds: float | None) -> str:
    """Return a time in ms or s."""
    if seconds is None:
        return "-"
    return f"{seconds * 1e3:.3g} ms" if seconds < 0.9995 else f"{seconds:.3g} s"


def markdown(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    every = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(cell.replace("|", "/") for cell in line) + " |" for line in every)


def plain(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table in columns of equal width."""
    widths = [max(len(line[at]) for line in (head, *lines)) for at in range(len(head))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in (head, *lines)
    )
