"""Progress of the preparation of a body."""

from __future__ import annotations

import sys
from collections.abc import Callable

__all__ = ["Progress", "as_progress", "stage_reporter"]

Progress = Callable[[str, float], object]

_STEP = 0.05  # A stage is reported again when it is further by this share.


def as_progress(progress: Progress | bool | None) -> Progress | None:
    """Return the function to call: the caller's, one that prints to stderr for True, or None."""
    if progress is None or progress is False:
        return None
    if progress is not True and not callable(progress):
        raise TypeError(f"progress is {progress!r}, expected a function, True, False or None")
    return _print_line if progress is True else progress


def stage_reporter(progress: Progress | None) -> Callable[[str, float], None] | None:
    """Return what the core calls as it goes on: the progress, less often."""
    if progress is None:
        return None
    call = progress
    last: tuple[str, float] = ("", 0.0)

    def report(stage: str, done: float) -> None:
        nonlocal last
        if stage != last[0] or done >= 1.0 or done - last[1] >= _STEP:
            last = (stage, done)
            call(stage, done)

    return report


def _print_line(what: str, done: float) -> None:
    text = what if done == 0.0 else f"{what}: {done:.0%}"
    if sys.stderr.isatty():
        # The stages share one line.
        last = done == 0.0 or (what == "solution" and done >= 1.0)
        sys.stderr.write("\r" + text.ljust(24) + ("\n" if last else ""))
    elif done == 0.0 or done >= 1.0:
        sys.stderr.write(text + "\n")
    sys.stderr.flush()
