"""The ball that responses are prepared for."""

from __future__ import annotations

import pytest
import quasirigid as qr
from shapes import ball


@pytest.fixture(scope="module")
def surface() -> qr.Surface:
    return qr.Surface(*ball(8e-3, 3))
