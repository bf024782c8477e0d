"""Hands: joints, poses, regions of the skin, files."""

from __future__ import annotations

import base64
import json
import math
import struct
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from quasirigid._sides import sides_of
from quasirigid.hand import DIGITS, JOINTS_16, JOINTS_21, OPENXR_26, WEBXR_25
from quasirigid.hand.pose import bend_at_rest
from quasirigid.hand.rig.frames import uniform_frames
from shared_meshes import hand_file

RIGS = ("webxr_right_13k", "libhand_right_13k", "makehuman_male_right_13k")
DENSE = ("webxr_right_53k", "libhand_right_53k", "makehuman_male_right_53k")
GLB = ("webxr_generic_hand_left", "webxr_generic_hand_right")
INDEX = "index-finger-phalanx-"


@pytest.fixture(scope="module", params=RIGS)
def rigged(request: pytest.FixtureRequest) -> qr.Hand:
    return qr.read_hand(hand_file(request.param))


@pytest.fixture(scope="module", params=RIGS + DENSE)
def sparse_or_dense(request: pytest.FixtureRequest) -> qr.Hand:
    return qr.read_hand(hand_file(request.param))


@pytest.fixture(scope="module")
def hand() -> qr.Hand:
    return qr.read_hand(hand_file("makehuman_male_right_13k"))


@pytest.fixture(scope="module", params=GLB)
def from_glb(request: pytest.FixtureRequest) -> qr.Hand:
    return qr.read_hand(hand_file(request.param, ".glb"))


@pytest.fixture(scope="module", params=(*RIGS, *GLB, "built in"))
def bendable(request: pytest.FixtureRequest) -> qr.Hand:
    if request.param == "built in":
        return qr.models.hand(edge_length=3e-3)
    return qr.read_hand(hand_file(request.param, ".glb" if request.param in GLB else ".ply"))


def parts_of(hand: qr.Hand) -> dict[str, Any]:
    return {
        "joint_names": hand.joint_names,
        "parents": hand.parents,
        "rest": hand.rest,
        "joints": hand.joints,
        "weights": hand.weights,
    }


def spin(axis: int, angle: float) -> np.ndarray:
    turn = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turn[[a, a, b, b], [a, b, a, b]] = math.cos(angle), -math.sin(angle), math.sin(angle), math.cos(angle)
    return turn


def volume_of(surface: qr.Surface, faces: np.ndarray) -> float:
    """Volume (m^3) between some faces and the fan that closes their border."""
    sides = sides_of(faces).tolist()
    known = {(a, b) for a, b in sides}
    border = np.array([(b, a) for a, b in sides if (b, a) not in known])
    middle = surface.vertices[np.unique(border)].mean(axis=0)
    # The fan's own cones have no height above its middle.
    return float(np.linalg.det(surface.vertices[faces] - middle).sum() / 6.0)


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


def test_the_rest_pose_is_the_file(rigged: qr.Hand) -> None:
    for pose in ({}, np.zeros((len(rigged.joint_names), 3))):
        posed = rigged.posed(pose)
        assert np.abs(posed.surface.vertices - rigged.surface.vertices).max() == 0.0
        np.testing.assert_array_equal(posed.joints, rigged.rest)


def test_a_rigid_motion_of_the_hand_moves_every_vertex_rigidly(rigged: qr.Hand) -> None:
    turn, shift = spin(0, 2.0) @ spin(2, -0.7), np.array([0.3, -0.2, 0.5])
    fist = rigged.posed("fist")
    moved = rigged.posed("fist", rotation=turn, translation=shift)
    expected = fist.surface.vertices @ turn.T + shift
    assert np.abs(moved.surface.vertices - expected).max() < 1e-12 * np.abs(expected).max()
    at_rest_there = rigged.moved(turn, shift).posed("fist")
    assert np.abs(at_rest_there.surface.vertices - expected).max() < 1e-12 * np.abs(expected).max()


def right_angles(hand: qr.Hand, digit: str, links: Sequence[str]) -> np.ndarray:
    """Rotation vectors that bend some joints of a digit to 90 degrees from straight."""
    stem = {"thumb": "thumb", "little": "pinky-finger"}.get(digit, f"{digit}-finger")
    joints = [hand.joint_names.index(f"{stem}-phalanx-{link}") for link in links]
    vectors = np.zeros((len(hand.joint_names), 3))
    vectors[joints, 0] = bend_at_rest(hand)[joints] - math.pi / 2
    return vectors


