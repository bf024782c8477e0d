"""Where progress goes: to the caller's function, or to stderr."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from typing import TypeVar

__all__ = ["print_progress", "reporter"]

_Report = TypeVar("_Report", bound=Callable[..., object])


def reporter(progress: _Report | bool | None, printed: _Report) -> _Report | None:
    """Return the function to call: the caller's, `printed` for True, or None."""
    if progress is None or progress is False:
        return None
    if progress is True:
        return printed
    if not callable(progress):
        raise TypeError(f"progress is {progress!r}, expected a function, True, False or None")
    return progress


def print_progress(text: str, *, is_last: bool) -> None:
    """Print how far it is on stderr: on one line of a terminal up to the last, elsewhere a line each."""
    if sys.stderr.isatty():
        # Blanks to the end of the line, as the text before may have been longer.
        width = shutil.get_terminal_size().columns - 1
        sys.stderr.write("\r" + (text if is_last else text[:width]).ljust(width) + "\n" * is_last)
    else:
        sys.stderr.write(text + "\n")
    sys.stderr.flush()
