"""Hands that close on products: what digits hold, what is missed, told and refused."""

import json

import numpy as np
import pytest
import quasirigid as qr
from handles import ENDS, FINGERS, RADIUS, forces, skin
from shapes import AS_GIVEN
from shared_meshes import hand_file

# Meshes as coarse as these leave penetration between their vertices, and say so.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")


def test_half_of_a_force_is_the_thumbs_and_an_eighth_each_fingers(held):
    assert held.missed == {}
    assert forces(held) == pytest.approx({"thumb": 8.0} | dict.fromkeys(FINGERS, 2.0), rel=1e-3)


def test_the_parts_sum_to_the_contact(held):
    total = sum(part.force for part in held.digits.values()) + held.palm.force
    np.testing.assert_allclose(total, held.contact.force, atol=1e-12)
    np.testing.assert_allclose(sum(part.force for part in held.regions.values()), total, atol=1e-12)
    np.testing.assert_array_equal(held.net_force, -held.contact.force)


def test_the_pose_gives_the_contact_again(hand, handle, held):
    posed = hand.posed(held.pose)
    again = qr.solve_contact(posed.surface, handle, skin(), options=AS_GIVEN)
    np.testing.assert_allclose(again.force, held.contact.force, rtol=1e-12)
    assert qr.solve_contact(held.posed.surface, handle, skin(), options=AS_GIVEN).status == "solved"


def test_the_moment_is_about_the_center_of_mass_and_the_weight_is_what_nothing_bears(handle, held):
    arms = held.contact.deformed.vertices - handle.center_of_mass
    moment = -np.cross(arms, held.contact.force_vectors).sum(axis=0)
    np.testing.assert_allclose(held.net_moment, moment, rtol=1e-9)
    np.testing.assert_allclose(held.unbalanced_force, held.net_force + np.array([0.0, 0.0, -1.962]))
    np.testing.assert_array_equal(held.unbalanced_moment, held.net_moment)


@pytest.mark.filterwarnings("always::quasirigid.SizeWarning")
def test_a_mass_that_no_hand_holds_is_asked_for_its_unit(hand, handle):
    with pytest.warns(qr.SizeWarning, match=r"product_mass is 400 kg.*0\.4"):
        qr.close_hand(hand, handle, skin(), overlap={"index": 1e-3}, product_mass=400, options=AS_GIVEN)


def test_refined_meshes_hold_within_a_hundredth(hand, handle):
    grasp = qr.close_hand(hand, handle, skin(), force=10.0)
    assert grasp.missed == {}
    assert forces(grasp) == pytest.approx({"thumb": 5.0} | dict.fromkeys(FINGERS, 1.25), rel=1e-2)
    assert grasp.unbalanced_force is None


def test_a_contact_without_an_end_is_why_a_digit_misses_and_is_drawn(hand):
    pytest.importorskip("matplotlib")
    # The paper's constants, at a depth at which they have no solution.
    paper = skin(qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3))
    bottle = qr.models.bottle(edge_length=3e-3).placed(hand.posed("opposed").palm)
    asked = {"thumb": 4.0, "index": 2.0}
    grasp = qr.close_hand(hand, bottle, paper, force=asked, start="opposed", options=AS_GIVEN, throw=False)
    assert grasp.contact.status == "ray"
    assert grasp.missed == dict.fromkeys(asked, "has no force that is known: the contact ended with 'ray'")
    assert grasp.plot().get_suptitle() == "No result: the contact ended with 'ray'"


def test_a_digit_that_is_not_named_stays_and_others_hold_what_is_asked_of_them(hand, handle):
    grasp = qr.close_hand(hand, handle, skin(), force={"index": 1.0, "ring": 3.0}, options=AS_GIVEN)
    found = forces(grasp)
    assert (found["index"], found["ring"]) == pytest.approx((1.0, 3.0), rel=1e-3)
    assert {grasp.shares[name] for name in ("middle", "little")} == {0.0}


