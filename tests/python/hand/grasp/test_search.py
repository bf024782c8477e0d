"""The search for how far each digit closes: trials, refined meshes, edges that a digit slips over."""

from types import SimpleNamespace

import numpy as np
import pytest
import quasirigid as qr
from handles import FINGERS, forces, skin
from quasirigid.contact.press import solve_quietly
from quasirigid.hand.grasp import hold
from quasirigid.hand.grasp.closing import Closing
from quasirigid.hand.grasp.hold import Hold, Solved
from quasirigid.hand.grasp.search import Search
from shapes import AS_GIVEN

# Meshes as coarse as these leave penetration between their vertices, and say so.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")


def test_a_digit_that_a_half_space_left_short_is_tried_again_with_the_body(hand):
    palm = np.array(hand.posed("relaxed").palm)
    ball = qr.Obstacle.sphere(palm[:3, 3] + 0.03 * palm[:3, 1] + 0.04 * palm[:3, 2], 0.033)
    told = []
    how = {"force": {"thumb": 2.5}, "options": AS_GIVEN, "progress": lambda what, _: told.append(what)}
    grasps = [qr.close_hand(hand, ball, skin(response), **how) for response in (qr.HalfSpace(), qr.Body())]
    assert "at the most on its way" in grasps[0].missed["thumb"]
    assert grasps[1].missed == {}
    assert forces(grasps[1])["thumb"] == pytest.approx(2.5, rel=1e-2)
    # Each contact that waits for a body says so, and so does the body.
    with_body = told[told.index("approach", 1) :]
    last = [at for at, what in enumerate(with_body) if what.endswith(", with all options")]
    assert with_body[last[0]] == f"contact {grasps[1].rounds - len(last) + 1}, with all options"
    assert with_body[last[0] + 1].startswith("body of ")
    assert not any(what.startswith(("contact", "body")) for what in told[: -len(with_body)])


@pytest.mark.parametrize(("force", "missed"), [(0.9, ""), (0.5, "end")])
def test_a_digit_that_slipped_by_is_tried_again_where_it_held_nearly_enough(force, missed):
    search = Search(wanted=1.0, power=2.0 / 3.0, share=0.5, missed="end")
    search.take(force, 1e-3, step=0.01, depth=0.0)
    search.begin_again()
    assert search.missed == missed
    # What it holds at the most is measured anew.
    search.take(0.8 * force, 1e-3, step=0.01, depth=0.0)
    assert search.most == 0.8 * force


@pytest.mark.parametrize(("then", "missed"), [((0.9, 0.85), "end"), ((0.9, 0.95), "")])
def test_a_digit_that_slips_by_again_is_told_what_it_comes_to_and_one_that_climbs_is_not(then, missed):
    search = Search(wanted=1.0, power=2.0 / 3.0, share=0.5, missed="end")
    search.take(0.9, 1e-3, step=0.01, depth=0.0)
    search.begin_again()
    for value in then:
        search.take(value, 1e-3, step=0.01, depth=0.0)
    search.end(1e-2)
    assert search.missed == missed


def test_a_digit_that_slips_by_in_the_last_rounds_alone_goes_back_to_where_it_held_the_most():
    def force(share):
        return max(0.9 * (1.0 - ((share - 0.5) / 0.05) ** 2), 0.0)

    search = Search(wanted=1.0, power=2.0 / 3.0, share=0.5)
    search.begin_again()
    for _ in range(hold._MOST_ROUNDS):
        search.take(force(search.share), 8e-3, step=0.01, depth=0.0)
    assert search.share == 0.5
    assert search.reason(1e-2, "N", 1.0) == "comes to 0.9 of 1 N at the most on its way"


def test_digits_that_a_large_contact_left_no_trials_are_named(hand, handle, monkeypatch):
    monkeypatch.setattr(hold, "_LARGE", 1)
    grasp = qr.close_hand(hand, handle, skin(), force=16.0, options=AS_GIVEN)
    assert grasp.rounds <= 2
    assert set(grasp.missed) == {"thumb", *FINGERS}
    assert all("when its trials ended" in reason for reason in grasp.missed.values())


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


def test_a_digit_whose_base_the_product_stands_in_does_not_open_in_vain(hand):
    closing = Closing(hand, "flat", "fist", None, None)
    start, index = closing.posed(np.zeros(5)).surface, closing.vertices[1]
    base = index[closing.speeds[1].argmin()]
    ball = qr.Obstacle.sphere(start.vertices[base] + 4e-3 * start.vertex_normals[base], 5e-3)
    deep = ball.signed_distance(start.vertices[index])[0]
    assert deep.min() == pytest.approx(-1e-3, rel=1e-6)
    # Its base stands where it is, whatever the digit does.
    assert closing.first_touch(ball, np.arange(5) == 1)[1] == 0.0


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


def test_places_are_those_of_the_posed_hand(hand):
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    closing = Closing(hand, "relaxed", "fist", turn, (0.1, -0.2, 0.3))
    shares = np.array([-0.4, 0.0, 0.3, 0.7, 1.0])
    np.testing.assert_array_equal(closing.places(shares), closing.posed(shares).surface.vertices)


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
