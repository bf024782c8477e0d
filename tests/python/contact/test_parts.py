"""What parts of the skin carry of a contact, and means of its pressure."""

from __future__ import annotations

import itertools
import math
import pickle
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from numpy.typing import NDArray
from shapes import AS_GIVEN, SKIN, ball, grid
from shared_meshes import hand_file

PLATE = qr.Obstacle.half_space([0.0, 0.0, -0.05], [0.0, 0.0, 1.0])
UP = [0.0, 0.0, 1.0]
OPTIONS = {"refined": qr.ContactOptions(), "as given": AS_GIVEN}


def sources(contact: qr.Contact) -> NDArray[np.int64]:
    """The given vertex whose label each vertex takes, by the rule itself."""
    vertices, found = contact.surface.vertices, list(range(contact.given_vertex_count))
    for place, ends in zip(vertices[len(found) :], contact.parents, strict=True):
        near = [math.dist(place, vertices[end]) for end in ends]
        is_even = abs(near[0] - near[1]) < 1e-9 * math.dist(*vertices[ends])
        found.append(found[min(ends) if is_even else ends[int(near[1] < near[0])]])
    return np.array(found)


def check_sums(contact: qr.Contact, parts: list[qr.Part]) -> None:
    """Parts that cover the mesh sum to the whole, up to the rounding of as many additions."""
    rounding = 4 * len(contact.active) * np.finfo(float).eps
    arms = np.linalg.norm(contact.deformed.vertices, axis=1)
    largest = {"force": contact.node_force.sum(), "moment": contact.node_force @ arms}
    for name in ("force", "moment", "contact_area"):
        total = sum(getattr(part, name) for part in parts)
        whole = getattr(contact, name)
        np.testing.assert_allclose(total, whole, rtol=0, atol=rounding * largest.get(name, whole))
    assert max(part.max_pressure for part in parts) == contact.max_pressure
    assert sum(len(patch.vertices) for part in parts for patch in part.patches) == len(contact.active)


@pytest.fixture(scope="module", params=OPTIONS)
def contact(request: pytest.FixtureRequest, fingertip: qr.Surface) -> qr.Contact:
    return qr.press(fingertip, PLATE, SKIN, UP, depth=1.12e-3, options=OPTIONS[request.param])


def quarters(vertices: NDArray[np.float64]) -> NDArray[np.int64]:
    """Four parts that cut the pad across and along."""
    middle = vertices[vertices[:, 2] < vertices[:, 2].min() + 1e-3].mean(axis=0)
    return 2 * (vertices[:, 0] > middle[0]) + (vertices[:, 1] > middle[1])


def test_parts_of_the_labels_sum_to_the_whole_in_sorted_order(
    contact: qr.Contact, fingertip: qr.Surface
) -> None:
    labels = quarters(fingertip.vertices) * 10 - 20
    labels[fingertip.vertices[:, 2] > 0] = 7
    parts = contact.by_label(labels)
    assert list(parts) == [-20, -10, 0, 7, 10]
    assert all(type(label) is int for label in parts)
    check_sums(contact, list(parts.values()))
    away = parts[7]
    assert not away.force.any()
    assert away.contact_area == away.max_pressure == away.mean_pressure == 0
    assert np.isnan(away.center_of_pressure).all()
    assert away.patches == ()
    assert all(parts[label].force[2] > 0 for label in (-20, -10, 0, 10))


