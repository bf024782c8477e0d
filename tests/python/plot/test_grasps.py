"""Pictures of a hand and what it holds."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, SKIN

pytest.importorskip("matplotlib")

MM = 1e3


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_the_hand_is_seen_through_a_product_that_hides_it() -> None:
    hand, size = qr.models.hand(edge_length=5e-3), 1.0
    palm = hand.posed("relaxed").palm
    product = qr.models.rounded_box(size=(size,) * 3, edge_radius=0.1 * size, edge_length=0.1 * size)
    before = palm[:3, 3] + 0.06 * palm[:3, 1] + (0.5 * size + 0.035) * palm[:3, 2]
    grasp = qr.close_hand(
        hand, product.moved(palm[:3, :3], before), SKIN, force={"index": 1.0}, options=AS_GIVEN, throw=False
    )
    length = MM * hand.length
    for ax in grasp.plot().axes[:2]:
        left, right, bottom, top = ax.get_images()[0].get_extent()
        assert max(right - left, top - bottom) < 2.5 * length
        picture = np.asarray(ax.get_images()[0].get_array())
        red, blue, drawn = picture[..., 0], picture[..., 2], picture[..., 3] > 0.0
        # Skin is red, and a product bluish.
        seen = (drawn & (red - blue > 0.05)).mean()
        assert seen * (right - left) * (top - bottom) > 0.1 * length**2
        assert (drawn & (blue > red)).any()
