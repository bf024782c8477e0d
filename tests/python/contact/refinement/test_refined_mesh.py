"""The refined skin: numbers, angles, closedness and mask come from the given one."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from refined import UP, Floats, jittered_ball
from shapes import PLATE, SKIN, grid, slab
from shared_meshes import hand_file

# Scenes are coarse on purpose, and taken as they are; some are metres wide.
pytestmark = [
    pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning"),
    pytest.mark.filterwarnings("ignore::quasirigid.SizeWarning"),
]


def fingertip_on_plate() -> tuple[qr.Surface, qr.Contact]:
    tip = qr.models.fingertip(edge_length=3e-3)
    tip = tip.with_skin_mask(qr.skin_without_caps(tip))
    return tip, qr.press(tip, PLATE, SKIN, UP, depth=0.3e-3)


def hand_on_plate() -> tuple[qr.Surface, qr.Contact]:
    hand = qr.read_surface(hand_file("libhand_right_13k"), unit="m")
    return hand, qr.press(hand, PLATE, SKIN, UP, depth=1.5e-3)


@pytest.fixture(scope="module", params=[fingertip_on_plate, hand_on_plate], ids=["fingertip", "hand"])
def pressed(request: pytest.FixtureRequest) -> tuple[qr.Surface, qr.Contact]:
    """A skin and its contact on a refined mesh."""
    skin, contact = request.param()
    assert len(contact.parents) > 0
    return skin, contact


Pressed = tuple[qr.Surface, qr.Contact]


def test_given_vertices_keep_their_numbers_and_added_ones_follow(pressed: Pressed) -> None:
    given, contact = pressed
    count = contact.given_vertex_count
    assert count == len(given.vertices)
    assert len(contact.surface.vertices) == count + len(contact.parents)
    np.testing.assert_array_equal(contact.surface.vertices[:count], given.vertices)
    for values in (contact.pressure, contact.gap, contact.node_force, contact.displacement):
        assert len(values) == len(contact.surface.vertices)
    # Parents come before their child, which lies near the middle between them.
    assert (contact.parents < count + np.arange(len(contact.parents))[:, None]).all()
    ends = contact.surface.vertices[contact.parents]
    off = np.linalg.norm(contact.surface.vertices[count:] - ends.mean(axis=1), axis=1)
    assert (off < 0.25 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)).all()


def test_a_refined_skin_is_as_closed_as_the_given_one_and_a_good_surface(pressed: Pressed) -> None:
    given, contact = pressed
    again = qr.Surface(contact.surface.vertices, contact.surface.faces)
    assert again.is_closed == contact.surface.is_closed == given.is_closed
    assert contact.deformed.is_closed == given.is_closed
    # Curved middles move the skin by a small part of its edges.
    assert contact.surface.area == pytest.approx(given.area, rel=0.01)


def smallest_angles(surface: qr.Surface) -> Floats:
    """The smallest angle of each face (rad)."""
    corners = surface.vertices[surface.faces]
    angles = []
    for corner in range(3):
        one, other = (corners[:, (corner + step) % 3] - corners[:, corner] for step in (1, 2))
        across = np.linalg.norm(np.cross(one, other), axis=1)
        angles.append(np.arctan2(across, np.einsum("ij,ij->i", one, other)))
    smallest: Floats = np.min(angles, axis=0)
    return smallest


def test_no_new_face_has_less_than_half_the_smallest_angle_of_the_given_one(pressed: Pressed) -> None:
    given, contact = pressed
    roots = [{vertex} for vertex in range(contact.given_vertex_count)]
    for one, other in contact.parents:
        roots.append(roots[one] | roots[other])
    # The corners of a part of a face come from all of its corners and no other.
    numbers = {frozenset(face): number for number, face in enumerate(given.faces.tolist())}
    face_of = [
        numbers[frozenset(roots[a] | roots[b] | roots[c])] for a, b, c in contact.surface.faces.tolist()
    ]
    shares = smallest_angles(contact.surface) / smallest_angles(given)[face_of]
    assert shares.min() >= 0.5 - 1e-9


def test_an_added_vertex_may_touch_where_both_its_parents_may(pressed: Pressed) -> None:
    given, contact = pressed
    mask, count = contact.surface.skin_mask, contact.given_vertex_count
    np.testing.assert_array_equal(mask[:count], given.skin_mask)
    np.testing.assert_array_equal(mask[count:], mask[contact.parents].all(axis=1))
    assert mask[contact.candidates].all()


def test_a_refined_contact_leaves_out_what_was_seen_of_the_whole_skin() -> None:
    tip, refined = fingertip_on_plate()
    whys = {one.what: one.why for one in refined.left_out}
    assert f"keeps {np.sum(~tip.skin_mask)} vertices out" in whys["masked vertices"]
    assert f"of {len(tip.vertices)} vertices" in whys["exact distance of far vertices"]


@pytest.mark.filterwarnings("ignore:the contact reaches:quasirigid.QuasirigidWarning")
def test_nothing_presses_beside_a_mask_that_cuts_through_the_contact() -> None:
    surface = jittered_ball(1)
    masked = surface.with_skin_mask(surface.vertices[:, 0] > 0)
    contact = qr.press(masked, PLATE, SKIN, UP, depth=1e-3)
    assert len(contact.parents) > 0
    assert contact.surface.vertices[contact.active, 0].min() > 0


def test_a_refined_contact_pickles_and_saves(tmp_path: Path) -> None:
    contact = qr.press(jittered_ball(1), PLATE, SKIN, UP, depth=0.5e-3)
    again = pickle.loads(pickle.dumps(contact))
    for name in ("parents", "pressure", "gap", "displacement"):
        np.testing.assert_array_equal(getattr(again, name), getattr(contact, name))
    np.testing.assert_array_equal(again.surface.vertices, contact.surface.vertices)
    assert again.accuracy == contact.accuracy
    assert [repr(one) for one in again.refinements] == [repr(one) for one in contact.refinements]
    contact.save(tmp_path)
    with np.load(tmp_path / "contact.npz") as archive:
        count = archive["given_vertex_count"]
        given = archive["vertices"][:count] - archive["displacement"][:count]
        np.testing.assert_allclose(given, jittered_ball(1).vertices, atol=1e-15)
        np.testing.assert_array_equal(archive["parents"], contact.parents)


def test_a_second_contact_leaves_no_file_of_the_first_beside_its_own(tmp_path: Path) -> None:
    notes = tmp_path / "skin.png"
    notes.write_text("mine")
    product = qr.Obstacle.mesh(*slab(grid(8, 10e-3), 5e-3)).moved(translation=-1.0 * UP)
    first = qr.press(jittered_ball(1), product, SKIN, UP, depth=0.5e-3)
    assert tmp_path / "product.ply" in first.save(tmp_path)
    assert notes.read_text() == "mine"  # no contact was there before
    second = qr.press(jittered_ball(1), PLATE, SKIN, UP, depth=0.5e-3)
    files = second.save(tmp_path)
    assert set(files) == set(tmp_path.iterdir())