def test_an_added_vertex_takes_the_entry_of_the_nearer_end(
    contact: qr.Contact, fingertip: qr.Surface
) -> None:
    labels = quarters(fingertip.vertices)
    whole = labels[sources(contact)]
    solved = contact.by_label(whole)
    for label, part in contact.by_label(labels).items():
        own = whole == label
        np.testing.assert_allclose(part.force, contact.force_vectors[own].sum(axis=0), rtol=1e-12)
        moved = contact.deformed.vertices[own]
        moment = np.cross(moved, contact.force_vectors[own]).sum(axis=0)
        np.testing.assert_allclose(part.moment, moment, rtol=1e-9, atol=1e-12 * contact.node_force.sum())
        weights = contact.node_force[own]
        np.testing.assert_allclose(part.center_of_pressure, weights @ moved / weights.sum(), rtol=1e-9)
        for patch in part.patches:
            assert own[patch.vertices].all()
        for name in ("force", "moment", "center_of_pressure", "contact_area", "mean_pressure"):
            np.testing.assert_array_equal(getattr(part, name), getattr(solved[label], name))


def test_the_whole_is_a_part_too(contact: qr.Contact) -> None:
    whole = contact.part(np.ones(contact.given_vertex_count, dtype=bool))
    for name in ("force", "moment", "center_of_pressure", "contact_area", "max_pressure"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(contact, name))
    assert whole.mean_pressure == contact.mean_pressure()
    for part, patch in zip(whole.patches, contact.patches, strict=True):
        np.testing.assert_array_equal(part.vertices, patch.vertices)
        np.testing.assert_array_equal(part.force, patch.force)
    assert "patch" in repr(whole)


def test_words_and_lists_are_labels_as_well(contact: qr.Contact, fingertip: qr.Surface) -> None:
    words = np.where(fingertip.vertices[:, 0] > 0, "ulnar", "radial")
    by_word = contact.by_label(words)
    assert list(by_word) == ["radial", "ulnar"]
    alike = [words.tolist(), words.astype(object)]
    if hasattr(np.dtypes, "StringDType"):  # from NumPy 2.0
        alike.append(words.astype(np.dtypes.StringDType()))
    for same in alike:
        for label, part in contact.by_label(same).items():
            np.testing.assert_array_equal(part.force, by_word[label].force)
    check_sums(contact, list(by_word.values()))
    mask = contact.part(words == "ulnar")
    np.testing.assert_array_equal(mask.force, by_word["ulnar"].force)


