"""`python -m quasirigid` and the command `quasirigid`."""

from __future__ import annotations

import os
import sys
import warnings

_INTERRUPTED = 130


def main() -> None:
    """Run the command line and leave with its exit status; without the extra `cli`, say how to get it."""
    try:
        status = _run()
    except KeyboardInterrupt:
        # While libraries are imported.
        print("error: interrupted", file=sys.stderr)
        status = _INTERRUPTED
    if status == _INTERRUPTED:
        # What is written is whole by now: who presses Ctrl-C need not wait until memory is freed.
        sys.stderr.flush()
        os._exit(status)
    sys.exit(status)


def _run() -> int:
    try:
        from .cli import run
        from .errors import QuasirigidWarning
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] not in ("typer", "rich", "click"):
            raise
        print("error: the command line needs typer and rich: pip install 'quasirigid[cli]'", file=sys.stderr)
        return 2
    # Not Python's filter but --quiet says what is told.
    warnings.simplefilter("default", QuasirigidWarning)
    return run(sys.argv[1:])


if __name__ == "__main__":
    main()