def test_an_overlap_is_reached(hand, handle):
    grasp = qr.close_hand(hand, handle, skin(), overlap={"index": 1e-3, "middle": 2e-3}, options=AS_GIVEN)
    depth = -handle.signed_distance(grasp.posed.surface.vertices)[0]
    for name, wanted in (("index", 1e-3), ("middle", 2e-3)):
        on_digit = np.char.startswith(grasp.posed.labels, f"{name}-") & ~np.char.endswith(
            grasp.posed.labels, "metacarpal-head"
        )
        assert depth[on_digit].max() == pytest.approx(wanted, rel=1e-3)


def test_from_the_opposed_thumb_digits_push_a_bottle_against_each_other_and_not_away(hand):
    def pushed(start):
        bottle = qr.models.bottle().placed(hand.posed(start).palm)
        return qr.close_hand(hand, bottle, skin(), force=20.0, start=start, options=AS_GIVEN)

    opposed, relaxed = pushed("opposed"), pushed("relaxed")
    assert opposed.missed == {}
    total = sum(forces(opposed).values())
    assert np.linalg.norm(opposed.net_force) < 0.3 * total
    assert np.linalg.norm(relaxed.net_force) > 0.8 * total
    told = "push it away more than against each other"
    assert told in relaxed.summary()
    assert told not in opposed.summary()


def test_digits_that_no_thumb_meets_are_not_told_to_push_against_each_other(hand):
    palm = np.array(hand.posed("relaxed").palm)
    before = qr.Obstacle.sphere((palm @ [0.0, 0.03, 0.04, 1.0])[:3], 0.033)
    alone = qr.close_hand(hand, before, skin(), force={"index": 2.0}, options=AS_GIVEN)
    on_palm = qr.Obstacle.sphere((palm @ [0.0, 0.0, 4e-3, 1.0])[:3], 5e-3)
    none = qr.close_hand(hand, on_palm, skin(), force={"index": 1.0}, end="flat", options=AS_GIVEN)
    for grasp, digits in ((alone, ["index"]), (none, [])):
        assert [name for name, force in forces(grasp).items() if force] == digits
        assert np.linalg.norm(grasp.net_force) > 0.5 * np.linalg.norm(grasp.contact.force)
        assert "against each other" not in grasp.summary()


def tube(radius, wall, half_height):
    """A tube around the z axis, open at both ends (m)."""
    sides, corners = 96, 4
    profile = np.array([[radius, -1.0], [radius, 1.0], [radius - wall, 1.0], [radius - wall, -1.0]])
    turn = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)[:, None]
    out = profile[:, 0]
    x, y, z = out * np.cos(turn), out * np.sin(turn), np.tile(half_height * profile[:, 1], (sides, 1))
    side, corner = (each.ravel() for each in np.mgrid[:sides, :corners])
    a, b = (corners * side + (corner + step) % corners for step in (0, 1))
    c, d = (corners * ((side + 1) % sides) + (corner + step) % corners for step in (0, 1))
    faces = np.concatenate([np.column_stack([a, c, d]), np.column_stack([a, d, b])])
    return qr.Obstacle.mesh(np.stack([x, y, z], axis=-1).reshape(-1, 3), faces)


def test_a_wall_thinner_than_the_overlap_is_no_way_through(hand):
    palm = hand.posed("relaxed").palm
    products = tube(RADIUS, 0.6e-3, 0.06), qr.Obstacle.cylinder(0.06, RADIUS)
    wanted = {"index": 1.5e-3, "middle": 1.5e-3}
    walled, filled = (
        qr.close_hand(hand, product.placed(palm), skin(), overlap=wanted, options=AS_GIVEN)
        for product in products
    )
    assert walled.missed == filled.missed == {}
    assert walled.shares == pytest.approx(filled.shares, abs=5e-3)


@pytest.mark.parametrize("name", ["webxr_right_13k", "libhand_right_13k", "makehuman_male_right_13k"])
def test_a_scanned_hand_holds_a_can_between_its_thumb_and_all_fingers(name):
    hand = qr.read_hand(hand_file(name))
    # Along z, longer than the largest of the hands is broad: a rim under a finger makes its force jump. The
    # ring finger of libhand, bent at rest, curls past cans of less than 75 mm.
    can = qr.Obstacle.cylinder(0.07, 0.04)
    grasp = qr.close_hand(hand, can.placed(hand.posed("relaxed").palm), skin(), force=10.0, options=AS_GIVEN)
    assert not grasp.missed
    assert forces(grasp) == pytest.approx({"thumb": 5.0} | dict.fromkeys(FINGERS, 1.25), rel=1e-2)


