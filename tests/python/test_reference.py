"""Closed forms and tables as Python sees them."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import pytest
from quasirigid import reference

MODULUS = reference.contact_modulus(shear_modulus=60e3, poisson_ratio=0.5)
SPHERE = reference.Hertz(radius=8e-3, contact_modulus=MODULUS)
PUNCH = reference.FlatPunch(radius=5e-3, contact_modulus=MODULUS)
CONE = reference.Cone(semi_angle=1.4, contact_modulus=MODULUS)


@pytest.mark.parametrize("indenter", [SPHERE, CONE])
def test_load_is_the_slope_of_the_energy(indenter: reference.Hertz | reference.Cone) -> None:
    approach, step = 0.5e-3, 1e-8
    slope = (indenter.energy(approach + step) - indenter.energy(approach - step)) / (2 * step)
    assert indenter.force(approach) == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize("indenter", [SPHERE, PUNCH, CONE])
def test_an_indenter_is_copied_and_shown_as_it_is_made(indenter: Any) -> None:
    shown = repr(indenter)
    assert repr(eval(shown, vars(reference))) == shown
    for again in (pickle.loads(pickle.dumps(indenter)), copy.copy(indenter), copy.deepcopy(indenter)):
        assert repr(again) == shown
        assert again.force(0.5e-3) == indenter.force(0.5e-3)


def test_pressures_end_where_the_contact_ends() -> None:
    approach = 0.5e-3
    assert SPHERE.pressure(approach, 0.0) == SPHERE.max_pressure(approach)
    for indenter, radius in [
        (SPHERE, SPHERE.contact_radius(approach)),
        (CONE, CONE.contact_radius(approach)),
        (PUNCH, 5e-3),
    ]:
        assert indenter.pressure(approach, 0.99 * radius) > 0 == indenter.pressure(approach, 1.01 * radius)
    assert SPHERE.approach(SPHERE.force(approach)) == pytest.approx(approach, rel=1e-14)
    assert PUNCH.force(approach) == pytest.approx(2 * 5e-3 * 240e3 * approach, rel=1e-14)
    assert PUNCH.displacement(approach, 10e-3) == pytest.approx(approach / 3, rel=1e-14)


def test_tables_hold_what_their_names_say() -> None:
    profile = reference.point_load_on_layer()
    assert list(profile) == [0.1, 0.5, 1.0, 2.0, 3.0]
    assert profile[1.0] < 0 < profile[0.5], "an incompressible layer bulges"
    thick, *_, thin = reference.sphere_on_layer()
    assert (thick.thinness, thin.thinness) == (0.3, 0.7)
    assert 1 < thick.force_ratio < thin.force_ratio
    first = reference.plate_on_cored_sphere()[0]
    assert (first.radius, first.core_radius, first.poisson_ratio) == (8e-3, 3e-3, 0.5)
    assert first.indentations[1.12e-3] == 1.297
    ratios = [force / SPHERE.force(depth) for depth, force in first.indentations.items()]
    assert ratios == sorted(ratios), "the core stiffens"
    stiff, soft = reference.ball_on_cored_sphere()
    assert (stiff.indenter_radius, first.indenter_radius) == (15e-3, float("inf"))
    for depth, force in soft.indentations.items():
        assert force < stiff.indentations[depth]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: reference.Hertz(radius=-1.0, contact_modulus=MODULUS), "radius is -1, .* above 0"),
        (lambda: reference.FlatPunch(radius=1.0, contact_modulus=float("nan")), "contact_modulus is NaN, .*"),
        (lambda: reference.Cone(semi_angle=2.0, contact_modulus=MODULUS), r"semi_angle is 2, .* pi/2 rad"),
        (
            lambda: reference.contact_modulus(shear_modulus=60e3, poisson_ratio=0.7),
            r"poisson_ratio is 0\.7, expected a number from 0 to 0\.5",
        ),
    ],
)
def test_what_no_body_has_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_physics_has_names() -> None:
    with pytest.raises(TypeError, match="positional"):
        reference.Hertz(8e-3, MODULUS)  # type: ignore[misc]
