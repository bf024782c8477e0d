"""`python -m quasirigid` and the command `quasirigid`."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command line and leave with its exit status; without the extra `cli`, say how to get it."""
    try:
        from .cli import run
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] not in ("typer", "rich", "click"):
            raise
        print("error: the command line needs typer and rich: pip install 'quasirigid[cli]'", file=sys.stderr)
        sys.exit(2)
    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()
