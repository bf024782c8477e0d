"""What a record of a contact keeps of the product and of what it was computed from."""

from __future__ import annotations

import json

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.io import as_plain, contact_record
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


def test_a_record_holds_all_of_what_is_like_an_array() -> None:
    pandas = pytest.importorskip("pandas")
    many = [0.5 * number for number in range(200)]
    frame = pandas.DataFrame({"a": many, "b": many})
    inputs = {"series": frame["a"], "frame": frame, "masked": np.ma.masked_equal([1, 2], 2)}
    expected = {"series": many, "frame": [[one, one] for one in many], "masked": [1, None]}
    assert as_plain(inputs) == expected
    days = pandas.Series(pandas.to_datetime(["2024-02-29"]))
    assert [day[:10] for day in as_plain(days)] == ["2024-02-29"]


def test_numbers_longer_than_those_of_python_become_those() -> None:
    found = as_plain([np.longdouble(1.5), np.array([0.25, np.nan], dtype=np.longdouble), np.float64])
    assert found == [1.5, [0.25, None], str(np.float64)]
    assert as_plain(np.clongdouble(2j)) == "2j"
