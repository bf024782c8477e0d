"""The test meshes, which are no part of the project: `QUASIRIGID_DATA` names their folder."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

DATA = Path(os.environ.get("QUASIRIGID_DATA", Path(__file__).parents[3] / "../shared/data"))
MISSING = f"no meshes in {DATA} (set QUASIRIGID_DATA)"


def hand_file(name: str, ending: str = ".ply") -> Path:
    """A file in the folder of hands; the test is skipped where it is missing."""
    path = DATA / "hands" / (name + ending)
    if not path.is_file():
        pytest.skip(MISSING)
    return path