@pytest.mark.parametrize("motion", ["product and pose", "hand"])
def test_a_rigid_motion_of_both_changes_nothing(hand, handle, held, motion):
    turn = np.linalg.qr(np.array([[0.3, -0.8, 0.1], [0.7, 0.2, -0.5], [-0.1, 0.6, 0.9]]))[0]
    turn *= np.sign(np.linalg.det(turn))
    shift = [0.3, -0.2, 0.5]
    moved, placed = handle.moved(turn, shift), {"rotation": turn, "translation": shift}
    if motion == "hand":
        other = qr.close_hand(hand.moved(turn, shift), moved, skin(), force=16.0, options=AS_GIVEN)
    else:
        other = qr.close_hand(hand, moved, skin(), force=16.0, options=AS_GIVEN, **placed)
    assert dict(other.shares) == pytest.approx(dict(held.shares), abs=1e-4)
    assert other.contact.contact_area == pytest.approx(held.contact.contact_area, rel=1e-3)
    np.testing.assert_allclose(other.contact.force, turn @ held.contact.force, atol=1e-2)


@pytest.mark.parametrize("factor", [-1.0, 0.9])
def test_a_mirrored_and_a_scaled_grasp_are_the_same(hand, handle, held, factor):
    ends = ENDS @ handle.rotation.T + handle.translation
    if factor < 0.0:
        other, force = hand.mirrored(), 16.0
        product = qr.Obstacle.capsule(*(ends * [-1.0, 1.0, 1.0]), RADIUS)
    else:
        other, force = hand.scaled(factor), 16.0 * factor**2
        product = qr.Obstacle.capsule(*(ends * factor), RADIUS * factor)
    grasp = qr.close_hand(other, product, skin(), force=force, options=AS_GIVEN)
    assert dict(grasp.shares) == pytest.approx(dict(held.shares), abs=1e-4)
    assert grasp.contact.max_pressure == pytest.approx(held.contact.max_pressure, rel=1e-3)
    wanted = {name: value * factor**2 for name, value in forces(held).items()}
    assert forces(grasp) == pytest.approx(wanted, rel=1e-3)


def test_digits_that_meet_nothing_or_cannot_press_as_hard_are_named(hand, handle):
    far = handle.moved(translation=[0.0, 0.0, -0.3])
    with pytest.warns(qr.QuasirigidWarning, match="no digit holds the product, thumb"):
        grasp = qr.close_hand(hand, far, skin(), force=5.0, options=AS_GIVEN)
    assert set(grasp.missed.values()) == {"does not meet the product on its way"}
    assert list(grasp.missed) == ["thumb", *FINGERS]
    assert grasp.contact.status == "no_contact"
    # Distances alone tell so much.
    assert grasp.rounds == 1
    # No finger presses so hard anywhere on its way.
    grasp = qr.close_hand(hand, handle, skin(), force={"index": 5000.0}, options=AS_GIVEN)
    assert f"comes to {forces(grasp)['index']:.3g} of 5e+03 N at the most" in grasp.missed["index"]


def test_a_digit_that_the_product_stands_in_opens_first(hand, handle):
    # The thumb's place at the start lies in the handle.
    start = hand.posed("relaxed").surface.vertices
    thumb = np.char.startswith(hand.labels, "thumb-")
    assert handle.signed_distance(start[thumb])[0].min() < -1e-3
    grasp = qr.close_hand(hand, handle, skin(), force={"thumb": 4.0}, options=AS_GIVEN)
    assert grasp.missed == {}
    assert grasp.shares["thumb"] < 0.0


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({}, "given: neither"),
        ({"force": 1.0, "overlap": 1e-3}, "given: both"),
        ({"force": {"pinky": 1.0}}, "the nearest is"),
        ({"force": {"index": -1.0}}, r"force\['index'\] is -1"),
        ({"force": {}}, "names no digit"),
        ({"force": float("nan")}, "force is nan"),
        ({"force": 1.0, "product_mass": -1.0}, "product_mass is -1"),
        ({"force": 1.0, "start": "fits"}, "the nearest is 'fist'"),
    ],
)
def test_a_question_that_makes_no_sense_is_refused(hand, handle, asked, words):
    with pytest.raises(qr.HandError, match=words):
        qr.close_hand(hand, handle, skin(), **asked)


