"""What tables of text are made of."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["aligned", "as_percent"]


def aligned(columns: Sequence[Sequence[str]], *, left: bool = False) -> list[str]:
    """Return the lines of a table: the first column to the left, the others to the right unless `left`."""
    widths = [max(map(len, column)) for column in columns]
    place = str.ljust if left else str.rjust
    return [
        "  ".join([first.ljust(widths[0]), *map(place, cells, widths[1:])]).rstrip()
        for first, *cells in zip(*columns, strict=True)
    ]


def as_percent(error: float | None, *, figures: int, signed: bool = False) -> str:
    """Return a relative error in percent, of so many figures below ten; a dash where there is none."""
    if error is None:
        return "-"
    percent = 100.0 * error
    sign = "+" if signed else ""
    is_small = abs(percent) < 10.0 - 0.5 * 10.0 ** (1 - figures)
    return f"{percent:{sign}.{figures}g} %" if is_small else f"{percent:{sign}.0f} %"
