"""The built-in hand and a handle in it."""

import pytest
import quasirigid as qr
from handles import ENDS, RADIUS, skin
from shapes import AS_GIVEN


@pytest.fixture(scope="module")
def hand():
    return qr.models.hand(edge_length=4e-3)


@pytest.fixture(scope="module")
def handle(hand):
    return qr.Obstacle.capsule(*ENDS, RADIUS).placed(hand.posed("relaxed").palm)


@pytest.fixture(scope="module")
def held(hand, handle):
    return qr.close_hand(hand, handle, skin(), force=16.0, product_mass=0.2, options=AS_GIVEN)