@pytest.mark.parametrize("digit", DIGITS)
def test_a_digit_bent_by_a_right_angle_keeps_its_volume(bendable: qr.Hand, digit: str) -> None:
    own = np.char.startswith(bendable.labels, f"{digit}-") & ~np.char.endswith(
        bendable.labels, "metacarpal-head"
    )
    faces = bendable.surface.faces[own[bendable.surface.faces].all(axis=1)]
    at_rest = volume_of(bendable.surface, faces)

    def gain(links: Sequence[str], *, linear: bool = False) -> float:
        bent = bendable.posed(right_angles(bendable, digit, links), linear=linear).surface
        return volume_of(bent, faces) / at_rest - 1.0

    hinges = ("distal",) if digit == "thumb" else ("intermediate", "distal")
    for link in ("proximal", *hinges):
        assert gain([link]) == pytest.approx(0.0, abs=0.02)
    for link in hinges:
        # Blended as matrices the joint collapses.
        assert gain([link], linear=True) < gain([link])
    assert gain(["proximal", *hinges]) == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize("digit", DIGITS)
def test_no_face_of_a_digit_turns_over_where_its_hinges_bend(bendable: qr.Hand, digit: str) -> None:
    own = np.char.startswith(bendable.labels, f"{digit}-") & np.char.endswith(bendable.labels, "-palmar")
    faces = bendable.surface.faces[own[bendable.surface.faces].all(axis=1)]
    links = ("distal",) if digit == "thumb" else ("intermediate", "distal")
    for bent in ([link] for link in links):
        posed = bendable.posed(right_angles(bendable, digit, bent))
        corners, normals = posed.surface.vertices[faces], posed.surface.vertex_normals[faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert ((across * normals.mean(axis=1)).sum(axis=1) > 0.0).all()
    # Each pad goes with its bone, right to the crease.
    posed = bendable.posed(right_angles(bendable, digit, links))
    pad = faces[(bendable.labels == f"{digit}-distal-palmar")[faces].all(axis=1)]
    motion = posed.motions[bendable.joint_names.index(JOINTS_21[4 * DIGITS.index(digit) + 3])][:3, :3]
    rest, moved = (
        np.cross(at[pad[:, 1]] - at[pad[:, 0]], at[pad[:, 2]] - at[pad[:, 0]])
        for at in (bendable.surface.vertices, posed.surface.vertices)
    )
    assert ((rest @ motion.T * moved).sum(axis=1) > 0.0).all()


def test_next_to_no_skin_turns_over_where_knuckles_bend_and_fists_close(bendable: qr.Hand) -> None:
    faces = bendable.surface.faces

    def turned_over(pose: Any) -> float:
        posed = bendable.posed(pose)
        corners = posed.surface.vertices[faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        at_rest = bendable.surface.vertices[faces]
        outward = np.cross(at_rest[:, 1] - at_rest[:, 0], at_rest[:, 2] - at_rest[:, 0])
        turns = np.einsum("fj,jab->fab", bendable._shares[faces].mean(axis=1), posed.motions[:, :3, :3])
        return float((np.einsum("fab,fb,fa->f", turns, outward, across) <= 0.0).mean())

    for digit in DIGITS:
        # Up to 6e-3 by the weights of the files; the GLB hands have 2,314 faces in all.
        assert turned_over(right_angles(bendable, digit, ["proximal"])) < 3e-3
    # Up to 2e-2 by the weights of the files.
    assert turned_over("fist") < 4e-3


def test_flexion_leads_towards_the_palm_and_abduction_away_from_the_middle_finger(rigged: qr.Hand) -> None:
    palm = rigged.posed({}).palm
    names = list(rigged.joint_names)

    def tip(pose: dict[str, Any], digit: str) -> np.ndarray:
        return palm[:3, :3].T @ rigged.posed(pose).joints[names.index(f"{digit}-finger-tip"), :3, 3]

    for digit in ("index", "middle", "ring", "pinky"):
        joint = f"{digit}-finger-phalanx-proximal"
        assert tip({joint: 0.4}, digit)[2] > tip({}, digit)[2] + 5e-3
    for digit in ("index", "ring", "pinky"):
        joint = f"{digit}-finger-phalanx-proximal"
        apart = [
            np.linalg.norm(tip(pose, digit) - tip({}, "middle")) for pose in ({joint: {"abduction": 0.2}}, {})
        ]
        assert apart[0] > apart[1] + 2e-3


def test_an_array_is_the_same_pose_as_its_mapping(hand: qr.Hand) -> None:
    at = hand.joint_names.index(f"{INDEX}proximal")
    vectors = np.zeros((len(hand.joint_names), 3))
    vectors[at, 0] = -0.7
    quaternions = np.tile([0.0, 0.0, 0.0, 1.0], (len(hand.joint_names), 1))
    quaternions[at] = [-math.sin(0.35), 0.0, 0.0, math.cos(0.35)]
    by_name = hand.posed({f"{INDEX}proximal": 0.7})
    for rows in (vectors, quaternions):
        np.testing.assert_allclose(hand.posed(rows).surface.vertices, by_name.surface.vertices, atol=1e-15)


def test_a_mixture_lies_on_the_way(hand: qr.Hand) -> None:
    ends = [{f"{INDEX}proximal": angle} for angle in (0.2, 0.8)]
    middle = hand.posed(qr.hand.mix(*ends, 0.25))
    expected = hand.posed({f"{INDEX}proximal": 0.35})
    np.testing.assert_allclose(middle.surface.vertices, expected.surface.vertices, atol=1e-14)
    for share, end in zip((0.0, 1.0), ("flat", "fist"), strict=True):
        mixed = hand.posed(qr.hand.mix("flat", "fist", share))
        np.testing.assert_allclose(mixed.joints, hand.posed(end).joints, atol=1e-14)


@pytest.mark.parametrize("half", [np.float32(0.5), np.array(0.5), Fraction(1, 2)])
def test_a_share_is_any_number_from_0_to_1(half: Any) -> None:
    assert qr.hand.mix("flat", "fist", half).share == 0.5
    assert qr.hand.mix("flat", "fist", np.int64(1)).share == 1.0


@pytest.mark.parametrize("share", [True, np.True_, "0.5", None, math.nan, -0.1, 1.1, 10**400, [0.5, 0.5]])
def test_what_is_no_share_is_refused(share: Any) -> None:
    with pytest.raises(qr.HandError, match=r"share is .*, expected a number from 0 to 1"):
        qr.hand.mix("flat", "fist", share)


def test_presets_bend_the_fingers_alike_whatever_their_bend_at_rest() -> None:
    for pose, bend in (("flat", 0.0), ("fist", 100.0)):
        for name in RIGS:
            hand = qr.read_hand(hand_file(name))
            posed = hand.posed(pose)
            before, after = (
                posed.frame_of(f"middle-finger-phalanx-{one}")[:3, 1] for one in ("proximal", "intermediate")
            )
            angle = math.degrees(math.acos(np.clip(before @ after, -1.0, 1.0)))
            # Sideways bends of some degrees at rest stay.
            assert abs(angle - bend) < 5.0


def test_angles_beyond_the_range_of_a_joint_are_taken_at_its_end(hand: qr.Hand) -> None:
    with pytest.warns(qr.QuasirigidWarning, match=r"flexion of index-finger-phalanx-distal is 172 .* in rad"):
        beyond = hand.posed({f"{INDEX}distal": 3.0})
    with pytest.warns(qr.QuasirigidWarning):
        further = hand.posed({f"{INDEX}distal": 3.1})
    np.testing.assert_array_equal(beyond.joints, further.joints)


def test_half_a_turn_is_the_most_of_a_joint_of_no_digit(hand: qr.Hand) -> None:
    with pytest.warns(
        qr.QuasirigidWarning, match=r"flexion of wrist is 3438 degrees, taken as 180; .* in rad"
    ):
        beyond = hand.posed({"wrist": 60.0})
    np.testing.assert_array_equal(beyond.joints, hand.posed({"wrist": math.pi}).joints)


def test_a_joint_that_moves_no_skin_is_told(hand: qr.Hand) -> None:
    with pytest.warns(qr.QuasirigidWarning, match="index-finger-tip moves no skin"):
        posed = hand.posed({"index-finger-tip": 0.5})
    np.testing.assert_allclose(posed.surface.vertices, hand.surface.vertices, rtol=0, atol=1e-15)


def test_every_vertex_has_a_region_in_one_piece(sparse_or_dense: qr.Hand) -> None:
    labels, faces = sparse_or_dense.labels, sparse_or_dense.surface.faces
    assert len(labels) == len(sparse_or_dense.surface.vertices)
    phalanges = [
        (d, p) for d in DIGITS for p in ("proximal", "middle", "distal") if (d, p) != ("thumb", "middle")
    ]
    expected = {f"{d}-{p}-{s}" for d, p in phalanges for s in ("palmar", "dorsal", "radial", "ulnar")}
    expected |= {f"{digit}-metacarpal-head" for digit in DIGITS[1:]}
    expected |= {f"web-{one}" for one in ("thumb-index", "index-middle", "middle-ring", "ring-little")}
    expected |= {"palm-center", "thenar", "hypothenar", "back", "wrist"}
    assert set(labels) == expected
    for region in expected:
        own = np.flatnonzero(labels == region)
        inside = faces[(labels[faces] == region).any(axis=1)]
        group = {int(vertex): int(vertex) for vertex in own}

        def root(vertex: int, group: dict[int, int] = group) -> int:
            while group[vertex] != vertex:
                group[vertex] = group[group[vertex]]
                vertex = group[vertex]
            return vertex

        for face in inside.tolist():
            same = [vertex for vertex in face if vertex in group]
            for other in same[1:]:
                group[root(other)] = root(same[0])
        assert len({root(vertex) for vertex in group}) == 1, region


def test_skin_under_a_finger_is_no_other_fingers(sparse_or_dense: qr.Hand) -> None:
    """Webs that reached across the base of a finger cut its palmar skin off."""
    labels, surface = sparse_or_dense.labels, sparse_or_dense.surface
    out = sparse_or_dense.frame_of("wrist")[:3, 2]
    stems = {"index": "index", "middle": "middle", "ring": "ring", "little": "pinky"}
    for digit, stem in stems.items():
        knuckle, joint = (
            sparse_or_dense.frame_of(f"{stem}-finger-phalanx-{link}")[:3, 3]
            for link in ("proximal", "intermediate")
        )
        along = (joint - knuckle) - ((joint - knuckle) @ out) * out
        length = np.linalg.norm(along)
        aside = np.cross(along / length, out)
        way = surface.vertices - knuckle
        share = way @ along / length**2
        under = (share > 0.05) & (share < 0.9) & (np.abs(way @ aside) < 3e-3)
        under &= surface.vertex_normals @ out < -0.5
        assert under.any()
        for other in stems.keys() - {digit}:
            assert not np.char.startswith(labels[under], f"{other}-").any()


def test_phalanges_end_at_their_joints(sparse_or_dense: qr.Hand) -> None:
    labels, surface = sparse_or_dense.labels, sparse_or_dense.surface
    edges = sides_of(surface.faces)
    for digit in DIGITS:
        words = ("proximal", "distal") if digit == "thumb" else ("proximal", "middle", "distal")
        stem = {"thumb": "thumb", "little": "pinky-finger"}.get(digit, f"{digit}-finger")
        links = ("proximal", "distal") if digit == "thumb" else ("proximal", "intermediate", "distal")
        for at, link in enumerate(links[1:]):
            before, after = (sparse_or_dense.frame_of(f"{stem}-phalanx-{one}") for one in (links[at], link))
            both = [np.char.startswith(labels, f"{digit}-{words[one]}")[edges] for one in (at, at + 1)]
            border = edges[both[0].any(axis=1) & both[1].any(axis=1)]
            away = surface.vertices[border].mean(axis=1) - after[:3, 3]
            # A bent finger's phalanges meet where its bend is halved: no edge reaches beyond.
            halved = before[:3, 1] + after[:3, 1]
            assert np.abs(away @ halved / np.linalg.norm(halved)).max() < surface.mean_edge_length
            for frame in (before, after):
                assert np.abs((away @ frame[:3, 1]).mean()) < 4e-3


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


def test_bones_move_rigidly_with_their_joints(hand: qr.Hand) -> None:
    bent = hand.posed({f"{INDEX}distal": 0.8})
    start = 0
    for bone in hand.bones:
        moved = bent.bones.vertices[start : start + len(bone.vertices)]
        start += len(bone.vertices)
        lengths = [np.linalg.norm(np.diff(one, axis=0), axis=1) for one in (moved, bone.vertices)]
        np.testing.assert_allclose(lengths[0], lengths[1], atol=1e-12)
        assert (np.abs(moved - bone.vertices).max() > 1e-3) == (bone.name == "index-distal")


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


def test_a_glb_hand_is_read_with_its_side(from_glb: qr.Hand, request: pytest.FixtureRequest) -> None:
    assert from_glb.side == request.node.callspec.params["from_glb"].rsplit("_", 1)[1]
    assert len(from_glb.surface.vertices) == 1159  # its 1,360 points without texture seams
    assert from_glb.surface.volume == pytest.approx(343.2e-6, rel=1e-3)
    distal = from_glb.frame_of("wrist")[:3, 1]
    fist, flat = from_glb.posed("fist"), from_glb.posed("flat")
    tip = from_glb.joint_names.index("middle-finger-tip")
    assert fist.joints[tip, :3, 3] @ distal < flat.joints[tip, :3, 3] @ distal - 0.05


def test_a_saved_hand_is_read_back(hand: qr.Hand, tmp_path: Path) -> None:
    path = tmp_path / "hand.glb"
    hand.save(path)
    again = qr.read_hand(path)
    assert again.side == hand.side
    order = [again.joint_names.index(name) for name in hand.joint_names]
    np.testing.assert_allclose(again.surface.vertices, hand.surface.vertices, atol=1e-8)
    np.testing.assert_array_equal(again.surface.faces, hand.surface.faces)
    np.testing.assert_allclose(again.rest[order][:, :3, 3], hand.rest[:, :3, 3], atol=1e-7)
    np.testing.assert_allclose(again.rest[order][:, :3, 1], hand.rest[:, :3, 1], atol=1e-5)


def test_a_joint_of_a_file_that_hangs_on_none_hangs_on_the_root(hand: qr.Hand, tmp_path: Path) -> None:
    def part(description: dict[str, Any]) -> None:
        for node in description["nodes"]:
            if node.get("name") == "forearm":
                del node["children"]

    path = tmp_path / "saved.glb"
    hand.save(path)
    again = qr.read_hand(glb_with(part, tmp_path, path))
    assert {again.joint_names[joint] for joint in np.flatnonzero(again.parents < 0)} == {"wrist"}
    assert again.joint_names[again.parents[again.joint_names.index("forearm")]] == "wrist"


def test_a_saved_contact_holds_pressure_and_the_pressed_skin(hand: qr.Hand, tmp_path: Path) -> None:
    from quasirigid.hand.files.gltf import Gltf

    palm = hand.posed({}).palm
    ball = qr.Obstacle.sphere(palm[:3, 3] + 0.03 * palm[:3, 2], 0.02)
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.495, response=qr.HalfSpace())
    contact = qr.press(hand.surface, ball, skin, -palm[:3, 2], depth=1e-3)
    path = tmp_path / "pressed.glb"
    hand.save(path, contact)
    file = Gltf(path)
    part = file.entry("meshes", 0, "primitives", 0)
    pressure = file.rows(part["attributes"]["_PRESSURE"]).ravel()
    np.testing.assert_allclose(pressure, contact.pressure, rtol=1e-6)
    places = file.rows(part["attributes"]["POSITION"]) + file.rows(part["targets"][0]["POSITION"])
    np.testing.assert_allclose(places, contact.deformed.vertices, atol=1e-7)
    weights = file.rows(part["attributes"]["WEIGHTS_0"])
    assert len(weights) == len(contact.pressure)


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


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        ("fists", r"the pose 'fists' is not known; the nearest is 'fist', of flat, open, .*, fist$"),
        ({"index-finger-proximal": 0.1}, r"nearest is 'index-finger-phalanx-proximal'"),
        ({"wrist": {"flexing": 0.1}}, r"the angle of wrist 'flexing' is not known; the nearest is 'flexion'"),
        ({"wrist": math.nan}, r"flexion of wrist is nan, expected a finite angle"),
        ({"wrist": np.True_}, r"flexion of wrist is .*True.*, expected a finite angle"),
        (np.full((26, 3), math.nan), r"pose\[0\] is \[nan, nan, nan\], expected finite numbers"),
        (np.zeros((25, 3)), r"an array \(26, 3\) of rotation vectors"),
        (np.zeros((26, 4)), r"pose\[0\] has length 0, expected a unit quaternion"),
        (7, r"expected a preset's name"),
    ],
)
def test_a_faulty_pose_is_refused(hand: qr.Hand, pose: Any, message: str) -> None:
    with pytest.raises(qr.HandError, match=message):
        hand.posed(pose)


