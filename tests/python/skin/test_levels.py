"""Bodies on two levels through Python: files, motions, pickles, refusals, and the force of one level."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from shapes import ball, grid, slab

UP = (0, 0, 1)
PLATE = qr.Obstacle.half_space([0, 0, -0.05], UP)


@pytest.fixture(scope="module")
def tip() -> qr.Surface:
    surface = qr.models.fingertip(edge_length=1.35e-3)
    return surface.with_skin_mask(qr.skin_without_caps(surface))


def skin_of(tip: qr.Surface, coarse_edge_length: float | None, **body: object) -> qr.Skin:
    response = qr.Body(
        bone=qr.models.bone_of(tip),
        fixed=~tip.skin_mask,
        coarse_edge_length=coarse_edge_length,
        **body,  # type: ignore[arg-type]
    )
    return qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)


def pad(tip: qr.Surface) -> np.ndarray:
    return np.flatnonzero(tip.skin_mask & (tip.vertices[:, 2] < tip.vertices[:, 2].min() + 3e-3))


@pytest.fixture(scope="module")
def prepared(tip: qr.Surface) -> qr.PreparedSkin:
    return skin_of(tip, None, bone_pressure=True).prepared(tip, pad(tip))


# At 2 mm the contact reaches the cut.
@pytest.mark.filterwarnings("ignore:the contact reaches:quasirigid.QuasirigidWarning")
def test_the_force_of_one_level_is_met_from_a_far_smaller_body(tip: qr.Surface) -> None:
    announced: list[str] = []
    two = skin_of(tip, None).prepared(tip, pad(tip), progress=lambda what, _: announced.append(what))
    assert int(announced[0].split()[2]) < 0.7 * len(tip.vertices)
    one = skin_of(tip, 0.0).prepared(tip, pad(tip))
    for depth in (0.6e-3, 2e-3):
        forces = [qr.press(tip, PLATE, skin, UP, depth=depth).force[2] for skin in (two, one)]
        assert forces[0] == pytest.approx(forces[1], rel=0.02)


def test_saved_loaded_pickled_and_moved_it_answers_as_before(
    tip: qr.Surface, prepared: qr.PreparedSkin, tmp_path: Path
) -> None:
    contact = qr.press(tip, PLATE, prepared, UP, depth=0.6e-3)
    prepared.save(tmp_path / "tip.npz")
    loaded = qr.load_prepared(tmp_path / "tip.npz")
    for other in (loaded, pickle.loads(pickle.dumps(prepared))):
        again = qr.press(tip, PLATE, other, UP, depth=0.6e-3)
        np.testing.assert_array_equal(again.node_force, contact.node_force)
        np.testing.assert_array_equal(again.displacement, contact.displacement)
        np.testing.assert_array_equal(other.bone_pressure(again), prepared.bone_pressure(contact))

    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    shift = [0.1, 0.0, 0.02]
    moved = qr.press(tip.moved(turn, shift), PLATE, prepared.moved(turn, shift), UP, depth=0.6e-3)
    assert moved.force[2] == pytest.approx(contact.force[2], rel=1e-7)
    # Drawn to 1e-3.
    np.testing.assert_allclose(moved.displacement, contact.displacement @ turn.T, atol=1e-3 * 0.6e-3)
    prepared.moved(turn, shift).save(tmp_path / "moved.npz")
    loaded = qr.load_prepared(tmp_path / "moved.npz")
    again = qr.press(tip.moved(turn, shift), PLATE, loaded, UP, depth=0.6e-3)
    np.testing.assert_array_equal(again.node_force, moved.node_force)


def test_a_uniform_pressure_reaches_the_bone(tip: qr.Surface) -> None:
    skin = skin_of(tip, None, bone_pressure=True)
    everywhere = skin.prepared(tip)
    forces = -1e3 * tip.vertex_areas[:, None] * tip.vertex_normals
    forces[~tip.skin_mask] = 0.0
    pressure = everywhere.bone_pressure(forces)
    inner = pressure[everywhere.skin.response.bone.vertices[:, 0] > 5e-3]  # type: ignore[union-attr]
    assert np.median(inner) == pytest.approx(1e3, rel=0.1)


@pytest.mark.parametrize("length", [-1e-3, float("nan"), float("inf"), 1.0])
def test_coarse_edges_that_cannot_be_are_refused(tip: qr.Surface, length: float) -> None:
    with pytest.raises(qr.ResponseError, match=r"coarse edge length .* up to the size of the body"):
        skin_of(tip, length).prepared(tip, pad(tip))


@pytest.mark.parametrize("coarse_edge_length", [None, 0.0])
def test_a_pad_that_is_held_from_behind_is_the_layer_that_it_is(coarse_edge_length: float | None) -> None:
    spacing, thickness = 1.8e-3, 5e-3
    points, faces = slab(grid(24, spacing), thickness)
    pad = qr.Surface(points, faces)
    body = qr.Body(fixed=points[:, 2] < -0.5 * thickness, coarse_edge_length=coarse_edge_length)
    middle = np.flatnonzero((points[:, 2] == 0.0) & (np.abs(points).max(axis=1) < 9e-3))
    ball = qr.Obstacle.sphere([1e-4, 5e-5, 0.4], 0.3)

    def force(surface: qr.Surface, response: qr.Body | qr.Layer, nodes: np.ndarray | None = None) -> float:
        skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=response)
        answering = skin if nodes is None else skin.prepared(surface, nodes)
        contact = qr.press(surface, ball, answering, [0, 0, -1], depth=0.06e-3)
        return float(-contact.force[2])

    layer = force(qr.Surface(*grid(24, spacing)), qr.Layer(thickness=thickness))
    assert force(pad, body, middle) == pytest.approx(layer, rel=0.03)


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_pad_that_is_held_in_the_middle_alone_is_prepared() -> None:
    points, faces = slab(grid(24, 1.5e-3), 5e-3)
    held = (points[:, 2] < 0.0) & (np.hypot(*points[:, :2].T) < 6e-3)
    # Walls of the coarse mesh lie on those of the pad but for rounding.
    body = qr.Skin(shear_modulus=60e3, poisson_ratio=0.3, response=qr.Body(fixed=held))
    surface = qr.Surface(points, faces)
    prepared = body.prepared(surface)
    assert prepared.nodes.size == len(points) - held.sum()
    # What the tissue is over is kept with it.
    indenter = qr.Obstacle.sphere([0.0, 0.0, 0.1], 0.02)
    given, again = (
        qr.press(
            surface, indenter, one, [0, 0, -1], depth=0.2e-3, options=qr.ContactOptions(target_error=0.1)
        )
        for one in (prepared, pickle.loads(pickle.dumps(prepared)))
    )
    np.testing.assert_array_equal(again.node_force, given.node_force)
    assert again.accuracy.force_error == given.accuracy.force_error


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_beside_skin_that_a_body_holds_two_levels_are_as_one() -> None:
    surface = qr.models.fingertip(edge_length=1.6e-3)
    surface = surface.with_skin_mask(qr.skin_without_caps(surface))
    place = np.where(
        surface.skin_mask & (surface.vertices[:, 2] < 0.0), surface.vertices[:, 1], np.inf
    ).argmin()
    normal = surface.vertex_normals[place]
    obstacle = qr.Obstacle.sphere(surface.vertices[place] + 0.05 * normal, 5e-3)
    nodes = np.flatnonzero(surface.skin_mask)
    two, one = (
        qr.press(surface, obstacle, skin_of(surface, length).prepared(surface, nodes), -normal, depth=1e-3)
        for length in (None, 0.0)
    )
    assert "holds fixed" in two.warnings[0].message
    # As on free tissue, above.
    np.testing.assert_allclose(two.force, one.force, atol=0.02 * np.linalg.norm(one.force))


# Pressed above the patch, which turns little, and beside it, where all hangs on how it lets the ball turn.
@pytest.mark.parametrize("patch", [[0.0, 0.0, 1.0], [1.0, 0.0, 0.3]])
def test_a_body_that_a_small_patch_alone_holds_is_on_two_levels_as_on_one(patch: list[float]) -> None:
    vertices, faces = ball(8e-3, 3)
    surface = qr.Surface(vertices, faces)
    middle = vertices[np.argmax(vertices @ patch)]
    held = np.linalg.norm(vertices - middle, axis=1) < 2.5e-3
    two, one = (
        qr.press(
            surface,
            qr.Obstacle.half_space([0, 0, -1], [0, 0, 1]),
            qr.Skin(
                shear_modulus=60e3,
                poisson_ratio=0.45,
                response=qr.Body(fixed=held, coarse_edge_length=length),
            ),
            [0, 0, 1],
            depth=0.6e-3,
        )
        for length in (None, 0.0)
    )
    assert two.warnings == ()
    np.testing.assert_allclose(two.force, one.force, atol=0.02 * np.linalg.norm(one.force))
