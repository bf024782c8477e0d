"""Poses: digits keep their volume and bend the right way, angles are checked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from hands import GLB, INDEX, RIGS
from quasirigid._geometry import sides_of
from quasirigid.hand import DIGITS, JOINTS_21
from quasirigid.hand.bend import shares_of
from quasirigid.hand.pose import bend_at_rest
from shared_meshes import hand_file


@pytest.fixture(scope="module", params=(*RIGS, *GLB, "built in"))
def bendable(request: pytest.FixtureRequest) -> qr.Hand:
    if request.param == "built in":
        return qr.models.hand(edge_length=3e-3)
    return qr.read_hand(hand_file(request.param, ".glb" if request.param in GLB else ".ply"))


def volume_of(surface: qr.Surface, faces: np.ndarray) -> float:
    """Volume (m^3) between some faces and the fan that closes their border."""
    sides = sides_of(faces).tolist()
    known = {(a, b) for a, b in sides}
    border = np.array([(b, a) for a, b in sides if (b, a) not in known])
    middle = surface.vertices[np.unique(border)].mean(axis=0)
    # The fan's own cones have no height above its middle.
    return float(np.linalg.det(surface.vertices[faces] - middle).sum() / 6.0)


def test_the_rest_pose_is_the_file(rigged: qr.Hand) -> None:
    for pose in ({}, np.zeros((len(rigged.joint_names), 3))):
        posed = rigged.posed(pose)
        assert np.abs(posed.surface.vertices - rigged.surface.vertices).max() == 0.0
        np.testing.assert_array_equal(posed.joints, rigged.rest)


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


def test_a_pose_hangs_little_on_how_fine_the_mesh_is(bendable: qr.Hand) -> None:
    points, faces, count = bendable.surface.vertices, bendable.surface.faces, len(bendable.labels)
    ends, middles = np.unique(np.sort(sides_of(faces), axis=1), axis=0, return_inverse=True)
    a, b, c = faces.T
    ab, bc, ca = count + middles.reshape(3, -1)
    quarters = np.concatenate([(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)], axis=1).T
    shares = shares_of(bendable)
    shares = np.concatenate([shares, shares[ends].mean(axis=1)])
    finer = qr.Hand(
        np.concatenate([points, points[ends].mean(axis=1)]),
        quarters,
        joint_names=bendable.joint_names,
        parents=bendable.parents,
        rest=bendable.rest,
        joints=np.tile(np.arange(shares.shape[1]), (len(shares), 1)),
        weights=shares,
    )
    off = finer.posed("relaxed").surface.vertices[:count] - bendable.posed("relaxed").surface.vertices
    # Rounds of smoothing by neighbours moved it by up to 2.2 of them.
    assert np.linalg.norm(off, axis=1).max() < 0.5 * bendable.surface.mean_edge_length


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


def test_bones_move_rigidly_with_their_joints(hand: qr.Hand) -> None:
    bent = hand.posed({f"{INDEX}distal": 0.8})
    start = 0
    for bone in hand.bones:
        moved = bent.bones.vertices[start : start + len(bone.vertices)]
        start += len(bone.vertices)
        lengths = [np.linalg.norm(np.diff(one, axis=0), axis=1) for one in (moved, bone.vertices)]
        np.testing.assert_allclose(lengths[0], lengths[1], atol=1e-12)
        assert (np.abs(moved - bone.vertices).max() > 1e-3) == (bone.name == "index-distal")


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