def test_faulty_files_are_named(tmp_path: Path) -> None:
    source = hand_file(GLB[1], ".glb").read_bytes()
    path = tmp_path / "hand.glb"

    def read(data: bytes) -> None:
        path.write_bytes(data)
        qr.read_hand(path)

    length = struct.unpack_from("<I", source, 12)[0]
    text, rest = source[20 : 20 + length], source[20 + length :]

    def with_text(changed: bytes) -> bytes:
        changed = changed + b" " * (-len(changed) % 4)
        head = struct.pack("<4sII", b"glTF", 2, 20 + len(changed) + len(rest))
        return head + struct.pack("<I4s", len(changed), b"JSON") + changed + rest

    with pytest.raises(qr.MeshFileError, match=r"ends after \d+ of \d+ bytes"):
        read(source[:-100])
    with pytest.raises(qr.MeshFileError, match="does not begin as a GLB"):
        read(b"ply\n" + source)
    with pytest.raises(qr.HandError, match="has 0 skins, expected one"):
        read(with_text(text.replace(b'"skins"', b'"other"')))
    with pytest.raises(qr.HandError, match="has no joint 'thumb-tip'"):
        read(with_text(text.replace(b'"thumb-tip"', b'"thumb-end"')))
    with pytest.raises(qr.MeshFileError, match="reads up to byte"):
        read(with_text(text.replace(b'"count":1360', b'"count":9990')))