def test_products_in_the_hand_and_skins_of_one_pose_are_refused(hand, handle):
    middle = 0.5 * (hand.frame_of("wrist")[:3, 3] + hand.frame_of("middle-finger-phalanx-proximal")[:3, 3])
    with pytest.raises(qr.HandError, match="inside the hand"):
        qr.close_hand(hand, qr.Obstacle.sphere(middle, 3e-3), skin(), force=1.0)
    with pytest.raises(qr.HandError, match="stand in the product"):
        qr.close_hand(hand, qr.Obstacle.sphere(middle, 0.5), skin(), force=1.0)
    itself = hand.posed("relaxed").surface
    with pytest.raises(qr.HandError, match="joints of all digits stand in the product"):
        qr.close_hand(hand, qr.Obstacle.mesh(itself.vertices, itself.faces), skin(), force=1.0)
    plane = qr.Obstacle.half_space([0.0, 0.0, -1.0], [0.0, 0.0, 1.0])
    with pytest.raises(qr.HandError, match="center of mass"):
        qr.close_hand(hand, plane, skin(), force=1.0)
    with pytest.raises(qr.HandError, match="belongs to one pose"):
        qr.close_hand(hand, handle, skin(qr.Body(fixed=~hand.surface.skin_mask)), force=1.0)
    with pytest.raises(TypeError, match="expected a Skin"):
        qr.close_hand(hand, handle, qr.HalfSpace(), force=1.0)


def test_a_grasp_is_told_drawn_and_written(held, tmp_path):
    lines = held.summary().splitlines()
    assert lines[0].split()[:4] == ["digit", "closed", "(%)", "force"]
    rows = [line.split() for line in lines[1:8]]
    assert [row[0] for row in rows] == ["thumb", *FINGERS, "palm", "all"]
    # Thumb and fingers face each other: their forces are more than their resultant.
    *single, whole = (float(row[-4]) for row in rows)
    assert whole == pytest.approx(sum(single), rel=1e-3)
    assert whole > 1.1 * np.linalg.norm(held.contact.force)
    assert "out of balance with its weight" in held.summary()
    files = held.save(tmp_path / "out", inputs={"product": "handle"})
    assert {"grasp.json", "hand.glb", "contact.npz", "deformed.ply"} <= {file.name for file in files}
    record = json.loads((tmp_path / "out" / "grasp.json").read_text())
    assert record["digits"]["index"]["force"]["unit"] == "N"
    assert record["inputs"] == {"product": "handle"}
    assert "thumb 8" in repr(held)


def test_a_grasp_is_a_table_of_pandas(held):
    pytest.importorskip("pandas")
    frame = held.to_dataframe()
    assert list(frame.index) == ["thumb", *FINGERS, "palm"]
    for name, part in [*held.digits.items(), ("palm", held.palm)]:
        row = frame.loc[name]
        assert [row[f"force_{axis} (N)"] for axis in "xyz"] == list(part.force)
        assert row["contact_area (m^2)"] == part.contact_area
        assert row["missed"] == ""
    assert list(frame["closed"][:5]) == list(held.shares.values())


def test_progress_is_told(hand, handle):
    told = []
    qr.close_hand(
        hand, handle, skin(), force={"index": 1.0}, options=AS_GIVEN, progress=lambda *at: told.append(at)
    )
    assert told[0] == ("approach", 0.0)
    assert all(0.0 <= done <= 1.0 for _, done in told)
    assert {what for what, _ in told} == {"approach", "closing"}


def test_files_of_an_earlier_grasp_go_with_it(held, tmp_path):
    (tmp_path / "grasp.png").write_text("of somebody")
    own = {"grasp.json", "hand.glb"}
    first = {file.name for file in held.save(tmp_path)}
    assert own < first
    assert {file.name for file in tmp_path.iterdir()} == first | {"grasp.png"}
    held.save(tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == first
    held.contact.save(tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == first - own
