"""What goes to other processes comes back the same."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import warnings
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import TURN, ball, grid, tetrahedron
from worker_tasks import press_in_place

SHIFT = [0.01, -0.02, 1 / 3]
OBSTACLES = {
    "mesh": qr.Obstacle.mesh(*ball(0.02, 2)),
    "half_space": qr.Obstacle.half_space([0.1, 0, 0], [1, 2, 3]),
    "sphere": qr.Obstacle.sphere([0.1, 0.2, 0.3], 0.02),
    "box": qr.Obstacle.box([0.01, 0.02, 0.03]),
    "capsule": qr.Obstacle.capsule([0, 0, 0], [0.01, 0.02, 0.03], 0.004),
    "cylinder": qr.Obstacle.cylinder(0.05, 0.02),
}
MATERIAL = {"shear_modulus": 60e3, "poisson_ratio": 0.5}


def again(thing: Any) -> Any:
    """Through a pickle and back."""
    return pickle.loads(pickle.dumps(thing))


@pytest.mark.parametrize("moved", [False, True])
@pytest.mark.parametrize("kind", OBSTACLES)
def test_an_obstacle_comes_back_to_the_bit(kind: str, moved: bool) -> None:
    obstacle = OBSTACLES[kind]
    if moved:
        obstacle = obstacle.moved(TURN, SHIFT).moved(TURN, SHIFT)
    points = np.random.default_rng(2).uniform(-0.1, 0.1, (50, 3))
    for copied in (again(obstacle), copy.deepcopy(obstacle)):
        assert copied.kind == kind
        for mine, its in zip(obstacle.signed_distance(points), copied.signed_distance(points), strict=True):
            np.testing.assert_array_equal(mine, its)
        np.testing.assert_array_equal(obstacle.rotation, copied.rotation)
        np.testing.assert_array_equal(obstacle.translation, copied.translation)


def test_a_mesh_with_crossings_that_were_waived_comes_back() -> None:
    vertices, faces = tetrahedron()
    both = np.concatenate([vertices, vertices + 0.1])
    faces = np.concatenate([faces, faces + 4])
    waived = qr.Obstacle.mesh(both, faces, check_crossings=False)
    np.testing.assert_array_equal(again(waived).triangles()[1], faces)


def test_a_pickle_that_is_none_of_ours_is_refused() -> None:
    restore, (_, numbers, pose, _) = OBSTACLES["sphere"].__reduce__()
    with pytest.raises(qr.ObstacleError, match='no obstacle is a "ball" of 4 numbers'):
        restore("ball", numbers, pose)


def test_a_surface_comes_back_with_its_mask() -> None:
    vertices, faces = ball(8e-3, 2)
    surface = qr.Surface(vertices, faces, vertices[:, 2] < 5e-3)
    copied = again(surface)
    for name in ("vertices", "faces", "skin_mask", "vertex_normals"):
        np.testing.assert_array_equal(getattr(surface, name), getattr(copied, name))


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")  # of the depth
@pytest.mark.parametrize("copied", [again, copy.deepcopy])
def test_a_skin_that_its_press_has_folded_flat_comes_back(copied: Callable[[Any], Any]) -> None:
    plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
    skin = qr.Skin(**MATERIAL, response=qr.HalfSpace())
    contact = qr.press(qr.models.fingertip(edge_length=1e-3), plate, skin, [0, 0, 1], depth=5e-3)
    skin_then = contact.deformed
    with pytest.raises(qr.SurfaceError, match="degenerate"):
        qr.Surface(skin_then.vertices, skin_then.faces)
    skin_now = copied(contact).deformed
    for name in ("vertices", "faces", "skin_mask", "vertex_normals", "vertex_areas"):
        np.testing.assert_array_equal(getattr(skin_now, name), getattr(skin_then, name))


def test_a_pickle_that_is_no_surface_is_refused() -> None:
    restore, (vertices, faces, mask) = qr.Surface(*tetrahedron()).__reduce__()
    with pytest.raises(qr.SurfaceError, match="face 0 refers to vertex 9"):
        restore(vertices, np.where(faces == faces[0, 0], 9, faces), mask)
    with pytest.raises(qr.SurfaceError, match="vertex 0"):
        restore(vertices * np.nan, faces, mask)
    with pytest.raises(qr.SurfaceError, match="the skin mask has 3 entries"):
        restore(vertices, faces, mask[:3])


def responses(surface: qr.Surface) -> dict[str, qr.Response]:
    """One of each kind, for a closed surface."""
    count = len(surface.vertices)
    blocks = np.einsum("ij,ab->iajb", np.eye(count) * 1e-3, np.eye(3))
    bone = qr.Surface(*(part if i else 0.3 * part + [0, 0, 5.6e-3] for i, part in enumerate(ball(8e-3, 1))))
    return {
        "half-space": qr.HalfSpace(discretization="galerkin"),
        "Gaussian": qr.GaussianCorrected.balanced(width=10e-3, cutoff=15e-3),
        "not well posed": qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3),
        "layer": qr.Layer(thickness=5e-3),
        "layer per vertex": qr.Layer(thickness=np.linspace(4e-3, 6e-3, count)),
        "body": qr.Body(bone=bone),
        "matrix": qr.GivenMatrix(nodes=np.arange(count), compliance=np.eye(count) * 1e-3),
        "blocks": qr.GivenMatrix(nodes=np.arange(count), compliance=blocks),
    }


@pytest.mark.parametrize("name", responses(qr.Surface(*ball(8e-3, 1))))
def test_a_skin_and_its_preparation_come_back(name: str) -> None:
    surface = qr.Surface(*ball(8e-3, 1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", qr.QuasirigidWarning)
        skin = qr.Skin(**MATERIAL, response=responses(surface)[name])
    nodes = np.arange(10)
    copied = again(skin)  # warns of nothing, which pytest would make an error
    prepared = skin.prepared(surface)
    for other in (copied, again(prepared), again(prepared.moved(np.eye(3), [0, 0, 0]))):
        np.testing.assert_array_equal(
            qr.response_matrix(surface, prepared, nodes, tolerance=0),
            qr.response_matrix(surface, other if other is not copied else copied.prepared(surface), nodes),
        )
    assert type(again(prepared).skin.response) is type(skin.response)
    with pytest.raises(dataclasses.FrozenInstanceError):
        copied.shear_modulus = 1.0


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")  # of the coarse mesh
@pytest.mark.parametrize("copied", [again, copy.copy, copy.deepcopy])
def test_a_hand_its_pose_and_its_grasp_come_back(copied: Callable[[Any], Any]) -> None:
    hand = qr.models.hand(edge_length=5e-3)
    product = qr.Obstacle.sphere([0.0, 0.0, 0.0], 0.02).placed(hand.posed("relaxed").palm)
    skin = qr.Skin(**MATERIAL, response=qr.HalfSpace())
    options = qr.ContactOptions(target_error=None)
    grasp = qr.close_hand(hand, product, skin, force={"index": 1.0}, options=options)
    its_hand, its_grasp = copied(hand), copied(grasp)
    its_pose = its_grasp.posed
    for mine, its in ((hand, its_hand), (hand, its_pose.hand), (hand, copied(hand.posed("fist")).hand)):
        np.testing.assert_array_equal(its.posed("fist").surface.vertices, mine.posed("fist").surface.vertices)
        assert not its.rest.flags.writeable
    np.testing.assert_array_equal(its_pose.surface.vertices, grasp.posed.surface.vertices)
    assert not its_pose.joints.flags.writeable
    assert its_pose.crossings == grasp.posed.crossings
    assert its_grasp.summary() == grasp.summary()


def test_a_contact_comes_back_from_another_process() -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    plate = qr.Obstacle.half_space([0, 0, 0.5e-3], [0, 0, 1])
    skin = qr.Skin(**MATERIAL, response=qr.HalfSpace())
    job = (surface, plate, skin, qr.ContactOptions(num_threads=1))
    here = press_in_place(job)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        (there,) = pool.map(press_in_place, [job])
    assert there.status is qr.ContactStatus.SOLVED
    np.testing.assert_array_equal(there.pressure, here.pressure)
    np.testing.assert_array_equal(there.deformed.vertices, here.deformed.vertices)
    assert there.accuracy == here.accuracy
    assert there.lcp_solutions[0].certificate == here.lcp_solutions[0].certificate
    assert there.obstacle.kind == "half_space"
    assert there.left_out == here.left_out


def test_an_ending_that_raises_takes_its_contact_along() -> None:
    surface = qr.Surface(*grid(20, 1e-3))
    with pytest.warns(qr.QuasirigidWarning, match="not well posed"):
        skin = qr.Skin(**MATERIAL, response=qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3))
    punch = qr.Obstacle.sphere([0, 0, 49e-3], 50e-3)
    with pytest.raises(qr.ContactError) as caught:
        qr.solve_contact(surface, punch, skin)
    error = again(caught.value)
    assert str(error) == str(caught.value)
    assert error.contact.status == caught.value.contact.status  # type: ignore[union-attr]