@pytest.mark.parametrize(
    ("children", "message"),
    [
        (
            {"wrist": ["thumb-tip"]},
            r"node 4 \('thumb-tip'\) hangs on two nodes, node 0 \('wrist'\) and node 26",
        ),
        ({"thumb-tip": ["Armature"]}, r"run in a circle through node 26 \('Armature'\)"),
        ({"Armature": ["Armature"]}, r"run in a circle through node 26 \('Armature'\)"),
        ({"thumb-tip": [10**6]}, "its description has no nodes/1000000"),
        ({"thumb-tip": 3}, "the children of node .* are 3, no list"),
    ],
)
def test_nodes_that_form_no_trees_are_named(tmp_path: Path, children: dict[str, Any], message: str) -> None:
    def hang(description: dict[str, Any]) -> None:
        nodes = description["nodes"]
        number = {node.get("name"): at for at, node in enumerate(nodes)}
        for name, held in children.items():
            nodes[number[name]]["children"] = (
                [number.get(one, one) for one in held] if isinstance(held, list) else held
            )

    with pytest.raises(qr.QuasirigidError, match=message):
        qr.read_hand(glb_with(hang, tmp_path))


def glb_with(change: Callable[[dict[str, Any]], None], folder: Path, of: Path | None = None) -> Path:
    """Write the published hand, or that of a file, with another description."""
    source = (of or hand_file(GLB[1], ".glb")).read_bytes()
    length = struct.unpack_from("<I", source, 12)[0]
    description = json.loads(source[20 : 20 + length])
    change(description)
    text = json.dumps(description).encode()
    text += b" " * (-len(text) % 4)
    rest = source[20 + length :]
    path = folder / "hand.glb"
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    path.write_bytes(head + struct.pack("<I4s", len(text), b"JSON") + text + rest)
    return path


