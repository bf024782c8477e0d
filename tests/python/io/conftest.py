"""Contacts to be saved and told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from edge_press import pressed_by_edge
from quasirigid.io import save_contact


@pytest.fixture(scope="module")
def folder(pressed: qr.Contact, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the pressed fingertip is saved to."""
    folder = tmp_path_factory.mktemp("saved")
    inputs = {"depth": {"value": np.float64(1.12e-3), "unit": "m"}, "file": Path("finger.ply")}
    save_contact(pressed, folder, inputs=inputs)
    return folder


@pytest.fixture(scope="module")
def on_edge() -> qr.Contact:
    """A ball pressed by an edge of a box."""
    return pressed_by_edge(qr.HalfSpace(), depth=1e-3)
