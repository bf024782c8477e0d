"""What a record of a contact keeps of the product and of what it was computed from."""

from __future__ import annotations

import json

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.io import contact_record
from shapes import AS_GIVEN, SKIN, ball


@pytest.mark.parametrize(
    "shape",
    [
        qr.Obstacle.half_space([0.0, 0.0, -0.5], [0.0, 3.0, 4.0]),
        qr.Obstacle.sphere([0.1, 0.2, 0.3], 0.02),
        qr.Obstacle.box([0.01, 0.02, 0.03]),
        qr.Obstacle.capsule([0.0, 0.0, 0.0], [0.1, 0.0, 0.2], 0.03),
        qr.Obstacle.cylinder(0.01, 0.04),
    ],
    ids=lambda shape: shape.kind,
)
def test_a_record_holds_what_makes_its_product_again(shape: qr.Obstacle) -> None:
    product = shape.moved([[0.0, -0.8, 0.6], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]], [1.0, -2.0, -3.0])
    contact = qr.solve_contact(qr.Surface(*ball(8e-3, 0)), product, SKIN, options=AS_GIVEN)
    record = json.loads(json.dumps(contact_record(contact)["product"]))
    made = getattr(qr.Obstacle, record["kind"])(
        **{name: entry["value"] for name, entry in record["shape"].items()}
    )
    again = made.moved(record["rotation"], record["translation"]["value"])
    points = np.random.default_rng(0).uniform(-4.0, 4.0, (50, 3))
    for found, wanted in zip(again.signed_distance(points), product.signed_distance(points), strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-14)