def test_a_patch_that_straddles_two_parts_counts_in_both(fingertip: qr.Surface) -> None:
    two = [ball(8e-3, 3), ball(8e-3, 3)]
    count = len(two[0][0])
    vertices = np.concatenate([two[0][0], two[1][0] + [0.05, 0, 0]])
    surface = qr.Surface(vertices, np.concatenate([two[0][1], two[1][1] + count]))
    contact = qr.press(surface, PLATE, SKIN, UP, depth=0.5e-3)
    assert len(contact.patches) == 2
    parts = contact.by_label(np.digitize(vertices[:, 0], [0.0, 0.03]))
    assert [len(part.patches) for part in parts.values()] == [1, 1, 1]
    check_sums(contact, list(parts.values()))
    half = parts[0].patches[0].force + parts[1].patches[0].force
    np.testing.assert_allclose(half, contact.patches[0].force, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("options", OPTIONS)
def test_parts_of_a_real_hand_sum_to_the_whole(options: str) -> None:
    hand = qr.read_surface(hand_file("libhand_right_13k"), unit="m")
    contact = qr.press(hand, PLATE, SKIN, UP, depth=2e-3, options=OPTIONS[options])
    along = np.digitize(hand.vertices[:, 1], np.quantile(hand.vertices[:, 1], np.linspace(0, 1, 21)))
    labels = 5 * along + np.digitize(hand.vertices[:, 0], np.quantile(hand.vertices[:, 0], [0.3, 0.5, 0.7]))
    check_sums(contact, list(contact.by_label(labels).values()))


WRONG: list[tuple[Any, type[Exception], str]] = [
    (np.zeros(5, dtype=int), qr.ContactError, "`labels` has 5 entries, expected one per vertex: "),
    (np.full(162, np.nan), qr.ContactError, r"`labels\[0\]` is .*nan.*, expected integers or words, "),
    (["a"] * 161 + [math.nan], qr.ContactError, r"`labels\[161\]` is nan, expected integers or words, "),
    ([None] * 162, qr.ContactError, r"`labels\[0\]` is None, expected integers or words, "),
    (np.zeros(162), TypeError, "`labels` holds float64, expected integers or words, "),
    (np.zeros(162, dtype=bool), TypeError, "`labels` holds bool, expected integers or words, "),
    (
        [2**63 - 1] * 161 + [-(2**70)],
        qr.ContactError,
        r"`labels\[161\]` is -11805.*, expected integers of 64",
    ),
    (["a"] * 161 + [1], TypeError, "`labels` holds int, str, expected integers or words, "),
]


@pytest.mark.parametrize(("labels", "error", "message"), WRONG)
def test_labels_that_do_not_fit_are_refused_with_both_lengths(
    labels: Any, error: type[Exception], message: str
) -> None:
    contact = qr.press(qr.Surface(*ball(8e-3, 2)), PLATE, SKIN, UP, depth=0.5e-3)
    both = f"162 of the given mesh or {len(contact.gap)} of the contact's surface"
    with pytest.raises(error, match=f"{message}.*{both}"):
        contact.by_label(labels)


def test_masks_that_do_not_fit_are_refused_with_both_lengths() -> None:
    contact = qr.press(qr.Surface(*ball(8e-3, 2)), PLATE, SKIN, UP, depth=0.5e-3)
    both = f"162 of the given mesh or {len(contact.gap)} of the contact's surface"
    with pytest.raises(qr.ContactError, match=f"`mask` has 5 entries, expected .*{both}"):
        contact.part(np.zeros(5, dtype=bool))
    with pytest.raises(TypeError, match=f"`mask` has dtype int64, expected booleans, .*{both}"):
        contact.part(np.zeros(162, dtype=np.int64))
    with pytest.raises(qr.ContactError, match=r"`mask` has shape \(162, 1\), expected \(162,\)"):
        contact.part(np.zeros((162, 1), dtype=bool))


def test_labels_and_masks_in_the_place_of_each_other_are_told_apart(apart: qr.Contact) -> None:
    labels: Any = {"tip": np.ones(len(apart.gap), dtype=bool)}
    with pytest.raises(
        TypeError, match=r"`labels` is a dict, expected an array .*: part\(mask\) takes a mask"
    ):
        apart.by_label(labels)
    with pytest.raises(TypeError, match=r"`mask` is 'palm-center', .*: by_label\(labels\)\['palm-center'\]"):
        apart.part("palm-center")


def test_a_contact_without_force_or_answer_has_parts_too(apart: qr.Contact, unsolved: qr.Contact) -> None:
    for contact, figure in ((apart, 0.0), (unsolved, np.nan)):
        part = contact.part(np.ones(contact.given_vertex_count, dtype=bool))
        np.testing.assert_array_equal(part.force, [figure] * 3)
        np.testing.assert_array_equal(part.moment, [figure] * 3)
        assert np.isnan(part.center_of_pressure).all()
        for value in (part.contact_area, part.max_pressure, part.mean_pressure, contact.mean_pressure()):
            np.testing.assert_equal(value, figure)


def test_parts_and_means_survive_a_pickle(contact: qr.Contact, fingertip: qr.Surface) -> None:
    copied = pickle.loads(pickle.dumps(contact))
    labels = quarters(fingertip.vertices)
    there = copied.by_label(labels)
    for label, part in contact.by_label(labels).items():
        for name in ("force", "moment", "contact_area", "max_pressure", "mean_pressure"):
            np.testing.assert_array_equal(getattr(there[label], name), getattr(part, name))
        assert len(there[label].patches) == len(part.patches)
    assert copied.mean_pressure(1e-5) == contact.mean_pressure(1e-5)


def shared_area(distance: np.ndarray, one: float, other: np.ndarray) -> np.ndarray:
    """Area that two circles share, by their radii."""
    with np.errstate(divide="ignore", invalid="ignore"):
        chords = [(distance**2 + r**2 - s**2) / (2 * distance) for r, s in ((one, other), (other, one))]
        halves = [np.arccos((chord / r).clip(-1, 1)) for chord, r in zip(chords, (one, other), strict=True)]
        lens = sum(r**2 * (a - np.sin(2 * a) / 2) for r, a in zip((one, other), halves, strict=True))
    inner = np.minimum(one, other)
    within = np.where(distance <= np.maximum(one, other) - inner, math.pi * inner**2, lens)
    return np.where(distance >= one + other, 0.0, within)


@pytest.mark.parametrize("area", [1e-7, 1e-6, 1e-5, 1e-4, 1.0])
def test_a_mean_is_the_largest_of_all_discs(contact: qr.Contact, area: float) -> None:
    force, place = contact.node_force[contact.active], contact.surface.vertices[contact.active]
    distance = np.linalg.norm(place[:, None] - place[None], axis=2)
    alone = [contact.part(np.arange(len(contact.gap)) == vertex) for vertex in contact.active]
    # Each force on a disc as large as its cell, no denser than the peak; cells that overlap count once.
    cell = np.maximum([one.contact_area for one in alone], force / contact.max_pressure)
    share = shared_area(distance, math.sqrt(area / math.pi), np.sqrt(cell / math.pi)) / cell
    expected = (share @ force / np.maximum(share @ cell, area)).max()
    assert contact.mean_pressure(area) == pytest.approx(expected, rel=1e-10)
    assert contact.mean_pressure(area) <= contact.max_pressure * (1 + 1e-12)


def test_a_mean_falls_with_the_area_wherever_the_vertices_lie() -> None:
    product = qr.models.rounded_box(size=(0.075, 0.150, 0.009))
    tip = qr.models.fingertip(edge_length=1e-3)
    contact = qr.press(tip, product, SKIN, [0, 0, 1], depth=1.12e-3)
    means = [contact.mean_pressure(1e-6 * area) / contact.max_pressure for area in (0.25, 0.5, 1, 2, 4)]
    assert min(means) > 0.94
    assert max(means) <= 1.0
    assert all(later < before + 0.02 for before, later in itertools.pairwise(means))
    assert "not resolved" not in contact.summary()


def test_the_mean_under_a_sphere_is_that_of_hertz() -> None:
    radius, approach, cells = 0.2, 0.5e-3, 12
    modulus = qr.reference.contact_modulus(shear_modulus=60e3, poisson_ratio=0.5)
    hertz = qr.reference.Hertz(radius=radius, contact_modulus=modulus)
    size = hertz.contact_radius(approach)
    surface = qr.Surface(*grid(3 * cells, size / cells))
    sphere = qr.Obstacle.sphere([0, 0, radius - approach], radius)
    contact = qr.solve_contact(surface, sphere, SKIN, options=AS_GIVEN)
    # Within b of the middle a sphere carries F (1 - (1 - b^2 / a^2)^(3/2)) (Johnson 1985, eq. 3.39).
    for share in (0.05, 0.1, 0.2, 0.49, 0.8, 1.0, 1.4, 2.0):
        disc = share * math.pi * size**2
        expected = hertz.force(approach) * (1 - (1 - min(share, 1.0)) ** 1.5) / disc
        assert contact.mean_pressure(disc) == pytest.approx(expected, rel=0.02)
    # All of the contact lies in a large disc.
    large = math.pi * (2.5 * size) ** 2
    assert contact.mean_pressure(large) == pytest.approx(contact.node_force.sum() / large, rel=1e-12)


@pytest.mark.parametrize("area", [0.0, -1e-4, math.nan, math.inf, "1 cm^2"])
def test_an_area_that_is_none_is_refused(apart: qr.Contact, area: Any) -> None:
    with pytest.raises(qr.ContactError, match=r"area is .*, expected a number above 0"):
        apart.mean_pressure(area)
