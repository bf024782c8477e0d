"""Hands that close on products."""

import copy
import json
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.contact.press import solve_quietly
from quasirigid.hand.grasp import hold
from quasirigid.hand.grasp.closing import Closing
from quasirigid.hand.grasp.hold import Hold, Solved
from quasirigid.hand.grasp.search import Search
from shared_meshes import hand_file

# Meshes as coarse as these leave penetration between their vertices, and say so.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")

AS_GIVEN = qr.ContactOptions(target_error=None)
FINGERS = ("index", "middle", "ring", "little")


def skin(response=None):
    return qr.Skin(shear_modulus=60e3, poisson_ratio=0.495, response=response or qr.HalfSpace())


@pytest.fixture(scope="module")
def hand():
    return qr.models.hand(edge_length=4e-3)


ENDS = np.array([[-0.05, 0.0, 0.0], [0.05, 0.0, 0.0]])
RADIUS = 0.018


@pytest.fixture(scope="module")
def handle(hand):
    return qr.Obstacle.capsule(*ENDS, RADIUS).placed(hand.posed("relaxed").palm)


@pytest.fixture(scope="module")
def held(hand, handle):
    return qr.close_hand(hand, handle, skin(), force=16.0, product_mass=0.2, options=AS_GIVEN)


def forces(grasp):
    return {name: float(np.linalg.norm(part.force)) for name, part in grasp.digits.items()}


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


def test_refined_meshes_hold_within_a_hundredth(hand, handle):
    grasp = qr.close_hand(hand, handle, skin(), force=10.0)
    assert grasp.missed == {}
    assert forces(grasp) == pytest.approx({"thumb": 5.0} | dict.fromkeys(FINGERS, 1.25), rel=1e-2)
    assert grasp.unbalanced_force is None


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


def test_a_digit_that_a_half_space_left_short_is_tried_again_with_the_body(hand):
    palm = np.array(hand.posed("relaxed").palm)
    ball = qr.Obstacle.sphere(palm[:3, 3] + 0.03 * palm[:3, 1] + 0.04 * palm[:3, 2], 0.033)
    grasps = [
        qr.close_hand(hand, ball, skin(response), force={"thumb": 1.65}, options=AS_GIVEN)
        for response in (qr.HalfSpace(), qr.Body())
    ]
    assert "at the most on its way" in grasps[0].missed["thumb"]
    assert grasps[1].missed == {}
    assert forces(grasps[1])["thumb"] == pytest.approx(1.65, rel=1e-2)


@pytest.mark.parametrize(("force", "missed"), [(0.9, ""), (0.5, "end")])
def test_a_digit_that_slipped_by_is_tried_again_where_it_held_nearly_enough(force, missed):
    search = Search(wanted=1.0, power=2.0 / 3.0, share=0.5, missed="end")
    search.take(force, 1e-3, step=0.01, depth=0.0)
    search.begin_again()
    assert search.missed == missed
    # What it holds at the most is measured anew.
    search.take(0.8 * force, 1e-3, step=0.01, depth=0.0)
    assert search.most == 0.8 * force


def test_digits_that_a_large_contact_left_no_trials_are_named(hand, handle, monkeypatch):
    monkeypatch.setattr(hold, "_LARGE", 1)
    grasp = qr.close_hand(hand, handle, skin(), force=16.0, options=AS_GIVEN)
    assert grasp.rounds <= 2
    assert set(grasp.missed) == {"thumb", *FINGERS}
    assert all("when its trials ended" in reason for reason in grasp.missed.values())


def test_digits_that_meet_nothing_or_cannot_press_as_hard_are_named(hand, handle):
    far = handle.moved(translation=[0.0, 0.0, -0.3])
    grasp = qr.close_hand(hand, far, skin(), force=5.0, options=AS_GIVEN)
    assert set(grasp.missed.values()) == {"does not meet the product on its way"}
    assert list(grasp.missed) == ["thumb", *FINGERS]
    assert grasp.contact.status == "no_contact"
    # Distances alone tell so much.
    assert grasp.rounds == 1
    # No finger presses so hard anywhere on its way.
    grasp = qr.close_hand(hand, handle, skin(), force={"index": 5000.0}, options=AS_GIVEN)
    assert f"comes to {forces(grasp)['index']:.3g} of 5e+03 N at the most" in grasp.missed["index"]