def part_of(description: dict[str, Any]) -> dict[str, Any]:
    part: dict[str, Any] = description["meshes"][0]["primitives"][0]
    return part


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda file: file.update(nodes=5), "has 5 as nodes, expected objects"),
        (lambda file: file["nodes"].append(7), "as nodes, expected objects"),
        (lambda file: file.update(skins=7), "has 7 as skins, expected objects"),
        (lambda file: file["skins"][0].update(joints=7), "the joints of its skin are 7, no list"),
        (lambda file: file["meshes"][0].update(primitives=[]), "its mesh has no parts"),
        (lambda file: part_of(file).update(attributes=3), "attributes that are no object"),
        (
            lambda file: part_of(file)["attributes"].update(
                WEIGHTS_0=part_of(file)["attributes"]["POSITION"]
            ),
            r"1360 points, joints \(1360, 4\) and weights \(1360, 3\)",
        ),
        (lambda file: file["skins"][0].update(joints=[0, 1, 2]), r"names joint 23, but there are 3"),
        (lambda file: file["accessors"].insert(0, 3), "as accessors, expected objects"),
    ],
)
def test_a_glb_of_other_things_is_named(
    tmp_path: Path, change: Callable[[dict[str, Any]], None], message: str
) -> None:
    with pytest.raises(qr.QuasirigidError, match=message):
        qr.read_hand(glb_with(change, tmp_path))


