"""Responses computed once: threads share them, they move and are compared."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from prepared_skins import RESPONSES, SHEAR_MODULUS, core, skin_of
from quasirigid.skin import skins
from quasirigid.skin.core import build_prepared
from shapes import AS_GIVEN, PLATE, TURN, ball

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")


def test_threads_share_a_prepared_skin(surface: qr.Surface) -> None:
    prepared = skin_of(RESPONSES["body"]).prepared(surface)
    depths = np.linspace(0.2e-3, 1.0e-3, 6)

    def force(depth: float) -> float:
        options = qr.ContactOptions(target_error=0.1)
        return float(qr.press(surface, PLATE, prepared, [0, 0, 1], depth=depth, options=options).force[2])

    alone = [force(depth) for depth in depths]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(force, [*depths, *depths], timeout=120.0))
    np.testing.assert_allclose(together, [*alone, *alone], rtol=1e-6)


@pytest.mark.parametrize("name", ["half_space", "layer", "field"])
def test_a_prepared_kernel_gives_the_contact_of_the_kernel(name: str, surface: qr.Surface) -> None:
    skin = skin_of(RESPONSES[name])
    direct = qr.press(surface, PLATE, skin, [0, 0, 1], depth=0.5e-3)
    prepared = qr.press(surface, PLATE, skin.prepared(surface), [0, 0, 1], depth=0.5e-3)
    # Entries of the matrix hold to 1e-6, whichever nodes it is assembled over.
    np.testing.assert_allclose(prepared.force, direct.force, rtol=1e-5, atol=1e-9)


HELD = ball(8e-3, 3)[0][:, 2] > 12e-3
LAST = np.arange(630, 642)
ARRAYS: dict[str, tuple[type[Any], dict[str, Any]]] = {
    "layer": (qr.Layer, {"thickness": np.full(642, 20e-3)}),
    "list": (qr.Layer, {"thickness": [20e-3] * 642}),
    "number": (qr.Layer, {"thickness": np.array(20e-3)}),
    "body": (qr.Body, {"fixed": HELD}),
    "given": (qr.GivenMatrix, {"nodes": LAST, "compliance": 1e-3 * np.eye(12)}),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_a_response_is_what_it_was_made_of_whatever_becomes_of_the_arrays(
    name: str, surface: qr.Surface, tmp_path: Path
) -> None:
    kind, made_of = ARRAYS[name]
    mine = copy.deepcopy(made_of)
    response = kind(**mine)
    prepared = skin_of(response).prepared(surface, LAST if kind is qr.Layer else None)
    for values in mine.values():
        if isinstance(values, list):
            values[:] = [0.0] * len(values)
        else:
            values[...] = 0
    prepared.save(tmp_path / "skin.npz")
    loaded = qr.load_prepared(tmp_path / "skin.npz").skin.response
    for one in (response, loaded, pickle.loads(pickle.dumps(response)), copy.deepcopy(response)):
        for field, values in made_of.items():
            kept = getattr(one, field)
            np.testing.assert_array_equal(kept, values)
            # A number is loaded as one.
            if np.ndim(values) > 0 or one is not loaded:
                with pytest.raises(ValueError, match="read-only"):
                    kept[...] = 0
    assert repr(response) == repr(kind(**made_of))


def test_a_body_is_prepared_by_the_threads_of_what_asks_and_once_for_a_sweep(
    surface: qr.Surface, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def build(*words: Any, **options: Any) -> Any:
        asked.append(options["num_threads"])
        return build_prepared(*words, **options)

    monkeypatch.setattr(skins, "build_prepared", build)
    skin, one = skin_of(RESPONSES["body"]), replace(AS_GIVEN, num_threads=1)
    pressed = qr.press(surface, PLATE, skin, [0, 0, 1], depth=0.4e-3, options=one)
    curve = qr.sweep(surface, PLATE, skin, [0, 0, 1], depths=[0.4e-3, 0.5e-3], options=one)
    np.testing.assert_array_equal(curve.force[0], pressed.force)
    qr.response_matrix(surface, skin, [0], num_threads=2)
    assert asked == [1, 1, 2]
    with pytest.raises(qr.ResponseError, match="at least 1"):
        skin.prepared(surface, num_threads=0)


@pytest.mark.parametrize("name", ["half_space", "body"])
def test_it_moves_with_its_surface(name: str, surface: qr.Surface, tmp_path: Path) -> None:
    low = np.flatnonzero(surface.vertices[:, 2] < 2e-3)
    prepared = skin_of(RESPONSES[name]).prepared(surface, low)
    still = qr.press(surface, PLATE, prepared, [0, 0, 1], depth=0.4e-3)
    shift = [0.1, -0.2, 0.3]
    moved = prepared.moved(TURN, shift)
    there = surface.moved(TURN, shift)
    turned = qr.press(there, PLATE.moved(TURN, shift), moved, TURN @ [0, 0, 1], depth=0.4e-3)
    np.testing.assert_allclose(turned.force, TURN @ still.force, rtol=1e-7, atol=1e-9)
    # Away from the candidates a kernel's displacement holds to 1e-3, and its far field to the axes' choice.
    scale = np.abs(still.displacement).max()
    np.testing.assert_allclose(turned.displacement, still.displacement @ TURN.T, atol=1e-3 * scale)
    moved.save(tmp_path / "moved.npz")
    again = qr.press(
        there,
        PLATE.moved(TURN, shift),
        qr.load_prepared(tmp_path / "moved.npz"),
        TURN @ [0, 0, 1],
        depth=0.4e-3,
    )
    np.testing.assert_array_equal(again.node_force, turned.node_force)


def test_another_surface_is_refused_with_what_differs(surface: qr.Surface) -> None:
    prepared = skin_of(qr.HalfSpace()).prepared(surface, np.arange(20))
    with pytest.raises(qr.ResponseError, match="number of vertices: 162, expected 642"):
        qr.solve_contact(qr.Surface(*ball(8e-3, 2)), PLATE, prepared)
    with pytest.raises(qr.ResponseError, match=r"vertex 0 is 1\.000e-3 m away"):
        qr.solve_contact(surface.moved(np.eye(3), [1e-3, 0, 0]), PLATE, prepared)
    flipped = qr.Surface(surface.vertices, np.roll(surface.faces, 1, axis=1))
    with pytest.raises(qr.ResponseError, match="faces that differ: 1280"):
        qr.solve_contact(flipped, PLATE, prepared)
    kernel_alone = skin_of(qr.HalfSpace()).combined(surface, {})
    with pytest.raises(qr.ResponseError, match="number of vertices: 162, expected 642"):
        qr.press(qr.Surface(*ball(8e-3, 2)), PLATE, kernel_alone, [0, 0, 1], depth=0.4e-3)
    with pytest.raises(qr.ResponseError, match="prepared for 20 other vertices"):
        qr.press(surface, PLATE, prepared, [0, 0, 1], depth=0.5e-3)


def test_a_body_on_its_bone_is_right_against_finite_elements(surface: qr.Surface) -> None:
    sphere = qr.reference.plate_on_cored_sphere()[0]
    assert (sphere.radius, sphere.shear_modulus, sphere.poisson_ratio) == (8e-3, SHEAR_MODULUS, 0.5)
    skin = qr.Skin(
        shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=qr.Body(bone=core(), coarse_edge_length=0)
    )
    low = np.flatnonzero(surface.vertices[:, 2] < 4e-3)
    prepared = skin.prepared(surface, low)
    # Uniform edges of 1.1 mm against contact radii of 2 and 3 mm: two and three cells.
    for depth, error in [(0.6e-3, 0.04), (1.12e-3, 0.02)]:
        contact = qr.press(surface, PLATE, prepared, [0, 0, 1], depth=depth, options=AS_GIVEN)
        assert contact.force[2] == pytest.approx(sphere.indentations[depth], rel=error)
        # Incompressible: what is pushed in comes out elsewhere.
        inward = -np.einsum("ij,ij->i", contact.displacement, surface.vertex_normals)
        pushed = np.maximum(inward, 0) @ surface.vertex_areas
        assert abs(contact.volume_change) < 5e-3 * pushed


@pytest.mark.parametrize("length", [0, None])
def test_averaged_gaps_of_a_refined_body_are_right_against_finite_elements(
    length: float | None, surface: qr.Surface
) -> None:
    sphere = qr.reference.plate_on_cored_sphere()[0]
    body = qr.Body(bone=core(), coarse_edge_length=length, discretization="galerkin")
    skin = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=body)
    prepared = skin.prepared(surface, np.flatnonzero(surface.vertices[:, 2] < 5e-3))
    for depth in (0.6e-3, 1.12e-3):
        contact = qr.press(surface, PLATE, prepared, [0, 0, 1], depth=depth)
        assert contact.accuracy.discretization == "galerkin"
        assert contact.force[2] == pytest.approx(sphere.indentations[depth], rel=0.012)


def test_a_body_that_nothing_holds_is_refused(surface: qr.Surface) -> None:
    with pytest.raises(qr.ResponseError, match="bone"):
        skin_of(qr.Body()).prepared(surface)


@pytest.mark.parametrize("value", ["finger.ply", (1, 2), 5])
def test_what_is_no_surface_is_refused_by_name(value: Any, surface: qr.Surface) -> None:
    with pytest.raises(TypeError, match=r"surface is .*, expected a Surface"):
        skin_of(qr.HalfSpace()).prepared(value)
    with pytest.raises(TypeError, match=r"bone is .*, expected a Surface"):
        skin_of(qr.Body(bone=value)).prepared(surface)


def test_responses_are_equal_by_what_they_hold(surface: qr.Surface, tmp_path: Path) -> None:
    count = len(surface.vertices)
    bone = ball(2e-3, 1)
    made: list[Callable[[float], qr.Response]] = [
        lambda size: qr.Layer(thickness=size * 5e-3),
        lambda size: qr.Layer(thickness=np.full(count, size * 5e-3)),
        lambda size: qr.Body(bone=qr.Surface(size * bone[0], bone[1])),
        lambda size: qr.Body(fixed=np.arange(count) < size),
        lambda size: qr.GivenMatrix(nodes=[0, 1], compliance=size * np.eye(2)),
        lambda size: qr.GaussianCorrected(height=None, width=size * 10e-3, cutoff=15e-3),
    ]
    for make in made:
        one, same, other = make(1), make(1), make(2)
        assert (one == same, one == other, hash(one) == hash(same)) == (True, False, True)
        assert one != qr.HalfSpace()
    assert qr.HalfSpace() == qr.HalfSpace(pressure="linear") != qr.HalfSpace(pressure="one_ring")
    assert qr.Layer(thickness=5e-3) != qr.Layer(thickness=np.full(count, 5e-3))
    prepared = skin_of(qr.Layer(thickness=5e-3)).prepared(surface, [0])
    prepared.save(tmp_path / "layer.npz")
    assert qr.load_prepared(tmp_path / "layer.npz").skin == prepared.skin
