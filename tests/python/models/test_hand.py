"""The built-in hand: closed, even, of the size asked for, its joints inside and its weights smooth."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from numpy.typing import NDArray
from quasirigid.errors import SurfaceError

Floats = NDArray[np.float64]


@cache
def built(**arguments: Any) -> qr.Hand:
    return qr.models.hand(**arguments)


def coarse(**arguments: Any) -> qr.Hand:
    return built(edge_length=4e-3, **arguments)


def place(hand: qr.Hand, joint: str) -> Floats:
    return hand.rest[hand.joint_names.index(joint), :3, 3]


def skin_of(hand: qr.Hand, word: str) -> NDArray[np.bool_]:
    """Return which vertices joints with a word in their names carry by more than a hundredth."""
    own = [word in name for name in hand.joint_names]
    return np.where(np.array(own)[hand.joints], hand.weights, 0.0).sum(axis=1) > 0.01


SHAPES: dict[str, dict[str, Any]] = {
    "default": {},
    "fine": {"edge_length": 1.6e-3},
    "coarse": {"edge_length": 5e-3},
    "left": {"side": "left", "edge_length": 3e-3},
    "broad": {"hand_length": 0.165, "hand_breadth": 0.090, "edge_length": 3e-3},
    "slender": {"hand_length": 0.215, "hand_breadth": 0.075, "edge_length": 3e-3},
    "child": {"hand_length": 0.115, "hand_breadth": 0.053, "edge_length": 2e-3},
    "small woman": {"percentile": 5, "sex": "female", "edge_length": 2.5e-3},
    "large man": {"percentile": 95, "sex": "male", "edge_length": 2.5e-3},
}


@pytest.mark.parametrize("arguments", SHAPES.values(), ids=SHAPES.keys())
def test_a_hand_is_closed_outward_of_one_piece_and_free_of_slivers(arguments: dict[str, Any]) -> None:
    hand = built(**arguments)
    vertices, faces = hand.surface.vertices, hand.surface.faces
    skin = hand.surface
    assert skin.is_closed
    assert skin.volume > 0.0
    # As many pieces and handles as a sphere has; every vertex used.
    assert np.array_equal(np.unique(faces), np.arange(len(vertices)))
    assert len(vertices) - 3 * len(faces) // 2 + len(faces) == 2
    corners = vertices[faces]
    sides = corners - np.roll(corners, 1, axis=1)
    lengths = np.linalg.norm(sides, axis=2)
    cosines = -np.einsum("ijk,ijk->ij", sides, np.roll(sides, 1, axis=1)) / (
        lengths * np.roll(lengths, 1, axis=1)
    )
    angles = np.degrees(np.arccos(cosines))
    assert angles.min() > 20.0
    assert np.percentile(angles.min(axis=1), 1.0) > 35.0
    edge_length = arguments.get("edge_length", 2e-3)
    assert lengths.mean() == pytest.approx(edge_length, rel=0.06)
    assert lengths.max() < 1.6 * edge_length


@pytest.mark.parametrize("arguments", SHAPES.values(), ids=SHAPES.keys())
def test_a_hand_does_not_cross_itself(arguments: dict[str, Any]) -> None:
    hand = built(**arguments)
    qr.Obstacle.mesh(hand.surface.vertices, hand.surface.faces, check_crossings=True)


def test_the_frame_has_the_middle_knuckle_on_y_and_the_palm_below() -> None:
    hand = coarse()
    assert place(hand, "wrist") == pytest.approx(np.zeros(3))
    knuckle = place(hand, "middle-finger-phalanx-proximal")
    assert knuckle[1] > 0.0
    assert knuckle[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert (
        place(hand, "pinky-finger-tip")[0] > place(hand, "index-finger-tip")[0] > place(hand, "thumb-tip")[0]
    )
    # The thumb hangs to the palm's side, and fingers bend to it.
    assert place(hand, "thumb-tip")[2] < -0.02
    for digit in ("index", "middle", "ring", "pinky"):
        assert place(hand, f"{digit}-finger-tip")[2] < place(hand, f"{digit}-finger-phalanx-proximal")[2]


@pytest.mark.parametrize(("length", "breadth"), [(0.190, 0.085), (0.165, 0.085), (0.205, 0.090)])
def test_length_and_breadth_are_those_asked_for(length: float, breadth: float) -> None:
    hand = built(hand_length=length, hand_breadth=breadth, edge_length=2.5e-3)
    chain = ["wrist", *(name for name in hand.joint_names if name.startswith("middle-finger"))]
    way = sum(np.linalg.norm(place(hand, b) - place(hand, a)) for a, b in pairwise(chain))
    tip, axis = place(hand, chain[-1]), hand.rest[hand.joint_names.index(chain[-1]), :3, 1]
    own = skin_of(hand, "middle-finger-phalanx-distal")
    way += ((hand.surface.vertices[own] - tip) @ axis).max()
    # The foremost vertex lies up to an eighth of an edge squared over the tip's radius behind it.
    assert way == pytest.approx(length, abs=0.5e-3)
    heads = [place(hand, f"{digit}-finger-phalanx-proximal") for digit in ("index", "pinky")]
    across = (heads[1] - heads[0]) * (1.0, 1.0, 0.0)
    across /= np.linalg.norm(across)
    along = np.array([-across[1], across[0], 0.0])
    near = np.abs((hand.surface.vertices - heads[0]) @ along) < 4e-3
    near &= ~skin_of(hand, "thumb")
    assert np.ptp(hand.surface.vertices[near] @ across) == pytest.approx(breadth, rel=0.03)


def test_bones_have_the_published_proportions() -> None:
    hand = coarse()
    # Buryanov and Kotiuk 2010: metacarpal and phalanges (mm).
    published = {
        "thumb": (46.22, 31.57, 21.67),
        "index": (68.12, 39.78, 22.38, 15.82),
        "middle": (64.60, 44.63, 26.33, 17.40),
        "ring": (58.00, 41.37, 25.65, 17.30),
        "pinky": (53.69, 32.74, 18.11, 15.96),
    }
    found, expected = [], []
    for digit, lengths in published.items():
        chain = [place(hand, name) for name in hand.joint_names if name.startswith(digit)]
        found += np.linalg.norm(np.diff(chain, axis=0), axis=1).tolist()
        expected += lengths
    ratios = np.array(found) / np.array(expected)
    assert ratios == pytest.approx(ratios[0], rel=1e-12)


def test_the_volume_is_a_hand_s() -> None:
    # A hand is 0.6 % of the body's mass (Dempster 1955): 75 kg at about 1.1 g/cm^3 make 410 cm^3.
    assert 300e-6 < built().surface.volume < 450e-6
    larger = coarse(hand_length=0.190 * 1.1, hand_breadth=0.085 * 1.1).surface.volume
    assert larger / coarse().surface.volume == pytest.approx(1.1**3, rel=5e-3)


def test_percentiles_are_in_order_and_men_s_hands_larger() -> None:
    volumes = {
        (sex, percentile): coarse(sex=sex, percentile=percentile).surface.volume
        for sex in ("female", "male")
        for percentile in (5, 50, 95)
    }
    for sex in ("female", "male"):
        assert volumes[sex, 5] < volumes[sex, 50] < volumes[sex, 95]
    for percentile in (5, 50, 95):
        assert volumes["female", percentile] < volumes["male", percentile]
    # ANSUR II: the median man's hand is 193 mm long and 88 mm broad.
    median = coarse(hand_length=0.193, hand_breadth=0.088)
    assert np.array_equal(coarse(sex="male", percentile=50).surface.vertices, median.surface.vertices)


@pytest.mark.parametrize("name", ["default", "left", "slender", "broad", "small woman"])
def test_every_joint_lies_inside_the_skin(name: str) -> None:
    hand = built(**SHAPES[name])
    skin = qr.Obstacle.mesh(hand.surface.vertices, hand.surface.faces)
    distance, _, _ = skin.signed_distance(hand.rest[:, :3, 3])
    assert distance.max() < -2e-3


def test_frames_are_turns_along_the_bones() -> None:
    for side in ("right", "left"):
        hand = coarse(side=side)
        axes = hand.rest[:, :3, :3]
        assert np.allclose(axes.transpose(0, 2, 1) @ axes, np.eye(3), atol=1e-12)
        assert np.allclose(np.linalg.det(axes), 1.0)
        assert np.array_equal(hand.rest[:, 3], np.tile([0.0, 0.0, 0.0, 1.0], (25, 1)))
        for joint, parent in enumerate(hand.parents):
            if parent > 0:
                bone = hand.rest[joint, :3, 3] - hand.rest[parent, :3, 3]
                assert axes[parent, :, 1] @ bone == pytest.approx(np.linalg.norm(bone), rel=1e-12)
        # A negative turn about +x takes the bone away from the back.
        middle = hand.joint_names.index("middle-finger-phalanx-proximal")
        assert axes[middle, 2, 2] > 0.9


def test_joints_are_named_as_in_webxr_and_hang_on_their_neighbours() -> None:
    hand = coarse()
    assert len(hand.joint_names) == 25
    assert hand.parents[0] == -1
    assert (hand.parents[1:] < np.arange(1, 25)).all()
    for name, parent in zip(hand.joint_names[1:], hand.parents[1:], strict=True):
        owner = "wrist" if name.endswith("metacarpal") else name.rsplit("-", 1)[0].split("-phalanx")[0]
        assert hand.joint_names[parent].startswith(owner)


_CARRIES = 0.02  # least share of a digit that moves the skin of another to be seen


@pytest.mark.parametrize("name", ["default", "slender", "broad"])
def test_weights_are_shares_of_one_digit_and_the_palm(name: str) -> None:
    hand = built(**SHAPES[name])
    assert hand.joints.shape == hand.weights.shape == (len(hand.surface.vertices), 6)
    assert hand.weights.min() >= 0.0
    assert np.allclose(hand.weights.sum(axis=1), 1.0, atol=1e-12)
    carrying = np.zeros((len(hand.surface.vertices), 25))
    np.add.at(carrying, (np.arange(len(hand.surface.vertices))[:, None], hand.joints), hand.weights)
    digits = ("thumb", "index", "middle", "ring", "pinky")
    own = np.stack(
        [
            carrying[:, [d in n and "phalanx" in n for n in hand.joint_names]].sum(axis=1) > _CARRIES
            for d in digits
        ],
        axis=1,
    )
    # Phalanges of one digit alone carry any vertex, but for the webs, where two first phalanges meet.
    assert own.sum(axis=1).max() == 2
    web = own.sum(axis=1) == 2
    assert web.mean() < 0.05
    further = [name.endswith(("intermediate", "distal")) for name in hand.joint_names]
    assert carrying[web][:, further].max() < 0.1
    assert (own.sum(axis=0) > 300).all()
    assert carrying[:, ["tip" in name for name in hand.joint_names]].max() == 0.0
    # All other joints carry some skin.
    assert (carrying.max(axis=0)[["tip" not in name for name in hand.joint_names]] > 0.5).all()


def test_weights_change_little_along_an_edge() -> None:
    hand = built()
    carrying = np.zeros((len(hand.surface.vertices), 25))
    np.add.at(carrying, (np.arange(len(hand.surface.vertices))[:, None], hand.joints), hand.weights)
    others = np.roll(hand.surface.faces, 1, axis=1)
    steps = np.abs(carrying[hand.surface.faces] - carrying[others]).max(axis=2)
    lengths = np.linalg.norm(
        hand.surface.vertices[hand.surface.faces] - hand.surface.vertices[others], axis=2
    )
    # Smooth steps rise by at most 1.5 over their width: from a half to one in 8 mm at the webs, where the
    # difference of two distances grows twice as fast as the way, and 19 mm at the knuckle: 0.19 + 0.08 a mm.
    assert (steps / lengths).max() < 270.0
    assert np.percentile(steps, 99.0) < 0.35


def test_a_bent_finger_carries_its_own_tip_and_leaves_its_neighbours() -> None:
    hand = built()
    joint = hand.joint_names.index("index-finger-phalanx-proximal")
    rigid = np.where(hand.joints == hand.joint_names.index("index-finger-phalanx-distal"), hand.weights, 0.0)
    tip = place(hand, "index-finger-tip")
    near = np.linalg.norm(hand.surface.vertices - tip, axis=1) < 0.009
    assert rigid.sum(axis=1)[near].min() == 1.0
    moved = np.isin(hand.joints, [joint, joint + 1, joint + 2]) & (hand.weights > 0.0)
    for further in (
        "middle-finger-phalanx-intermediate",
        "middle-finger-phalanx-distal",
        "ring-finger-phalanx",
    ):
        assert not (moved.any(axis=1) & skin_of(hand, further)).any()


def test_the_cut_is_flat_and_found_as_such() -> None:
    hand = built()
    cut = ~qr.skin_without_caps(hand.surface)
    level = hand.surface.vertices[:, 1].min()
    assert np.array_equal(cut, hand.surface.vertices[:, 1] == level)
    # 18 mm behind the wrist of a hand of 191.8 mm.
    assert level == pytest.approx(-0.018 * 0.190 / 0.1918, rel=1e-3)


def test_the_nail_s_side_is_flatter_than_the_pad() -> None:
    hand = built(edge_length=1.3e-3)
    for digit in ("thumb", "index", "middle", "ring", "pinky"):
        joint = next(
            n
            for n, name in enumerate(hand.joint_names)
            if name == f"{digit}-finger-phalanx-distal" or name == f"{digit}-phalanx-distal"
        )
        local = (hand.surface.vertices - hand.rest[joint, :3, 3]) @ hand.rest[joint, :3, :3]
        length = np.linalg.norm(hand.rest[joint + 1, :3, 3] - hand.rest[joint, :3, 3])
        near = (np.abs(local[:, 1] - 0.6 * length) < 3e-3) & (
            np.linalg.norm(local[:, [0, 2]], axis=1) < 0.016
        )
        x, z = local[near, 0], local[near, 2]
        half = 0.5 * np.ptp(x)
        beside = np.abs(np.abs(x) - 0.6 * half) < 0.15 * half
        # Fall of the outline from its middle to 0.6 of its half breadth.
        back = z.max() - np.median(z[beside & (z > np.median(z))])
        pad = np.median(z[beside & (z < np.median(z))]) - z.min()
        assert back < pad


def test_the_left_hand_is_the_mirror_of_the_right() -> None:
    right, left = coarse(), coarse(side="left")
    mirror = np.array([-1.0, 1.0, 1.0])
    assert left.side == "left"
    assert np.array_equal(left.surface.vertices, right.surface.vertices * mirror)
    assert np.array_equal(np.sort(left.surface.faces), np.sort(right.surface.faces))
    assert np.array_equal(left.rest[:, :3, 3], right.rest[:, :3, 3] * mirror)
    assert left.surface.volume == pytest.approx(right.surface.volume, rel=1e-12)
    assert np.array_equal(left.joints, right.joints)
    assert np.array_equal(left.weights, right.weights)
    # The same flexion, mirrored: the axis is a pseudovector.
    turned = np.stack([-right.rest[:, :3, 0], right.rest[:, :3, 1], right.rest[:, :3, 2]], axis=2)
    assert np.allclose(left.rest[:, :3, :3], turned * mirror[:, None], atol=1e-14)


def test_the_same_hand_comes_twice_and_cannot_be_changed() -> None:
    one, other = qr.models.hand(edge_length=4e-3), qr.models.hand(edge_length=4e-3)
    assert np.array_equal(one.surface.vertices, other.surface.vertices)
    assert np.array_equal(one.surface.faces, other.surface.faces)
    with pytest.raises(ValueError, match="read-only"):
        one.surface.vertices[0] = 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"side": "both"}, "side is 'both'"),
        ({"hand_length": -0.19}, r"hand_length is -0\.19"),
        ({"hand_length": 190.0}, r"hand_length is 190\.0, expected a number from 0\.09 to 0\.26"),
        ({"hand_breadth": float("nan")}, "hand_breadth is nan"),
        ({"hand_breadth": 0.05}, r"hand_breadth is 0\.05 m, expected 0\.063 to 0\.112 m"),
        ({"edge_length": 0.5e-3}, r"edge_length is 0\.0005, expected a number from 0\.001 to 0\.005"),
        ({"hand_length": 0.12, "hand_breadth": 0.05, "edge_length": 4e-3}, r"expected at most 0\.0030 m"),
        ({"edge_length": "fine"}, "edge_length is 'fine'"),
        ({"percentile": 50}, "sex is None"),
        ({"sex": "male"}, "percentile is None"),
        ({"sex": "man", "percentile": 50}, "sex is 'man'"),
        ({"sex": "male", "percentile": 75}, "percentile is 75, expected 5, 50 or 95"),
        ({"sex": "male", "percentile": [5]}, r"percentile is \[5\]"),
        ({"sex": "male", "percentile": 50, "hand_length": 0.2}, "give one pair"),
    ],
)
def test_a_hand_that_cannot_be_is_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(SurfaceError, match=message):
        qr.models.hand(**arguments)


@pytest.mark.parametrize("pose", ["flat", "relaxed", "cylinder", "sphere"])
def test_a_pose_keeps_the_volume_and_open_ones_do_not_cross(pose: str) -> None:
    hand = built(edge_length=2.5e-3)
    posed = hand.posed(pose).surface
    # Digits keep theirs; the palm gains where knuckles turn at a depth that serves the digits.
    assert posed.volume == pytest.approx(hand.surface.volume, rel=0.04)
    qr.Obstacle.mesh(posed.vertices, posed.faces, check_crossings=True)


def test_every_region_of_a_hand_is_there() -> None:
    regions = set(built().labels.tolist())
    for digit in ("thumb", "index", "middle", "ring", "little"):
        for side in ("palmar", "dorsal", "radial", "ulnar"):
            assert f"{digit}-distal-{side}" in regions
    assert {"thenar", "hypothenar", "palm-center", "back", "wrist", "web-thumb-index"} <= regions


@pytest.mark.parametrize("name", ["default", "slender", "broad", "child", "small woman"])
def test_bones_of_the_published_section_fit_inside(name: str) -> None:
    shares = [bone.share for bone in built(**SHAPES[name]).bones]
    # The carpals and 19 metacarpals and phalanges.
    assert shares == [1.0] * 20
