"""Quantities on the command line."""

from __future__ import annotations

import math

import pytest
from quasirigid.cli.quantities import (
    ANGLE,
    COMPLIANCE,
    LENGTH,
    STRESS,
    QuantityError,
    parse_numbers,
    parse_quantities,
)


@pytest.mark.parametrize(
    ("text", "units", "value"),
    [
        ("1.12mm", LENGTH, 1.12e-3),
        (" -.5 cm ", LENGTH, -5e-3),
        ("2um", LENGTH, 2e-6),
        ("1e-3m", LENGTH, 1e-3),
        ("60kPa", STRESS, 60e3),
        ("0.06MPa", STRESS, 60e3),
        ("90deg", ANGLE, math.pi / 2),
        ("0.8mm/N", COMPLIANCE, 0.8e-3),
    ],
)
def test_a_number_with_its_unit_becomes_si(text: str, units: dict[str, float], value: float) -> None:
    assert parse_quantities(text, 1, units, "--option") == pytest.approx([value], rel=1e-15)


def test_a_unit_counts_for_the_bare_numbers_before_it() -> None:
    assert parse_quantities("1,2,-20mm", 3, LENGTH, "--translate") == pytest.approx([1e-3, 2e-3, -20e-3])
    assert parse_quantities("1m,2,3mm", 3, LENGTH, "--translate") == pytest.approx([1.0, 2e-3, 3e-3])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1.12", "--depth: '1.12' has no unit, expected m, cm, mm, um or inch after it, as in 1.12mm"),
        # In metres, it may be: no example makes millimetres of it.
        ("0.002", "'0.002' has no unit, expected m, cm, mm, um or inch after it, as in 1.12mm"),
        ("1.12kPa", "'1.12kPa' is not a number with a unit"),
        ("deep", "'deep' is not a number with a unit"),
        ("", "'' is not a number with a unit"),
        ("1mm,2mm", "has 2 values, expected one value"),
        ("1e999mm", "too large"),
        ("nanmm", "'nanmm' is not a number"),
    ],
)
def test_a_quantity_that_is_not_understood_is_refused(text: str, message: str) -> None:
    with pytest.raises(QuantityError) as refusal:
        parse_quantities(text, 1, LENGTH, "--depth")
    assert message in str(refusal.value)


def test_bare_numbers_at_the_end_of_a_vector_are_refused() -> None:
    with pytest.raises(QuantityError, match="has no unit"):
        parse_quantities("0mm,0,-20", 3, LENGTH, "--translate")


def test_directions_are_plain_numbers() -> None:
    assert parse_numbers("0, 0,-1", 3, "--direction") == [0.0, 0.0, -1.0]
    with pytest.raises(QuantityError, match="'1mm' is not a plain number"):
        parse_numbers("0,0,1mm", 3, "--direction")
    with pytest.raises(QuantityError, match="has 2 values, expected 3 values"):
        parse_numbers("0,1", 3, "--direction")