def test_a_digit_that_slips_by_stays_where_it_holds_the_most_and_is_not_pressed_beyond(hand):
    # A ball just within reach of the tip of the index half way, which curls in from there.
    closing = Closing(hand, "relaxed", "fist", None, (0.0, 0.0, 0.0))
    half, end = (closing.posed(np.full(5, share)) for share in (0.5, 1.0))
    knuckle = half.joints[hand.joint_names.index("index-finger-phalanx-proximal"), :3, 3]
    tip = half.surface.vertices[closing.vertices[1]]
    tip = tip[np.argmax(np.linalg.norm(tip - knuckle, axis=1))]
    ball = qr.Obstacle.sphere(tip + 2e-3 * (tip - knuckle) / np.linalg.norm(tip - knuckle), 3e-3)
    assert ball.signed_distance(end.surface.vertices[closing.vertices[1]])[0].min() > closing.mesh_width
    grasp = qr.close_hand(hand, ball, skin(), force={"index": 50.0}, options=AS_GIVEN)
    held = forces(grasp)["index"]
    assert 0.0 < grasp.shares["index"] < 1.0
    assert f"comes to {held:.3g} of 50 N" in grasp.missed["index"]
    # By steps of 1.5 mm the rest of its way alone would take more.
    way = closing.speeds[1].max() * (1.0 - grasp.shares["index"])
    assert grasp.rounds < way / 1.5e-3


def test_a_force_that_is_measured_anew_is_met_in_a_few_trials_whatever_the_last_slope_was():
    # Hertz, from a share of 0.3; the last two trials are so close that their slope is that of another digit.
    def force(share, modulus):
        return modulus * max(share - 0.3, 0.0) ** 1.5

    search = Search(wanted=2.0, power=2.0 / 3.0, share=0.3)
    for _ in range(20):
        search.take(force(search.share, 300.0), 1e-3, step=0.01, depth=0.0)
    search.share += 2e-5
    search.take(force(search.share, 300.0) + 0.01, 1e-3, step=0.01, depth=0.0)
    search.begin_again()
    # A finer mesh is softer. The first trial, one from the slope that is known, one from that of these two.
    for _ in range(3):
        search.take(force(search.share, 220.0), 8e-3, step=0.01, depth=0.0)
    assert force(search.share, 220.0) == pytest.approx(2.0, rel=8e-3)


def test_a_base_that_touches_all_along_does_not_hide_how_fast_a_force_grows():
    def force(share, modulus):
        return 0.06 + modulus * max(share - 0.3, 0.0) ** 1.5

    search = Search(wanted=2.0, power=2.0 / 3.0, share=-1.0)
    for _ in range(40):
        search.take(force(search.share, 300.0), 3e-2, step=0.08, depth=0.0)
    assert search.error() <= 3e-2
    search.begin_again()
    for _ in range(3):
        search.take(force(search.share, 220.0), 8e-3, step=0.08, depth=0.0)
    assert force(search.share, 220.0) == pytest.approx(2.0, rel=8e-3)


def test_digits_on_a_ball_whose_bases_touch_all_along_hold_in_the_last_rounds(hand):
    ball = qr.Obstacle.sphere([-8.79e-3, 97.85e-3, -54.53e-3], 39.71e-3)
    wanted = {"thumb": 2.4777, "index": 2.9433, "middle": 1.2823, "ring": 0.9589}
    grasp = qr.close_hand(hand, ball, skin(), force=wanted, start="flat")
    assert grasp.missed == {}
    assert {name: forces(grasp)[name] for name in wanted} == pytest.approx(wanted, rel=1e-2)


@pytest.mark.parametrize(
    ("reasons", "coarse", "nodes"),
    [
        (("max_nodes", "a sharp edge"), 100, 250),
        (("target_error",) * 2, 100, 900),
        # A mesh so coarse that it does not touch.
        (("max_nodes", "no contact"), 0, 1),
    ],
)
def test_rounds_keep_to_the_coarser_mesh_where_none_is_as_fine_as_asked(
    hand, handle, monkeypatch, reasons, coarse, nodes
):
    # On an edge forces fall with each refinement: rounds on two finenesses would never agree.
    def solved(count, reason):
        meshes = [SimpleNamespace(kind="mesh", nodes=10 * 3**at, reason="") for at in range(count - 1)]
        last = SimpleNamespace(kind="mesh", nodes=coarse if count == 3 else 300, reason=reason)
        return Solved(posed=None, contact=SimpleNamespace(refinements=[*meshes, last]))

    hold = Hold(
        closing=None,
        obstacle=handle,
        skin=skin(),
        options=qr.ContactOptions(target_error=0.05, max_nodes=900),
        wanted={1: 1.0},
        by_force=True,
        report=None,
    )
    meshes = [solved(3, reasons[1]), solved(4, reasons[0])]

    def solve(elastic, options):
        hold.solved = meshes.pop()
        return np.zeros(5)

    monkeypatch.setattr(hold, "_solve", solve)
    hold._with_all_options()
    assert hold.options.max_nodes == 900
    # The second mesh is the coarser one: it is solved once.
    hold._with_all_options()
    # Fewer than the finer mesh's 300.
    assert hold.options.max_nodes == nodes