@pytest.mark.parametrize(("unit", "length"), [("mm", "0.0002"), ("cm", "0.002"), ("inch", "0.005")])
def test_a_hand_in_another_unit_is_told(unit: Any, length: str) -> None:
    path = hand_file("makehuman_male_right_13k")
    with pytest.warns(qr.SizeWarning, match=rf"the hand is {length}\d* m long .* another unit"):
        qr.read_hand(path, unit=unit)


def test_joints_in_another_unit_than_the_skin_are_told(hand: qr.Hand) -> None:
    vertices, faces = hand.surface.vertices, hand.surface.faces
    # Joints in metres all lie in the wrist of a skin in millimetres.
    with pytest.raises(qr.HandError, match=r"mm inside the skin, .* same unit and frame"):
        qr.Hand(vertices * 1e3, faces, **parts_of(hand))
    with pytest.raises(qr.HandError, match=r"mm outside the skin .* same unit and frame"):
        qr.Hand(vertices * 1e-3, faces, **parts_of(hand))


def test_a_rig_that_does_not_fit_is_named(tmp_path: Path) -> None:
    mesh = hand_file("webxr_right_middle_1500")
    with pytest.raises(
        qr.HandError, match=r"0 sets of weights fit a mesh of 1492 vertices; it holds 13k \(13004"
    ):
        qr.read_hand(mesh)
    other = tmp_path / mesh.name
    other.write_bytes(mesh.read_bytes())
    with pytest.raises(qr.HandError, match="no rig beside it"):
        qr.read_hand(other)


