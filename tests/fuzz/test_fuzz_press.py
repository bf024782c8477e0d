"""Presses of every kind: finite figures that repeat to the bit, or an error with a name."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import quasirigid as qr
from fuzz_profile import EXAMPLES
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import ball, grid

pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")


@cache
def surface_of(name: str) -> qr.Surface:
    match name:
        case "tip":
            tip = qr.models.fingertip(edge_length=2.5e-3)
            return tip.with_skin_mask(qr.skin_without_caps(tip))
        case "ball":
            return qr.Surface(*ball(8e-3, 2))
        case "sheet":
            vertices, faces = grid(12, 1e-3)
            # Normals to -z, where the obstacles come from.
            return qr.Surface(vertices, faces[:, ::-1])
        case _:
            return qr.Surface(ball(8e-3, 2)[0] * [1.0, 0.02, 1.0], ball(8e-3, 2)[1])


def powers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda power: 10.0**power)


@st.composite
def obstacles(draw: st.DrawFn) -> qr.Obstacle:
    size = draw(powers(-5, 0))
    share = draw(st.sampled_from([1e-4, 0.1, 0.5, 1.0, 3.0]))
    shape = draw(st.sampled_from(["half_space", "sphere", "box", "capsule", "cylinder", "mesh", "rounded"]))
    match shape:
        case "half_space":
            tilt = draw(st.floats(-0.5, 0.5))
            return qr.Obstacle.half_space([0, 0, -draw(powers(-3, 2))], [tilt, 0, 1])
        case "sphere":
            made = qr.Obstacle.sphere([0, 0, 0], size)
        case "box":
            made = qr.Obstacle.box([size, size * share, size])
        case "capsule":
            made = qr.Obstacle.capsule([-size, 0, 0], [size, 0, 0], size * share)
        case "cylinder":
            made = qr.Obstacle.cylinder(size, size * share)
        case "mesh":
            made = qr.Obstacle.mesh(*ball(size, draw(st.integers(0, 3))))
        case _:
            made = qr.models.rounded_box(size=(0.04, 0.03, 0.008))
    angle, turn = draw(st.floats(0, 7)), np.eye(3)
    axis = draw(st.integers(0, 2))
    turn[np.ix_([axis, axis - 1], [axis, axis - 1])] = [
        [np.cos(angle), -np.sin(angle)],
        [np.sin(angle), np.cos(angle)],
    ]
    shift = [draw(st.floats(-0.01, 0.01)), draw(st.floats(-0.02, 0.03)), -draw(powers(-2, 3)) - 2 * size]
    return made.moved(turn, shift)


@st.composite
def skins(draw: st.DrawFn) -> qr.Skin:
    form = draw(st.sampled_from([None, "collocation", "galerkin"]))
    thickness = draw(powers(-3.5, 0))
    response = draw(
        st.sampled_from(
            [
                qr.HalfSpace(discretization=form),
                qr.HalfSpace(pressure="one_ring"),
                qr.Layer(thickness=thickness, discretization=form),
                qr.GaussianCorrected(height=None, width=thickness, cutoff=draw(powers(-3, 2))),
            ]
        )
    )
    ratio = draw(st.sampled_from([0.0, 0.3, 0.49, 0.4999, 0.5 - 1e-12, 0.5]))
    return qr.Skin(shear_modulus=draw(powers(0, 12)), poisson_ratio=ratio, response=response)


@given(
    name=st.sampled_from(["tip", "ball", "sheet", "disc"]),
    obstacle=obstacles(),
    skin=skins(),
    depth=powers(-12, -1.5),
    method=st.sampled_from(["lemke", "block_pivoting", "projected_cg", "auto"]),
    target=st.sampled_from([None, None, 0.05]),
    scale=st.sampled_from([1.0, 1.0, 1e-3, 1e3]),
    force=st.none() | powers(-9, 3),
)
@settings(max_examples=EXAMPLES // 2)
def test_a_press_has_finite_figures_or_a_named_ending(
    name: str,
    obstacle: qr.Obstacle,
    skin: qr.Skin,
    depth: float,
    method: qr.lcp.LcpMethod,
    target: float | None,
    scale: float,
    force: float | None,
) -> None:
    surface = surface_of(name)
    if scale != 1.0:
        surface = qr.Surface(surface.vertices * scale, surface.faces)
    options = qr.ContactOptions(method=method, target_error=target, max_nodes=400)
    goal = {"depth": depth} if force is None else {"force": force}
    try:
        contact = qr.press(surface, obstacle, skin, [0, 0, 1], **goal, options=options, throw=False)
    except qr.QuasirigidError as error:
        assert str(error)
        return
    check(contact)
    one = qr.ContactOptions(method=method, target_error=target, max_nodes=400, num_threads=1)
    again = qr.press(surface, obstacle, skin, [0, 0, 1], **goal, options=one, throw=False)
    assert again.status == contact.status
    np.testing.assert_array_equal(again.node_force, contact.node_force)
    np.testing.assert_array_equal(again.force, contact.force)


def check(contact: qr.Contact) -> None:
    assert not any("nan" in message.lower().split() or "NaN" in message for _, message in contact.warnings)
    assert contact.summary()
    if contact.status == "no_contact":
        assert not contact.force.any()
    if contact.status != "solved":
        return
    assert contact.natural_residual <= 1e-8
    figures = [contact.contact_area, contact.max_pressure, contact.max_penetration_after, contact.travel]
    assert np.isfinite(figures).all()
    assert np.isfinite(contact.force).all()
    assert np.isfinite(contact.moment).all()
    assert np.isfinite(contact.pressure).all()
    assert np.isfinite(contact.displacement).all()
    assert np.isfinite(contact.volume_change)
    accuracy = contact.accuracy
    errors = [accuracy.force_error, accuracy.mesh_error, accuracy.body_error, accuracy.area_error]
    assert all(error is None or error >= 0.0 for error in errors)
    # Penetration without force is no good answer.
    assert contact.force.any() or accuracy.force_error in (None, np.inf)
    assert not np.isnan(contact.gap).any()
    assert (contact.node_force >= 0).all()
    if contact.force.any():
        assert np.isfinite(contact.center_of_pressure).all()
        assert contact.contact_area > 0
        assert contact.max_pressure > 0