def force_on_edge(depth):
    """Return what a thumb holds that is pushed over a thin edge: 6 N at 3 mm, and hardly anything deeper."""
    return 6.0 * (depth / 3e-3) ** 1.5 if depth <= 3e-3 else 1.0


def test_a_digit_that_goes_deeper_and_holds_less_has_gone_through_and_goes_back():
    search = Search(wanted=15.0, power=2.0 / 3.0, share=0.0)
    depths = []
    while not search.missed:
        depths.append(0.1 * search.share)
        search.take(force_on_edge(depths[-1]), 1e-3, step=0.01, depth=depths[-1])
    assert search.missed == "end"
    # Where it held the most, by steps of 1 mm, without the rest of its way.
    assert search.most > force_on_edge(1.9e-3)
    assert force_on_edge(0.1 * search.share) == search.most
    assert max(depths) < 7e-3


def test_a_digit_that_another_one_throws_over_an_edge_goes_back_and_holds():
    search = Search(wanted=5.8, power=2.0 / 3.0, share=0.0)
    for trial in range(40):
        depth = 0.1 * search.share
        disturbed = 0.9 if trial == 10 else 1.0
        search.take(disturbed * force_on_edge(depth), 1e-3, step=0.01, depth=depth)
        if trial == 9:
            assert search.error() <= 1e-3
        if trial == 11:
            assert search.value == 1.0
    assert search.missed == ""
    assert force_on_edge(0.1 * search.share) == pytest.approx(5.8, rel=1e-3)


def test_no_vertex_goes_on_by_more_than_the_product_is_away(hand, handle):
    closing = Closing(hand, "relaxed", "fist", None, (0.0, 0.0, 0.0))
    digits = np.array([False, True, True, False, True])
    for start in (0.0, 0.2, 0.4, 0.6):
        shares = np.full(5, start)
        distances, steps = closing.look(shares, handle, digits, least=1e-3)
        before, after = (closing.posed(at).surface.vertices for at in (shares, shares + steps))
        for at in np.flatnonzero(digits):
            vertices = closing.vertices[at]
            away = handle.signed_distance(before[vertices])[0]
            way = np.linalg.norm(after[vertices] - before[vertices], axis=1)
            assert (way <= np.maximum(np.abs(away), 1e-3)).all()
            assert distances[at] == pytest.approx(min(away.min(), closing.reach), abs=1e-12)
            assert steps[at] > 0.0


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
    plane = qr.Obstacle.half_space([0.0, 0.0, -1.0], [0.0, 0.0, 1.0])
    with pytest.raises(qr.HandError, match="center of mass"):
        qr.close_hand(hand, plane, skin(), force=1.0)
    with pytest.raises(qr.HandError, match="belongs to one pose"):
        qr.close_hand(hand, handle, skin(qr.Body(fixed=~hand.surface.skin_mask)), force=1.0)
    with pytest.raises(TypeError, match="expected a Skin"):
        qr.close_hand(hand, handle, qr.HalfSpace(), force=1.0)


def check_touches(palm, product):
    way = -np.array(palm)[:3, 2]
    for start in ("infinity", "current"):
        contact = qr.press(palm.surface, product, skin(), way, depth=0.0, start=start, options=AS_GIVEN)
        assert contact.travel == pytest.approx(0.0, abs=1e-12)


