"""Progress of the preparation of a body."""

from __future__ import annotations

import sys
from collections.abc import Callable

from .. import _core

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


def stage_reporter(
    progress: Progress | None, skin_vertices: int, bone_vertices: int, nodes: int
) -> Callable[[str, float], None] | None:
    """Return what the core calls as it goes on; it reports memory and operations first."""
    if progress is None:
        return None
    call = progress
    needed, operations = _core.Skin.body_cost(skin_vertices, bone_vertices, nodes)
    cost = (
        f"body of {skin_vertices} skin and {bone_vertices} bone vertices, {nodes} of them loaded: "
        f"{needed / 1e9:.2g} GB, {operations:.1e} operations"
    )
    last: tuple[str, float] = ("", 0.0)

    def report(stage: str, done: float) -> None:
        nonlocal last
        if not last[0]:
            # With the first sign of work, so that a body that is refused says only why.
            call(cost, 0.0)
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
