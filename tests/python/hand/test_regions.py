"""Regions of the skin: in one piece, between their joints; labels of one's own."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr
from hands import RIGS, parts_of
from quasirigid._geometry import sides_of
from quasirigid.hand import DIGITS
from shared_meshes import hand_file

DENSE = ("webxr_right_53k", "libhand_right_53k", "makehuman_male_right_53k")


@pytest.fixture(scope="module", params=RIGS + DENSE)
def sparse_or_dense(request: pytest.FixtureRequest) -> qr.Hand:
    return qr.read_hand(hand_file(request.param))


@pytest.fixture(scope="module")
def drawn() -> qr.PosedHand:
    return qr.models.hand(edge_length=4e-3).posed("flat")


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


@pytest.mark.parametrize(
    ("views", "error", "message"),
    [
        (["side"], qr.HandError, "views holds 'side', expected some of palm, back, aslant"),
        ([["palm"]], qr.HandError, r"views holds \['palm'\], expected some of"),
        ((), qr.HandError, "views is empty, expected some of palm, back, aslant"),
        ("palm", TypeError, "views is 'palm', expected a sequence of some of palm, back, aslant"),
        (None, TypeError, "views is None, expected a sequence of some of"),
    ],
)
def test_views_that_there_are_not_are_named(
    views: object, error: type[Exception], message: str, drawn: qr.PosedHand
) -> None:
    with pytest.raises(error, match=message):
        qr.plot.hand_figure(drawn, views=views)


def test_a_picture_shows_each_region_in_a_color_of_its_own_and_the_joints(drawn: qr.PosedHand) -> None:
    colors = pytest.importorskip("matplotlib.colors")
    plain, regions = (
        qr.plot.hand_figure(drawn, views=["palm"], regions=regions).axes[0] for regions in (False, True)
    )
    assert not plain.lines
    assert len(regions.lines[0].get_xdata()) == len(drawn.joints)
    hues = [
        colors.rgb_to_hsv(np.clip(ax.images[0].get_array()[..., :3], 0.0, 1.0)).reshape(-1, 3)
        for ax in (plain, regions)
    ]
    # Skin is of one hue; of the regions that the palm shows there are a dozen and more.
    found = [len(np.unique((one[one[:, 1] > 0.3][:, 0] * 30).astype(int))) for one in hues]
    assert found[1] > 12 > 3 >= found[0]


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