def test_a_product_is_laid_across_the_palm_in_touch(hand):
    palm = hand.posed("flat").palm
    rod = qr.Obstacle.cylinder(half_height=0.06, radius=0.01).placed(palm)
    inwards = np.array(palm[:3, :3]).T @ rod.rotation[:, 2]
    np.testing.assert_allclose(np.abs(inwards), [1.0, 0.0, 0.0], atol=1e-12)
    check_touches(palm, rod)
    # Turned as it lies, it comes down onto the palm all the same, with its center of mass over the origin.
    for turn in (
        np.diag([1.0, -1.0, -1.0]),
        [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
        [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
    ):
        turned = rod.placed(palm, rotation=turn)
        axes = np.array(palm[:3, :3])
        np.testing.assert_allclose(turned.rotation, axes @ turn @ axes.T @ rod.rotation, atol=1e-9)
        over = axes.T @ (turned.center_of_mass - palm[:3, 3])
        np.testing.assert_allclose(over[:2], 0.0, atol=1e-12)
        assert over[2] > 0.0
        check_touches(palm, turned)
    # Its edge meets the skin between vertices.
    check_touches(palm, qr.Obstacle.box([0.04, 0.02, 0.004]).placed(palm))
    # A frame without a skin: on its plane.
    flat = qr.Obstacle.box([0.01, 0.03, 0.02]).placed(np.eye(4))
    np.testing.assert_allclose(flat.bounding_box, [[-0.03, -0.02, 0.0], [0.03, 0.02, 0.02]], atol=1e-12)
    with pytest.raises(qr.ObstacleError, match="half-space"):
        qr.Obstacle.half_space([0, 0, 0], [0, 0, 1]).placed(palm)
    with pytest.raises(qr.ContactError, match="never meets the skin"):
        rod.placed(np.eye(4), qr.Surface(hand.surface.vertices + 9.0, hand.surface.faces))


@pytest.mark.parametrize(
    "copied",
    [lambda palm: palm.copy(), copy.copy, copy.deepcopy, lambda palm: pickle.loads(pickle.dumps(palm))],
)
def test_a_copy_of_a_palm_lays_a_product_as_the_palm_does(hand, copied):
    palm = hand.posed("relaxed").palm
    frame = copied(palm)
    rod = qr.Obstacle.capsule(*ENDS, RADIUS)
    np.testing.assert_array_equal(rod.placed(frame).translation, rod.placed(palm).translation)
    # It is a frame of its own, and keeps its skin where it is changed.
    frame[:3, 3] += 1e-3
    frame += 0.0
    assert frame.surface is not None
    np.testing.assert_allclose(frame[:3, 3] - palm[:3, 3], 1e-3, atol=1e-15)


@pytest.mark.parametrize(
    "part",
    [lambda palm: palm[:3, 2], lambda palm: np.eye(4) @ palm, np.linalg.inv, lambda palm: next(iter(palm))],
)
def test_parts_of_a_palm_and_what_is_computed_of_it_are_plain_arrays(hand, part):
    assert type(part(hand.posed("relaxed").palm)) is np.ndarray


@pytest.mark.parametrize(
    "solid",
    [
        qr.Obstacle.sphere([0.1, 0.2, 0.3], 0.02),
        qr.Obstacle.capsule([0.0, 0.0, 0.0], [0.2, 0.4, 0.6], 0.1),
        qr.Obstacle.box([0.1, 0.1, 0.1]).moved(translation=[0.1, 0.2, 0.3]),
    ],
)
def test_a_center_of_mass_is_the_middle_of_what_is_symmetric(solid):
    np.testing.assert_allclose(solid.center_of_mass, [0.1, 0.2, 0.3], atol=1e-15)


def test_the_center_of_mass_of_a_cone_is_a_quarter_up():
    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(60)])
    vertices = np.vstack([rim, [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]]]) + np.array([3.0, 0.0, 0.0])
    turn = np.arange(60)
    after = np.roll(turn, -1)
    base = np.column_stack([after, turn, np.full(60, 60)])
    side = np.column_stack([turn, after, np.full(60, 61)])
    cone = qr.Obstacle.mesh(vertices, np.vstack([base, side]))
    np.testing.assert_allclose(cone.center_of_mass, [3.0, 0.0, 0.5], atol=1e-12)


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


def test_the_search_is_a_start_that_takes_gaps_anew_once(hand, handle, monkeypatch):
    asked = []

    def told(surface, obstacle, elastic, options):
        asked.append((options.target_error, options.max_linearizations))
        return solve_quietly(surface, obstacle, elastic, options)

    monkeypatch.setattr(hold, "solve_quietly", told)
    wanted = qr.ContactOptions(target_error=0.1, max_nodes=600)
    assert qr.close_hand(hand, handle, skin(), force={"index": 2.0}, options=wanted).missed == {}
    assert set(asked) == {(None, 2), (0.1, wanted.max_linearizations)}
    # Without rounds after it the search has to say it all.
    asked.clear()
    qr.close_hand(hand, handle, skin(), force={"index": 2.0}, options=AS_GIVEN)
    assert set(asked) == {(None, AS_GIVEN.max_linearizations)}
