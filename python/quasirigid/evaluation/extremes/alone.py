"""Cases that may take all time or memory, each in a process of its own that can be ended."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from typing import Any

from .case import Case, blank_row

__all__ = ["row_of_alone"]

_PROGRAM = "import sys; from quasirigid.evaluation.extremes.run import print_row; print_row(*sys.argv[1:])"


def row_of_alone(case: Case) -> dict[str, Any]:
    """Carry out a case in another process; one that is not done in its time makes a row that is off."""
    started = time.perf_counter()
    row = blank_row(case)
    command = [sys.executable, "-c", _PROGRAM, case.group, case.name]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=case.alone, check=False)
    except subprocess.TimeoutExpired:
        words = f"nothing in {case.alone:g} s"
        row |= {"expected": "an answer", "found": words, "ok": False, "note": "ended from outside"}
    else:
        if done.returncode == 0:
            return dict(json.loads(done.stdout.splitlines()[-1]))
        last = (done.stderr.strip().splitlines() or ["no words"])[-1]
        words = f"status {done.returncode}: {last}"
        row |= {"expected": "an answer", "found": words, "ok": False, "note": "unexpected"}
    row["seconds"] = time.perf_counter() - started
    return row
