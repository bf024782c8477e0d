"""Parts cut out of a hand, and bodies combined with a kernel."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, TURN
from shared_meshes import hand_file

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")

SHEAR_MODULUS = 60e3
UP = np.array([0.0, 0.0, 1.0])
HALF_SPACE = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=qr.HalfSpace())


@pytest.fixture(scope="module")
def finger() -> qr.Surface:
    surface = qr.models.finger(edge_length=2.2e-3)
    return surface.with_skin_mask(qr.skin_without_caps(surface))


@pytest.fixture(scope="module")
def part(finger: qr.Surface) -> qr.CutOut:
    tip = int(np.argmax(finger.vertices[:, 1]))
    return qr.cut_out(finger, tip=tip, point=[0, 0.040, 0], normal=[0, 2, 0])


def prepared_part(part: qr.CutOut) -> qr.PreparedSkin:
    response = part.body(bone=qr.models.bone_of(part.surface, cut=part.fixed))
    skin = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=response)
    pad = part.surface.skin_mask & (part.surface.vertices[:, 2] < 2e-3)
    return skin.prepared(part.surface, np.flatnonzero(pad))


@pytest.fixture(scope="module")
def combined(finger: qr.Surface, part: qr.CutOut) -> qr.CombinedSkin:
    return HALF_SPACE.combined(finger, {"tip": (part, prepared_part(part))})


def ball_below(y: float, surface: qr.Surface) -> qr.Obstacle:
    """A ball of 12 mm under the pad at a place along the finger."""
    near = np.abs(surface.vertices[:, 1] - y) < 3e-3
    return qr.Obstacle.sphere([0, y, surface.vertices[near, 2].min() - 0.02], 12e-3)


def test_a_part_is_closed_and_knows_where_it_comes_from(finger: qr.Surface, part: qr.CutOut) -> None:
    assert part.surface.is_closed
    assert len(part.fixed) == len(part.source_vertices) == len(part.surface.vertices)
    kept = part.source_vertices >= 0
    np.testing.assert_array_equal(finger.vertices[part.source_vertices[kept]], part.surface.vertices[kept])
    np.testing.assert_array_equal(part.part_vertices[part.source_vertices[kept]], np.flatnonzero(kept))
    assert part.fixed[~kept].all()
    assert not part.surface.skin_mask[part.fixed].any()
    assert part.surface.skin_mask[~part.fixed].all()
    assert part.surface.vertices[:, 1].min() > 0.040
    assert (part.part_vertices[finger.vertices[:, 1] <= 0.040] == -1).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"tip": 10**6}, "tip vertex 1000000: the skin has vertices 0 to"),
        ({"tip": -1}, "tip vertex -1: the skin has vertices 0 to"),
        ({"point": [0, np.nan, 0]}, r"point is \[0, nan, 0\], expected three finite numbers"),
        ({"normal": [0, 1]}, r"normal is \[0, 1\], expected three finite numbers"),
        ({"normal": [0, 0, 0]}, "normal has length 0"),
        ({"normal": [0, -1, 0]}, "no face around it is left"),
        ({"point": [0, -1, 0]}, "cuts nothing off"),
    ],
)
def test_a_cut_that_cannot_be_is_refused(
    arguments: dict[str, object], message: str, finger: qr.Surface
) -> None:
    tip = int(np.argmax(finger.vertices[:, 1]))
    asked = {"tip": tip, "point": [0, 0.04, 0], "normal": [0, 1, 0], **arguments}
    with pytest.raises(qr.SurfaceError, match=message):
        qr.cut_out(finger, **asked)


def test_a_tip_is_the_number_of_a_vertex(finger: qr.Surface) -> None:
    with pytest.raises(TypeError, match=r"tip is \[0, 0\.08, 0\], expected the number of a vertex"):
        qr.cut_out(finger, tip=[0, 0.08, 0], point=[0, 0.04, 0], normal=[0, 1, 0])  # type: ignore[arg-type]


# Small bumps on a mesh taken as it is.
@pytest.mark.filterwarnings("ignore:the deformed skin still penetrates:quasirigid.QuasirigidWarning")
def test_on_the_part_it_is_the_body_and_off_it_the_kernel(
    finger: qr.Surface, part: qr.CutOut, combined: qr.CombinedSkin
) -> None:
    alone, bump = combined.parts["tip"][1], ball_below(0.066, finger)
    refined = [
        qr.press(surface, bump, skin, UP, depth=0.8e-3)
        for surface, skin in ((finger, combined), (part.surface, alone))
    ]
    np.testing.assert_allclose(refined[0].force, refined[1].force, rtol=1e-9, atol=1e-12)
    assert len(refined[0].parents) == len(refined[1].parents) > 0

    on_tip, on_part = (
        qr.press(surface, bump, skin, UP, depth=0.8e-3, options=AS_GIVEN)
        for surface, skin in ((finger, combined), (part.surface, alone))
    )
    np.testing.assert_allclose(on_tip.force, on_part.force, rtol=1e-9, atol=1e-12)
    kept = part.part_vertices >= 0
    # Drawn to 1e-3.
    np.testing.assert_allclose(
        on_tip.displacement[kept], on_part.displacement[part.part_vertices[kept]], atol=1e-3 * 0.8e-3
    )
    assert not on_tip.displacement[~kept].any()
    # The part keeps its volume to first order, to what the coarse mesh leaves, and so does the whole.
    shifted = np.abs(np.einsum("ij,ij->i", on_tip.displacement, finger.vertex_normals)) @ finger.vertex_areas
    assert abs(on_tip.volume_change) < 2e-2 * shifted

    at_root = qr.press(finger, ball_below(0.015, finger), combined, UP, depth=0.8e-3)
    kernel = qr.press(finger, ball_below(0.015, finger), HALF_SPACE, UP, depth=0.8e-3)
    np.testing.assert_allclose(at_root.force, kernel.force, rtol=1e-6, atol=1e-9)
    assert np.isfinite(at_root.fade_distance)


@pytest.mark.filterwarnings("ignore:the deformed skin still penetrates:quasirigid.QuasirigidWarning")
def test_contacts_on_both_sides_of_a_cut_do_not_couple(finger: qr.Surface, combined: qr.CombinedSkin) -> None:
    # A bar with two bumps: both presses at once.
    bumps = [ball_below(y, finger) for y in (0.015, 0.066)]
    alone = [qr.press(finger, bump, combined, UP, depth=0.8e-3, options=AS_GIVEN) for bump in bumps]
    nodes = np.concatenate([contact.active for contact in alone])
    matrix = qr.response_matrix(finger, combined, nodes)
    first = len(alone[0].active)
    assert not matrix[:first, first:].any()
    assert not matrix[first:, :first].any()
    assert (np.diag(matrix) > 0).all()


def test_a_combined_skin_pickles(finger: qr.Surface, combined: qr.CombinedSkin) -> None:
    again = pickle.loads(pickle.dumps(combined))
    forces = [
        qr.press(finger, ball_below(0.066, finger), skin, UP, depth=0.4e-3).force
        for skin in (combined, again)
    ]
    np.testing.assert_array_equal(*forces)


def test_a_combined_skin_moves_with_its_surface(finger: qr.Surface, combined: qr.CombinedSkin) -> None:
    shift = np.array([0.1, -0.2, 0.3])
    moved, there = combined.moved(TURN, shift), finger.moved(TURN, shift)
    # What it is made of has moved along, so it can be pickled and taken apart.
    for skin in (moved, pickle.loads(pickle.dumps(moved))):
        for y in (0.015, 0.066):
            bump = ball_below(y, finger)
            still = qr.press(finger, bump, combined, UP, depth=0.4e-3)
            turned = qr.press(there, bump.moved(TURN, shift), skin, TURN @ UP, depth=0.4e-3)
            np.testing.assert_allclose(turned.force, TURN @ still.force, rtol=1e-6, atol=1e-9)
    with pytest.raises(qr.ResponseError, match="rotation"):
        combined.moved(2 * np.eye(3), shift)


def test_a_patch_across_a_cut_is_refused_by_name_and_the_part_can_be_left_out(
    finger: qr.Surface, combined: qr.CombinedSkin
) -> None:
    across = ball_below(0.041, finger)
    with pytest.raises(qr.ResponseError, match=r"straddles the cut of part \"tip\""):
        qr.press(finger, across, combined, UP, depth=0.8e-3)
    contact = qr.press(finger, across, combined.without("tip"), UP, depth=0.8e-3)
    kernel = qr.press(finger, across, HALF_SPACE, UP, depth=0.8e-3)
    np.testing.assert_allclose(contact.force, kernel.force, rtol=1e-9)
    with pytest.raises(qr.ResponseError, match="no part 'thumb', only tip"):
        combined.without("thumb")
    with pytest.raises(TypeError, match=r"names of parts one by one, not \['tip'\]"):
        combined.without(["tip"])  # type: ignore[arg-type]


def test_what_is_no_part_is_refused_by_name(
    finger: qr.Surface, part: qr.CutOut, combined: qr.CombinedSkin
) -> None:
    prepared = combined.parts["tip"][1]
    wrong: list[tuple[object, str]] = [
        ([(part, prepared)], "parts is a list, expected a dict"),
        ({7: (part, prepared)}, "the part 7 is named by a int"),
        ({"tip": prepared}, "part 'tip' is a PreparedSkin, expected"),
        ({"tip": (part,)}, r"part 'tip' is \(CutOut\), expected \(CutOut, PreparedSkin\)"),
        ({"tip": (prepared, part)}, r"part 'tip' is \(PreparedSkin, CutOut\), .*: swap the two"),
        ({"tip": (part, prepared.skin)}, r"part 'tip' is \(CutOut, Skin\), .*: prepare the skin"),
    ]
    for parts, message in wrong:
        with pytest.raises(TypeError, match=message):
            HALF_SPACE.combined(finger, parts)  # type: ignore[arg-type]


def test_what_needs_a_kernel_names_the_skin_that_is_none(
    finger: qr.Surface, combined: qr.CombinedSkin
) -> None:
    for skin, found, within in [
        (combined, "a CombinedSkin is no kernel", "its `background`"),
        (combined.parts["tip"][1], "a PreparedSkin is no kernel", "its `skin`"),
    ]:
        with pytest.raises(qr.ResponseError, match=f"{found}: .*{within}"):
            qr.net_volume(finger, skin, 0)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="skin is a HalfSpace, expected a Skin"):
        qr.net_volume(finger, qr.HalfSpace(), 0)  # type: ignore[arg-type]
    with pytest.raises(qr.ResponseError, match="node vertex -1: the skin has vertices 0 to"):
        qr.net_volume(finger, HALF_SPACE, -1)


def test_parts_that_do_not_fit_are_refused(
    finger: qr.Surface, part: qr.CutOut, combined: qr.CombinedSkin
) -> None:
    prepared = combined.parts["tip"][1]
    with pytest.raises(qr.ResponseError, match=r"part \"b\" .*belongs to part \"a\" too"):
        HALF_SPACE.combined(finger, {"a": (part, prepared), "b": (part, prepared)})
    with pytest.raises(qr.ResponseError, match="move the part with the skin"):
        HALF_SPACE.combined(finger.moved(np.eye(3), [1e-3, 0, 0]), {"tip": (part, prepared)})
    with pytest.raises(qr.ResponseError, match="not that of a body"):
        HALF_SPACE.combined(finger, {"tip": (part, HALF_SPACE.prepared(part.surface, [0]))})
    galerkin = qr.Skin(shear_modulus=6e4, poisson_ratio=0.5, response=qr.HalfSpace(discretization="galerkin"))
    with pytest.raises(qr.ResponseError, match="gaps at the vertices"):
        galerkin.combined(finger, {"tip": (part, prepared)})
    averaged = replace(prepared.skin, response=replace(part.body(), discretization="galerkin"))
    with pytest.raises(qr.ResponseError, match="gaps at the vertices"):
        HALF_SPACE.combined(finger, {"tip": (part, averaged.prepared(part.surface, prepared.nodes[:1]))})
    with pytest.raises(qr.ResponseError, match="needs a kernel"):
        prepared.skin.combined(finger, {"tip": (part, prepared)})


@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
def test_a_finger_cut_out_of_a_hand_presses_with_the_palm() -> None:
    hand = qr.read_surface(hand_file("webxr_right_13k"), unit="m")
    tip = int(np.argmax(hand.vertices[:, 1]))
    top = hand.vertices[tip]
    part = qr.cut_out(hand, tip=tip, point=top - [0, 0.042, 0], normal=[0, 1, 0])
    assert part.surface.is_closed
    bone = qr.models.bone_of(part.surface, cut=part.fixed)
    response = part.body(bone=bone)
    skin = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=response)
    free = part.surface.skin_mask
    low = part.surface.vertices[:, 2] < np.median(part.surface.vertices[:, 2])
    far = part.surface.vertices[:, 1] > top[1] - 0.022
    prepared = skin.prepared(part.surface, np.flatnonzero(free & low & far))
    combined = HALF_SPACE.combined(hand, {"middle": (part, prepared)})
    pad = hand.vertices[(part.part_vertices >= 0) & (hand.vertices[:, 1] > top[1] - 0.015)]
    ball = qr.Obstacle.sphere([*pad[:, :2].mean(axis=0), pad[:, 2].min() - 0.05], 0.03)
    contact = qr.press(hand, ball, combined, UP, depth=1e-3)
    kernel = qr.press(hand, ball, HALF_SPACE, UP, depth=1e-3)
    assert contact.status == "solved"
    given = contact.active[contact.active < contact.given_vertex_count]
    assert (part.part_vertices[given] >= 0).all()
    assert 0 < contact.force[2] < 3 * kernel.force[2]


def test_a_mask_cuts_out_as_a_plane_does_and_the_count_is_known(finger: qr.Surface, part: qr.CutOut) -> None:
    same = qr.cut_out(finger, keep=finger.vertices[:, 1] > 0.040)
    np.testing.assert_array_equal(same.part_vertices, part.part_vertices)
    np.testing.assert_array_equal(same.surface.vertices, part.surface.vertices)
    assert same.kept_count == np.count_nonzero(finger.vertices[:, 1] > 0.040)


def test_a_plane_that_leaves_most_of_the_skin_says_so(finger: qr.Surface) -> None:
    tip = int(np.argmax(finger.vertices[:, 1]))
    with pytest.warns(qr.CutWarning, match=r"leaves \d+ of \d+ vertices") as told:
        part = qr.cut_out(finger, tip=tip, point=[0, 0.01, 0], normal=[0, 1, 0])
    assert f"leaves {part.kept_count} of {len(finger.vertices)}" in str(told[0].message)
    # Who marks the vertices knows them.
    assert qr.cut_out(finger, keep=finger.vertices[:, 1] > 0.01).kept_count == part.kept_count


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "given: none of them"),
        ({"tip": 0}, "given: tip$"),
        ({"tip": 0, "point": [0, 0, 0]}, "given: tip, point$"),
        ({"keep": [True], "tip": 0}, "given: tip, keep$"),
    ],
)
def test_a_cut_takes_a_plane_or_a_mask(
    arguments: dict[str, object], message: str, finger: qr.Surface
) -> None:
    with pytest.raises(TypeError, match=message):
        qr.cut_out(finger, **arguments)  # type: ignore[call-overload]


def test_a_mask_of_no_part_is_refused(finger: qr.Surface) -> None:
    count = len(finger.vertices)
    with pytest.raises(qr.SurfaceError, match=f"`keep` marks 0 of {count} vertices"):
        qr.cut_out(finger, keep=np.zeros(count, dtype=bool))
    with pytest.raises(qr.SurfaceError, match=f"`keep` marks {count} of {count} vertices"):
        qr.cut_out(finger, keep=np.ones(count, dtype=bool))
    with pytest.raises(qr.SurfaceError, match=f"`keep` has 1 entries, but the skin has {count} vertices"):
        qr.cut_out(finger, keep=[True])
    with pytest.raises(TypeError, match="`keep` has dtype int64"):
        qr.cut_out(finger, keep=np.arange(5))


# Small bumps on a mesh taken as it is.
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
def test_a_combined_contact_presses_on_the_bones_of_its_parts(finger: qr.Surface, part: qr.CutOut) -> None:
    response = part.body(bone=qr.models.bone_of(part), bone_pressure=True)
    pad = part.surface.skin_mask & (part.surface.vertices[:, 2] < 2e-3)
    skin = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=response)
    prepared = skin.prepared(part.surface, np.flatnonzero(pad))
    combined = HALF_SPACE.combined(finger, {"tip": (part, prepared)})
    bump = ball_below(0.066, finger)
    whole = qr.press(finger, bump, combined, UP, depth=0.8e-3, options=AS_GIVEN)
    alone = qr.press(part.surface, bump, prepared, UP, depth=0.8e-3, options=AS_GIVEN)
    found = combined.bone_pressure(whole)
    assert list(found) == ["tip"]
    expected = prepared.bone_pressure(alone)
    np.testing.assert_allclose(found["tip"], expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())
    assert found["tip"].max() > 0.0
    # Refined meshes hand the forces of added vertices to the given ones.
    refined = combined.bone_pressure(qr.press(finger, bump, combined, UP, depth=0.8e-3))
    assert refined["tip"].max() > 0.0
    with pytest.raises(qr.ResponseError, match=r"the forces have shape \(3, 3\)"):
        combined.bone_pressure(np.zeros((3, 3)))
    forces = np.zeros((len(finger.vertices), 3))
    other = np.flatnonzero(part.surface.skin_mask & ~pad & ~part.fixed)[-1]
    there = part.source_vertices[other]
    forces[there] = UP
    with pytest.raises(qr.ResponseError, match=f"^vertex {there} carries force, but part 'tip' .*{other}$"):
        combined.bone_pressure(forces)
    forces[there] = np.nan
    with pytest.raises(qr.ResponseError, match=rf"^forces\[{there}\] is \[nan, nan, nan\], expected finite"):
        combined.bone_pressure(forces)
    with pytest.raises(qr.ResponseError, match="bone_pressure=True"):
        HALF_SPACE.combined(finger, {"tip": (part, prepared_part(part))}).bone_pressure(whole)
