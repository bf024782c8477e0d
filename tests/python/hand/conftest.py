"""Published hands that several tests look at."""

from __future__ import annotations

import pytest
import quasirigid as qr
from hands import RIGS
from shared_meshes import hand_file


@pytest.fixture(scope="module", params=RIGS)
def rigged(request: pytest.FixtureRequest) -> qr.Hand:
    return qr.read_hand(hand_file(request.param))


@pytest.fixture(scope="module")
def hand() -> qr.Hand:
    return qr.read_hand(hand_file("makehuman_male_right_13k"))
