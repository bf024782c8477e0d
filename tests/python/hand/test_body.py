"""The body of a whole hand: regions that cross, bodies kept by content, how many vertices it is solved on."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from hands import INDEX
from quasirigid.hand import kept
from quasirigid.hand.bones import Bone, fitted
from shapes import ball, grid, slab

MATERIAL = {"shear_modulus": 60e3, "poisson_ratio": 0.495}


@pytest.fixture(scope="module")
def hand() -> qr.Hand:
    return qr.models.hand(edge_length=5e-3)


@pytest.fixture(scope="module")
def through_the_middle(hand: qr.Hand) -> qr.PosedHand:
    """Return the hand with its index finger swung through its middle finger."""
    turns = np.zeros((len(hand.joint_names), 3))
    turns[hand.joint_names.index(f"{INDEX}proximal"), 2] = -0.5
    return hand.posed(turns)


def test_an_open_hand_crosses_nowhere(hand: qr.Hand) -> None:
    assert hand.posed({}).crossings == ()


def test_regions_that_cross_are_named(through_the_middle: qr.PosedHand) -> None:
    pairs = through_the_middle.crossings
    assert pairs
    assert {name for pair in pairs for name in pair} <= set(through_the_middle.labels)
    first, second = (name.split("-")[0] for name in pairs[0])
    assert (first, second) == ("index", "middle")
    words = f"crosses itself in this pose, {pairs[0][0]} and {pairs[0][1]}"
    with pytest.raises(qr.HandError, match=words):
        through_the_middle.skin(**MATERIAL)


def held_at_the_wrist(posed: qr.PosedHand) -> qr.Body:
    return qr.Body(fixed=~posed.surface.skin_mask, coarse_edge_length=12e-3)


def test_a_body_is_prepared_once(hand: qr.Hand, tmp_path: Path) -> None:
    posed = hand.posed({})
    nodes = np.flatnonzero(posed.labels == "index-distal-palmar")
    arguments = {**MATERIAL, "response": held_at_the_wrist(posed), "nodes": nodes, "folder": tmp_path}
    first = posed.skin(**arguments)
    assert posed.skin(**arguments) is first
    assert hand.posed({}).skin(**arguments) is first
    assert len(list(tmp_path.iterdir())) == 1
    np.testing.assert_array_equal(first.nodes, nodes)
    assert posed.skin(**{**arguments, "poisson_ratio": 0.4}) is not first
    assert posed.skin(**{**arguments, "nodes": nodes[1:]}) is not first
    averaged = replace(arguments["response"], discretization="galerkin")
    assert posed.skin(**{**arguments, "response": averaged}).skin.response.discretization == "galerkin"


def test_every_field_of_a_body_but_its_memory_is_told_apart(hand: qr.Hand) -> None:
    surface, bone = hand.surface, hand.posed({}).bones
    others = {
        "bone": bone,
        "fixed": ~surface.skin_mask,
        "bone_pressure": True,
        "coarse_edge_length": 1e-3,
        "discretization": "galerkin",
    }
    assert set(others) == {field.name for field in fields(qr.Body)} - {"memory_limit"}
    bodies = [qr.Body(), *(qr.Body(**{name: value}) for name, value in others.items())]
    skins = [qr.Skin(**MATERIAL, response=body) for body in bodies]
    keys = {kept._key(skin, surface, [0, 1]) for skin in skins}
    assert len(keys) == len(bodies)
    named = qr.Skin(**MATERIAL, response=qr.Body(discretization="collocation"))
    assert kept._key(named, surface, [0, 1]) in keys


def test_a_damaged_file_of_a_body_is_written_anew(hand: qr.Hand, tmp_path: Path) -> None:
    posed = hand.posed({"index-finger-phalanx-proximal": 0.1})
    nodes = np.flatnonzero(posed.labels == "index-distal-palmar")
    arguments = {**MATERIAL, "response": held_at_the_wrist(posed), "nodes": nodes}
    posed.skin(**arguments, folder=tmp_path)
    (file,) = tmp_path.iterdir()
    sound = file.read_bytes()
    file.write_bytes(sound[: len(sound) // 2])
    kept._known.clear()
    prepared = posed.skin(**arguments, folder=tmp_path)
    np.testing.assert_array_equal(prepared.nodes, nodes)
    np.testing.assert_array_equal(qr.load_prepared(file).nodes, nodes)


def test_a_body_in_memory_goes_into_a_folder_too(hand: qr.Hand, tmp_path: Path) -> None:
    posed = hand.posed({})
    nodes = np.flatnonzero(posed.labels == "index-distal-palmar")
    arguments = {**MATERIAL, "response": held_at_the_wrist(posed), "nodes": nodes}
    prepared = posed.skin(**arguments)
    assert posed.skin(**arguments, folder=tmp_path) is prepared
    (file,) = tmp_path.iterdir()
    np.testing.assert_array_equal(qr.load_prepared(file).nodes, nodes)
    with pytest.raises(NotADirectoryError, match="make it first"):
        posed.skin(**arguments, folder=tmp_path / "none")


def test_the_preparation_of_a_body_tells_how_far_it_is(hand: qr.Hand) -> None:
    posed, told = hand.posed({}), []
    nodes = np.flatnonzero(posed.labels == "index-middle-palmar")
    arguments = {**MATERIAL, "response": held_at_the_wrist(posed), "nodes": nodes}
    posed.skin(**arguments, progress=lambda what, done: told.append((what, done)))
    assert told[-1] == ("solution", 1.0)
    with pytest.raises(TypeError, match="progress is 3, expected a function"):
        posed.skin(**arguments, progress=3)


def test_a_body_of_edges_that_were_asked_for_answers_everywhere(hand: qr.Hand) -> None:
    posed = hand.posed({})
    prepared = posed.skin(**MATERIAL, response=held_at_the_wrist(posed))
    np.testing.assert_array_equal(prepared.nodes, np.flatnonzero(posed.surface.skin_mask))


def test_a_folder_that_is_none_is_refused_before_the_work(hand: qr.Hand, tmp_path: Path) -> None:
    posed = hand.posed({})
    with pytest.raises(NotADirectoryError, match="make it first"):
        posed.skin(**MATERIAL, folder=tmp_path / "none")


def test_a_hand_without_room_for_a_bone_is_refused_with_its_length(hand: qr.Hand) -> None:
    posed = hand.scaled(1e-3).posed("flat")
    words = rf"no bone fits into this skin, {1e-3 * hand.length:.4g} m long .*: check the unit"
    with pytest.raises(qr.HandError, match=words):
        posed.skin(**MATERIAL)
    with pytest.raises(qr.HandError, match=words):
        _ = posed.bones


def test_a_bone_keeps_clear_of_a_fold_that_reaches_in_between_its_vertices() -> None:
    points, faces = ball(20e-3, subdivisions=3)
    points -= points.mean(axis=0)
    fold = np.argmax(points[:, 0])
    points[fold] = [5e-3, 0.0, 0.0]
    rod, rod_faces = slab(grid(1, 16e-3), 20e-3)
    rod += [0.0, 0.0, 10e-3]
    ends = np.array([[0.0, 0.0, -10e-3], [0.0, 0.0, 10e-3]])
    bone = Bone(name="rod", joint=0, vertices=rod, faces=rod_faces, ends=ends, share=1.0)
    (slim,) = fitted([bone], qr.Surface(points, faces))
    # Steps of 0.85 from 8 mm to the first below the 5 mm where the fold ends.
    assert slim.share == pytest.approx(0.85**3)
    assert np.linalg.norm(slim.vertices - points[fold], axis=1).min() > 5e-3


class Stop(Exception):
    """Raised at the first sign of work."""


def first_words(what: str, _: float) -> None:
    raise Stop(what)


def words_of(posed: qr.PosedHand) -> list[str]:
    """Return what the body of a posed hand says before it is solved."""
    body = qr.Body(bone=posed.bones, fixed=~posed.surface.skin_mask)
    with pytest.raises(Stop) as announced:
        qr.Skin(**MATERIAL, response=body).prepared(posed.surface, progress=first_words)
    return str(announced.value).split()


def test_a_whole_hand_is_solved_on_a_bounded_number_of_vertices(hand: qr.Hand) -> None:
    words = words_of(hand.posed({}))
    assert int(words[2]) < 1800
    assert float(words[words.index("GB,") - 1]) < 1.0


def test_fingers_that_all_but_touch_are_a_body_too(hand: qr.Hand) -> None:
    turns = np.zeros((len(hand.joint_names), 3))
    turns[hand.joint_names.index(f"{INDEX}proximal"), 2] = -0.172
    posed = hand.posed(turns)
    assert posed.crossings == ()
    digit = np.array([name.split("-")[0] for name in posed.labels])
    index, middle = (posed.surface.vertices[digit == name] for name in ("index", "middle"))
    apart = np.linalg.norm(index[:, None] - middle, axis=2).min()
    assert apart < 0.5 * hand.surface.mean_edge_length
    assert int(words_of(posed)[2]) < 1800


def test_a_round_wrist_is_no_cut_and_the_bones_hold_the_hand(
    hand: qr.Hand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("quasirigid.hand.posed.kept", lambda skin, *_: skin)  # what would be prepared
    vertices = hand.surface.vertices.copy()
    cut = ~hand.surface.skin_mask
    across = vertices[cut][:, [0, 2]] - vertices[cut][:, [0, 2]].mean(axis=0)
    reach = np.linalg.norm(across, axis=1)
    vertices[cut, 1] -= 8e-3 * (1.0 - (reach / reach.max()) ** 2)
    known = {name: getattr(hand, name) for name in ("joint_names", "parents", "rest", "joints", "weights")}
    posed = qr.Hand(vertices, hand.surface.faces, **known).posed({})
    assert posed.surface.skin_mask.all()
    body = posed.skin(**MATERIAL).response
    assert isinstance(body, qr.Body)
    assert body.fixed is None
    assert body.bone is posed.bones
