"""Hands as a whole: their parts, motions, scale and side, what presses with them and what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from hands import INDEX, parts_of
from quasirigid.hand import JOINTS_16, JOINTS_21, OPENXR_26, WEBXR_25
from quasirigid.hand.regions import digit_of_vertices


def spin(axis: int, angle: float) -> np.ndarray:
    turn = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turn[[a, a, b, b], [a, b, a, b]] = math.cos(angle), -math.sin(angle), math.sin(angle), math.cos(angle)
    return turn


def test_names_of_others_are_those_of_webxr() -> None:
    assert len(WEBXR_25) == len(set(WEBXR_25)) == 25
    assert len(OPENXR_26) == 26
    assert OPENXR_26[0] is None
    assert OPENXR_26[1] == "wrist"
    assert len(JOINTS_16) == len(set(JOINTS_16)) == 16
    assert len(JOINTS_21) == len(set(JOINTS_21)) == 21
    assert set(JOINTS_16) | set(JOINTS_21) < set(WEBXR_25)
    # In the order of the others: fingers by the alphabet and the thumb last; thumb to little finger.
    assert JOINTS_16[7] == "pinky-finger-phalanx-proximal"
    assert JOINTS_16[-1] == "thumb-phalanx-distal"
    assert JOINTS_21[4] == "thumb-tip"
    assert JOINTS_21[8] == "index-finger-tip"


def test_a_rigid_motion_of_the_hand_moves_every_vertex_rigidly(rigged: qr.Hand) -> None:
    turn, shift = spin(0, 2.0) @ spin(2, -0.7), np.array([0.3, -0.2, 0.5])
    fist = rigged.posed("fist")
    moved = rigged.posed("fist", rotation=turn, translation=shift)
    expected = fist.surface.vertices @ turn.T + shift
    assert np.abs(moved.surface.vertices - expected).max() < 1e-12 * np.abs(expected).max()
    at_rest_there = rigged.moved(turn, shift).posed("fist")
    assert np.abs(at_rest_there.surface.vertices - expected).max() < 1e-12 * np.abs(expected).max()


def test_bones_lie_inside_the_skin_and_clear_of_each_other(rigged: qr.Hand) -> None:
    names = [bone.name for bone in rigged.bones]
    assert len(names) == 20
    assert {"carpals", "thumb-metacarpal", "thumb-distal", "little-middle"} < set(names)
    for pose in ({}, "relaxed", {f"pinky-finger-phalanx-{link}": 1.1 for link in ("proximal", "distal")}):
        posed = rigged.posed(pose)
        assert not posed.crossings
        bones = posed.bones
        assert set(posed.bone_shares) == set(names)
        # A product is refused where its faces cross.
        qr.Obstacle.mesh(bones.vertices, bones.faces)
        skin = qr.Obstacle.mesh(posed.surface.vertices, posed.surface.faces, check_crossings=False)
        assert skin.signed_distance(bones.vertices)[0].max() <= -1e-3


def test_a_motion_is_one_matrix_or_two(hand: qr.Hand) -> None:
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    shift = [0.1, -0.2, 0.3]
    motion = np.eye(4)
    motion[:3, :3], motion[:3, 3] = turn, shift
    for one, two in (
        (hand.moved(motion), hand.moved(turn, shift)),
        (hand.posed("fist", rotation=motion), hand.posed("fist", rotation=turn, translation=shift)),
    ):
        np.testing.assert_array_equal(one.surface.vertices, two.surface.vertices)
    for move in (
        hand.surface.moved,
        hand.moved,
        lambda *both: hand.posed("fist", rotation=both[0], translation=both[1]),
    ):
        with pytest.raises(TypeError, match="holds a translation: leave out `translation`"):
            move(motion, shift)
    motion[3, 0] = 1.0
    with pytest.raises(qr.HandError, match="rigid motion"):
        hand.moved(motion)


@pytest.mark.parametrize(
    ("rotation", "message"),
    [
        (spin(1, 0.3).astype(np.float32), r"orthonormal to 1e-09, but \|R'R - I\| reaches \d\.?\d*e-08"),
        (2.0 * np.eye(3), r"orthonormal to 1e-09, but \|R'R - I\| reaches 3$"),
        (np.diag([1.0, 1.0, -1.0]), r"is a reflection \(determinant -1\)"),
        (np.full((3, 3), np.nan), r"an array of shape \(3, 3\), expected a \(3, 3\) rotation matrix"),
        (np.eye(2), r"\[\[1\.0, 0\.0\], \[0\.0, 1\.0\]\], expected a \(3, 3\) rotation matrix"),
    ],
)
def test_a_rotation_that_is_none_is_refused_with_its_deviation(
    hand: qr.Hand, rotation: np.ndarray, message: str
) -> None:
    with pytest.raises(qr.HandError, match=message):
        hand.posed("flat", rotation=rotation)
    with pytest.raises(qr.HandError, match=message):
        hand.moved(rotation)


def test_the_other_hand_is_the_mirror_image(hand: qr.Hand) -> None:
    other = hand.mirrored()
    assert other.side == "left"
    found = qr.Hand(other.surface.vertices, other.surface.faces, **parts_of(other))
    assert found.side == "left"
    assert other.surface.volume > 0.0
    for pose in ("fist", {"thumb-metacarpal": {"flexion": 0.2, "abduction": 0.3, "twist": 0.2}}):
        mirrored = hand.posed(pose).surface.vertices * [-1.0, 1.0, 1.0]
        np.testing.assert_allclose(other.posed(pose).surface.vertices, mirrored, atol=1e-15)
    assert (other.labels == hand.labels).all()
    np.testing.assert_allclose(other.mirrored().rest, hand.rest, atol=1e-14)


def test_a_scaled_hand_bends_alike(hand: qr.Hand) -> None:
    small = hand.scaled(0.9).posed("cylinder")
    np.testing.assert_allclose(
        small.surface.vertices, 0.9 * hand.posed("cylinder").surface.vertices, atol=1e-15
    )


def test_a_posed_hand_presses_as_any_skin(hand: qr.Hand) -> None:
    posed = hand.posed("flat")
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.495, response=qr.HalfSpace())
    pad = posed.surface.vertices[posed.labels == "index-distal-palmar"].mean(axis=0)
    dorsal = posed.frame_of("index-finger-tip")[:3, 2]
    ball = qr.Obstacle.sphere(pad - 0.012 * dorsal, 5e-3)
    contact = qr.press(posed.surface, ball, skin, dorsal, depth=5e-4, start="current")
    assert contact.status == "no_contact"
    contact = qr.press(posed.surface, ball, skin, dorsal, depth=7e-3, start="current")
    parts = contact.by_label(posed.labels)
    loaded = {region: part.force @ dorsal for region, part in parts.items() if part.force @ dorsal > 0.0}
    assert sum(loaded.values()) == pytest.approx(contact.force @ dorsal)
    assert max(loaded, key=loaded.__getitem__) == "index-distal-palmar"


def test_the_palm_faces_out_of_the_hand(rigged: qr.Hand) -> None:
    palm = rigged.posed({}).palm
    assert np.linalg.det(palm[:3, :3]) == pytest.approx(1.0)
    nearest = np.argmin(np.linalg.norm(rigged.surface.vertices - palm[:3, 3], axis=1))
    assert rigged.surface.vertex_normals[nearest] @ palm[:3, 2] > 0.8
    assert rigged.labels[nearest] == "palm-center"


@pytest.mark.parametrize("pose", ["flat", "fist"])
def test_the_palm_of_a_scaled_hand_is_scaled(pose: str) -> None:
    hand = qr.models.hand(edge_length=4e-3)
    expected = np.array(hand.posed(pose).palm)
    expected[:3, 3] *= 1.5
    np.testing.assert_allclose(hand.scaled(1.5).posed(pose).palm, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"side": "both"}, r'side is \'both\', expected "right", "left" or None'),
        ({"side": "left"}, "side is 'left', but the joints are those of a right hand"),
        ({"weights": lambda hand: hand.weights * 0.9}, r"weights\[0\] sums to 0\.9"),
        ({"parents": lambda hand: np.roll(np.arange(len(hand.parents)), 1)}, r"run in a circle: .* on "),
        (
            {"parents": lambda hand: np.full(len(hand.parents), -1)},
            r"26 roots, 'wrist', 'thumb-metacarpal', .* and 23 more, expected one",
        ),
        ({"parents": lambda hand: hand.parents + 0.5}, r"expected 26 integers"),
        ({"joint_names": lambda hand: ["palm", *hand.joint_names[1:]]}, r"has no joint 'wrist' \(1 of"),
        (
            {"joint_names": lambda hand: ["wrist", "Thumb-Metacarpal", *hand.joint_names[2:]]},
            r"has no joint 'thumb-metacarpal' .*; is 'Thumb-Metacarpal' meant\?",
        ),
        ({"joint_names": lambda hand: [hand.joint_names[1], *hand.joint_names[1:]]}, r"holds .* 2 times"),
        ({"rest": lambda hand: hand.rest[:, :3]}, r"rest has shape \(26, 3, 4\), expected \(26, 4, 4\)"),
        ({"rest": lambda hand: hand.rest * 1.1}, r"rest\[0\] \(wrist\) is no rigid motion"),
        ({"joints": lambda hand: hand.joints + 30}, r"joints\[0\] names joint \d+, but there are 26"),
        ({"joints": lambda hand: hand.joints - 30}, r"joints\[0\] names joint -\d+, but there are 26"),
        ({"joints": lambda hand: hand.joints[:-1], "weights": lambda hand: hand.weights[:-1]}, r"13012 rows"),
        ({"labels": lambda hand: hand.labels[:5]}, r"expected one word for each of 13013 vertices"),
    ],
)
def test_a_faulty_hand_is_refused(hand: qr.Hand, change: dict[str, Any], message: str) -> None:
    changed = {name: value(hand) if callable(value) else value for name, value in change.items()}
    with pytest.raises(qr.HandError, match=message):
        qr.Hand(hand.surface.vertices, hand.surface.faces, **(parts_of(hand) | changed))


def test_a_joint_outside_the_skin_is_named(hand: qr.Hand) -> None:
    with pytest.raises(qr.HandError, match=r"lies \d+\.\d+ mm outside the skin .* same unit and frame"):
        qr.Hand(hand.surface.vertices * 0.5, hand.surface.faces, **parts_of(hand))


def test_a_hand_of_fewer_digits_is_told_what_each_needs(hand: qr.Hand) -> None:
    parts = parts_of(hand)
    own = [at for at, name in enumerate(hand.joint_names) if name == "wrist" or name.startswith("index")]
    names = [hand.joint_names[at] for at in own]
    alone = {"joint_names": names, "parents": np.arange(-1, len(own) - 1), "rest": hand.rest[own]}
    told = "each digit needs skin and joints; `press` takes a finger alone"
    with pytest.raises(qr.HandError, match=rf"has no joint 'thumb-metacarpal' \(19 of .* missing\): {told}"):
        qr.Hand(hand.surface.vertices, hand.surface.faces, **(parts | alone))
    # The skin of the palm and one finger.
    keep = np.isin(digit_of_vertices(hand.regions), ("palm", "index"))
    rest = qr.cut_out(hand.surface, keep=keep).surface
    weights = np.ones((len(rest.vertices), 1))
    skin = {"joints": np.zeros(weights.shape, dtype=int), "weights": weights}
    with pytest.raises(qr.HandError, match=rf"outside the skin \(1\d joints do\): .* of index, and {told}"):
        qr.Hand(rest.vertices, rest.faces, **(parts | skin))


def test_crossing_skin_can_be_left_out_of_contact() -> None:
    hand = qr.models.hand(edge_length=4e-3)
    vectors = np.zeros((len(hand.joint_names), 3))
    vectors[hand.joint_names.index(f"{INDEX}proximal"), 2] = -0.4  # into the middle finger
    posed = hand.posed(vectors)
    assert {one.partition("-")[0] for one in posed.crossings[0]} == {"index", "middle"}
    open_to_touch = posed.without_crossings().surface
    closed = posed.surface.skin_mask & ~open_to_touch.skin_mask
    assert closed.any()
    # Each such vertex has a face that crosses one of the regions named.
    assert set(hand.labels[closed]) >= set(posed.crossings[0])
    assert (hand.posed("flat").without_crossings().surface.skin_mask == hand.surface.skin_mask).all()
