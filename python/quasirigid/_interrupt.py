"""Ctrl-C while the command line imports the package: one line in place of a traceback."""

from __future__ import annotations

import sys

TYPE_CHECKING = False  # `typing` takes a while to import
if TYPE_CHECKING:
    from types import FrameType, TracebackType

__all__ = ["heard_interrupt"]

# What `sys.argv` begins with while `quasirigid` or `python -m quasirigid` imports the package.
_PROGRAMS = ("quasirigid", "quasirigid.exe", "-m")
_heard: list[int] = []


def heard_interrupt() -> bool:
    """Return whether Ctrl-C cut an import off; what the import raises then is no fault of the library."""
    return bool(_heard)


def _hear(number: int, frame: FrameType | None) -> None:
    _heard.append(number)
    raise KeyboardInterrupt


def _say_interrupted(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    # Extensions whose import is cut off raise an ImportError of their own.
    if issubclass(kind, KeyboardInterrupt) or (_heard and issubclass(kind, ImportError)):
        print("error: interrupted", file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)


_program = sys.argv[0].replace("\\", "/").rpartition("/")[2] if sys.argv else ""
if _program in _PROGRAMS and sys.excepthook is sys.__excepthook__:
    sys.excepthook = _say_interrupted
    import signal  # takes a while too

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _hear)