@pytest.mark.parametrize("damage", ["in the head", "in what is compressed", "in the version"])
def test_a_damaged_rig_is_named(tmp_path: Path, damage: str) -> None:
    tetrahedron = tmp_path / "hand.obj"
    tetrahedron.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    rig = tmp_path / "broken_rig.npz"
    np.savez_compressed(rig, rest=np.random.default_rng(3).random((26, 4, 4)))
    data = bytearray(rig.read_bytes())
    if damage == "in the head":
        data[2:] = b"\x03\x04 not a file of arrays"
    elif damage == "in what is compressed":
        data[60:200] = b"\xff" * 140
    else:
        data[data.rindex(b"PK\x01\x02") + 6] = 200  # of the program that would be needed
    rig.write_bytes(data)
    with pytest.raises(qr.HandError, match=r"broken_rig.npz: no file of arrays"):
        qr.read_hand(tetrahedron, rig=rig)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"13k_weight": np.full((13013, 8), "a")}, "`weights` has dtype <U1, expected real numbers"),
        ({"13k_weight": np.full((13013, 8), 0.0625)}, r"weights\[0\] sums to 0\.5"),
        ({"13k_joint": np.zeros((13013, 8))}, "`joints` has dtype float64, expected integers"),
        ({"rest": np.array(["a"] * 26)}, "could not convert string to float"),
        ({"side": "both"}, "side is 'both'"),
        ({"13k_joint": np.array(5)}, "0 sets of weights fit a mesh of 13013 vertices"),
    ],
)
def test_a_rig_of_other_things_is_named(tmp_path: Path, change: dict[str, Any], message: str) -> None:
    mesh = hand_file("makehuman_male_right_13k")
    rig = tmp_path / "rig.npz"
    known = dict(np.load(hand_file("makehuman_male_right_rig", ".npz")))
    np.savez(rig, **(known | change))
    with pytest.raises(qr.HandError, match=message):
        qr.read_hand(mesh, rig=rig)


def test_a_picture_shows_each_region_in_a_color_of_its_own_and_the_joints() -> None:
    colors = pytest.importorskip("matplotlib.colors")
    posed = qr.models.hand(edge_length=4e-3).posed("flat")
    plain, regions = (
        qr.plot.hand_figure(posed, views=["palm"], regions=regions).axes[0] for regions in (False, True)
    )
    with pytest.raises(qr.HandError, match=r"views holds 'side', expected some of palm, back, aslant"):
        qr.plot.hand_figure(posed, views=["side"])
    assert not plain.lines
    assert len(regions.lines[0].get_xdata()) == len(posed.joints)
    hues = [
        colors.rgb_to_hsv(np.clip(ax.images[0].get_array()[..., :3], 0.0, 1.0)).reshape(-1, 3)
        for ax in (plain, regions)
    ]
    # Skin is of one hue; of the regions that the palm shows there are a dozen and more.
    found = [len(np.unique((one[one[:, 1] > 0.3][:, 0] * 30).astype(int))) for one in hues]
    assert found[1] > 12 > 3 >= found[0]


@pytest.mark.parametrize("pose", ["flat", "relaxed", "cylinder"])
@pytest.mark.parametrize("quarter", [0, 1])
def test_a_hand_that_was_bound_bent_comes_back_from_its_file(tmp_path: Path, pose: str, quarter: int) -> None:
    made = qr.models.hand(edge_length=5e-3)
    for hand in (made, made.mirrored()):
        posed = hand.posed(pose)
        bound = qr.Hand(
            posed.surface.vertices,
            hand.surface.faces,
            **(parts_of(hand) | {"rest": posed.joints}),
            side=hand.side,
        )
        # As the file of another program, whose bones lead along x and whose backs look along y.
        turned = posed.joints.copy()
        if quarter:
            turned[:, :3, :3] = turned[:, :3, [1, 2, 0]]
        frames, side = uniform_frames(hand.joint_names, turned)
        assert side == hand.side
        cosines = np.einsum("jab,jab->jb", frames[:, :3, :3], posed.joints[:, :3, :3])
        assert cosines[1:].min() > (math.cos(0.3) if quarter else 1.0 - 1e-12)
        bound.save(tmp_path / "bound.glb")
        back = qr.read_hand(tmp_path / "bound.glb")
        # float32
        np.testing.assert_allclose(back.rest, bound.rest, atol=1e-6)
        assert (back.labels == bound.labels).all()


def glb_parts(path: Path) -> tuple[dict[str, Any], bytearray]:
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + size]), bytearray(data[28 + size :])


