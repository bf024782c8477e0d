"""Ctrl-C while the command line imports the package: one line in place of a traceback."""

from __future__ import annotations

import sys
from pathlib import PurePath
from types import TracebackType

__all__: list[str] = []

# What `sys.argv` begins with while `quasirigid` or `python -m quasirigid` imports the package.
_PROGRAMS = ("quasirigid", "-m")


def _say_interrupted(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if issubclass(kind, KeyboardInterrupt):
        print("error: interrupted", file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)


if sys.argv and PurePath(sys.argv[0]).stem in _PROGRAMS and sys.excepthook is sys.__excepthook__:
    sys.excepthook = _say_interrupted
