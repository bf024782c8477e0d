"""How far a table is."""

from __future__ import annotations

import sys
from collections.abc import Callable

__all__ = ["TableProgress", "table_reporter"]

TableProgress = Callable[[str, int, int], object]


def table_reporter(progress: TableProgress | bool | None) -> TableProgress:
    """Return the function to call after each case: the caller's, one that prints for True, or none."""
    if progress is None or progress is False:
        return lambda name, done, total: None
    if progress is not True and not callable(progress):
        raise TypeError(f"progress is {progress!r}, expected a function, True, False or None")
    return _print_line if progress is True else progress


def _print_line(name: str, done: int, total: int) -> None:
    text = f"{done} of {total}: {name}"
    if sys.stderr.isatty():
        # One line for all.
        sys.stderr.write("\r" + text[:100].ljust(100) + ("\n" if done == total else ""))
    else:
        sys.stderr.write(text + "\n")
    sys.stderr.flush()
