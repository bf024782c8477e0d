"""What the command line prints beside results: progress, warnings and refusals."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console

__all__ = ["console", "progress", "refuse", "show_warning"]


@contextmanager
def progress(what: str) -> Iterator[None]:
    """Report on stderr what is going on, once it takes more than a second."""
    terminal = Console(stderr=True)
    if terminal.is_terminal:
        with terminal.status(f"{what} ..."):
            yield
        return
    timer = threading.Timer(1.0, lambda: print(f"{what} ...", file=sys.stderr, flush=True))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def console() -> Console:
    """Return standard output; wide where it is no terminal, so that no line is cut."""
    terminal = Console(highlight=False)
    return terminal if terminal.is_terminal else Console(highlight=False, width=160)


def show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning as one line on stderr."""
    print(f"warning: {message}", file=sys.stderr)


def refuse(message: str, *, status: int = 2) -> int:
    """Print on one line of stderr what is wrong; return the exit status."""
    print("error: " + " ".join(message.split()), file=sys.stderr)
    return status