def test_scales_of_bind_matrices_and_nodes_count(tmp_path: Path) -> None:
    made = qr.models.hand(edge_length=5e-3)
    made.save(tmp_path / "hand.glb")
    described, binary = glb_parts(tmp_path / "hand.glb")

    def array(accessor: int, columns: int) -> np.ndarray:
        known = described["accessors"][accessor]
        view = described["bufferViews"][known["bufferView"]]
        start = view.get("byteOffset", 0) + known.get("byteOffset", 0)
        return np.frombuffer(binary, "<f4", known["count"] * columns, start).reshape(-1, columns)

    primitive = described["meshes"][0]["primitives"][0]
    array(primitive["attributes"]["POSITION"], 3)[:] *= 100.0
    inverse = array(described["skins"][0]["inverseBindMatrices"], 16).reshape(-1, 4, 4)
    inverse[:, :3, :3] *= 0.01
    described["buffers"] = [{"byteLength": len(binary), "uri": "hand%20of%20cm.bin"}]
    (tmp_path / "hand of cm.bin").write_bytes(binary)
    (tmp_path / "hand.gltf").write_text(json.dumps(described))
    np.testing.assert_allclose(
        qr.read_hand(tmp_path / "hand.gltf").surface.vertices, made.surface.vertices, atol=1e-7
    )
    # The same in metres once more: the skeleton hangs on a node that is a hundredth.
    inverse[:, :3, :3] *= 1e4
    inverse[:, 3, :3] *= 1e4
    array(primitive["attributes"]["POSITION"], 3)[:] *= 0.01
    inverse[:, 3, :3] *= 1e-2
    root = described["skins"][0]["joints"][0]
    described["nodes"].append({"scale": [0.01, 0.01, 0.01], "children": [root]})
    described["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(binary).decode()
    (tmp_path / "hand.gltf").write_text(json.dumps(described))
    np.testing.assert_allclose(
        qr.read_hand(tmp_path / "hand.gltf").surface.vertices, made.surface.vertices, atol=1e-7
    )


@pytest.mark.parametrize(
    "node",
    [
        {"scale": [-1, 1, 1]},
        {"scale": [1, 1, 3]},
        {"scale": [0, 0, 0]},
        {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]},
        {"matrix": [0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]},
    ],
)
def test_an_uneven_or_mirrored_scale_is_refused_by_its_node(tmp_path: Path, node: dict[str, Any]) -> None:
    with pytest.raises(qr.HandError, match=r"node 27 \('Holder'\) has an uneven or mirrored scale: apply it"):
        qr.read_hand(glb_on(node, tmp_path))


@pytest.mark.parametrize(
    "node", [{"scale": [2, 2, 2]}, {"matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 0, 0, 1]}]
)
def test_an_even_scale_counts(tmp_path: Path, node: dict[str, Any]) -> None:
    length = qr.read_hand(hand_file(GLB[1], ".glb")).length
    assert qr.read_hand(glb_on(node, tmp_path)).length == pytest.approx(2.0 * length)


def glb_on(node: dict[str, Any], folder: Path) -> Path:
    """Write the published hand, all of it on one more node."""

    def hang(description: dict[str, Any]) -> None:
        held = description["scenes"][0]["nodes"]
        description["nodes"].append({"name": "Holder", "children": held, **node})

    return glb_with(hang, folder)


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("../hand.bin", r"buffers/0 is '../hand.bin', expected a file beside it or its bytes"),
        ("data:;base64,#", r"buffers/0 is no base64"),
        ("none.bin", r"none.bin: No such file"),
        (None, r"buffers/0 is None"),
    ],
)
def test_a_buffer_that_is_not_there_is_named(tmp_path: Path, uri: str | None, message: str) -> None:
    qr.models.hand(edge_length=5e-3).save(tmp_path / "hand.glb")
    described, _ = glb_parts(tmp_path / "hand.glb")
    described["buffers"][0]["uri"] = uri
    (tmp_path / "hand.gltf").write_text(json.dumps(described))
    with pytest.raises(qr.MeshFileError, match=message):
        qr.read_hand(tmp_path / "hand.gltf")


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


def test_labels_of_ones_own_change_no_pose_and_no_grasp() -> None:
    hand = qr.models.hand(edge_length=5e-3)
    own = qr.Hand(
        hand.surface.vertices, hand.surface.faces, **parts_of(hand), labels=["skin"] * len(hand.labels)
    )
    assert (own.labels == "skin").all()
    assert (own.regions == hand.regions).all()
    fists = [one.posed("fist") for one in (own, hand)]
    np.testing.assert_allclose(fists[0].surface.vertices, fists[1].surface.vertices, atol=1e-15)
    np.testing.assert_allclose(fists[0].palm, fists[1].palm, atol=1e-15)
