"""Progress of the preparation of a body, and of a hand that closes."""

from __future__ import annotations

import sys
from collections.abc import Callable

from .._progress import print_progress, reporter

__all__ = ["Progress", "as_progress", "stage_reporter"]

Progress = Callable[[str, float], object]

_LAST = ("solution", "closing")  # Stages that end the line which they share with those before.
_STEP = 0.05  # A stage is reported again when it is further by this share.


def as_progress(progress: Progress | bool | None) -> Progress | None:
    """Return the function to call: the caller's, one that prints to stderr for True, or None."""
    return reporter(progress, _print_stage)


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


def _print_stage(what: str, done: float) -> None:
    text = what if done == 0.0 else f"{what}: {done:.0%}"
    # The stages share one line of a terminal; elsewhere only their ends are told.
    if sys.stderr.isatty() or done == 0.0 or done >= 1.0:
        print_progress(text, is_last=done == 0.0 or (what in _LAST and done >= 1.0))
