"""Scanned and drawn fingers and hands on real products."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import quasirigid as qr
from numpy.typing import NDArray
from shapes import AS_GIVEN, SKIN, TURN
from shared_meshes import DATA, MISSING

pytestmark = pytest.mark.skipif(not (DATA / "hands").is_dir(), reason=MISSING)

FINGERS = ("libhand_right_middle_1500", "webxr_right_middle_1500", "makehuman_female_right_middle_1500")
PRODUCTS = ("gen_phone_slab", "tbm_mug", "ycb_soup_can", "tbm_computer_mouse")
DEPTHS = (0.5e-3, 1.12e-3, 2e-3)
UP = np.array([0.0, 0.0, 1.0])

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]


def finger(name: str) -> qr.Surface:
    """The finger as stored, its cut face masked."""
    surface = qr.read_surface(DATA / "hands" / f"{name}.ply", unit="m")
    return surface.with_skin_mask(qr.skin_without_caps(surface))


def product_under(surface: qr.Surface, name: str) -> Mesh:
    """The product, its bounding box centered under the last 38 % of the finger."""
    vertices, faces = qr.read_mesh(DATA / "products" / f"{name}.ply", unit="m")
    along = surface.vertices[:, 1]
    tip = surface.vertices[along > along.max() - 0.38 * np.ptp(along)].mean(axis=0)
    center = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    return vertices + (tip - center) * [1, 1, 0], faces


# A can's rim is thinner than the depth and wants many cells, phone and mug reach the finger's cut, beside
# which a mug stands steep to the skin: the contact says so, and is solved all the same.
@pytest.mark.filterwarnings("ignore:.*steeper than 60 degrees:quasirigid.DepthWarning")
@pytest.mark.filterwarnings("ignore:the contact reaches:quasirigid.QuasirigidWarning")
@pytest.mark.filterwarnings("ignore:the target of .*mesh around:quasirigid.RefinementWarning")
@pytest.mark.filterwarnings("ignore:the deformed skin still penetrates:quasirigid.QuasirigidWarning")
@pytest.mark.filterwarnings("ignore:.* vertices went through a wall:quasirigid.QuasirigidWarning")
@pytest.mark.parametrize("product", PRODUCTS)
@pytest.mark.parametrize("name", FINGERS)
def test_a_real_finger_on_a_real_product_is_solved(name: str, product: str) -> None:
    surface = finger(name)
    obstacle = qr.Obstacle.mesh(*product_under(surface, product))
    for depth in DEPTHS:
        contact = qr.press(surface, obstacle, SKIN, UP, depth=depth)
        assert contact.status == "solved"
        assert contact.natural_residual <= 1e-10
        assert contact.gap[contact.candidates].min() >= -1e-9
        assert contact.surface.skin_mask[contact.candidates].all()


@pytest.mark.filterwarnings("ignore:the deformed skin still penetrates:quasirigid.QuasirigidWarning")
@pytest.mark.filterwarnings("ignore:the target of .*mesh around:quasirigid.RefinementWarning")
# The can meets the index finger at its cut.
@pytest.mark.filterwarnings("ignore:the contact reaches:quasirigid.QuasirigidWarning")
@pytest.mark.parametrize("name", [*FINGERS, "webxr_right_index_1500"])
def test_a_thin_rim_presses_back_against_the_press(name: str) -> None:
    surface = finger(name)
    can = qr.Obstacle.mesh(*product_under(surface, "ycb_soup_can"))
    with warnings.catch_warnings(record=True):
        warnings.simplefilter("always")
        shallow = qr.press(surface, can, SKIN, UP, depth=0.5e-3)
    before = shallow.force[2]
    for depth in (1.12e-3, 2e-3):
        with pytest.warns(qr.QuasirigidWarning, match="went through a wall"):
            contact = qr.press(surface, can, SKIN, UP, depth=depth)
        # The rim is 1.2 mm thick; a force along its sides would grow no more and point anywhere.
        assert contact.force[2] > 0.85 * np.linalg.norm(contact.force)
        assert contact.force[2] > 1.5 * before
        before = contact.force[2]


def test_a_real_press_does_not_depend_on_place_numbering_or_scale() -> None:
    surface = finger(FINGERS[0])
    vertices, faces = product_under(surface, "tbm_computer_mouse")
    obstacle = qr.Obstacle.mesh(vertices, faces)
    force = np.linalg.norm(qr.press(surface, obstacle, SKIN, UP, depth=1.12e-3).force)

    shift = [0.4, -0.2, 1.3]
    there = qr.press(surface.moved(TURN, shift), obstacle.moved(TURN, shift), SKIN, TURN @ UP, depth=1.12e-3)
    assert np.linalg.norm(there.force) == pytest.approx(force, rel=1e-6)

    order = np.random.default_rng(1).permutation(len(surface.vertices))
    place = np.argsort(order)
    renumbered = qr.Surface(surface.vertices[order], place[surface.faces], surface.skin_mask[order])
    again = qr.press(renumbered, obstacle, SKIN, UP, depth=1.12e-3)
    assert np.linalg.norm(again.force) == pytest.approx(force, rel=1e-9)

    small = qr.Surface(0.37 * surface.vertices, surface.faces, surface.skin_mask)
    tiny = qr.press(small, qr.Obstacle.mesh(0.37 * vertices, faces), SKIN, UP, depth=0.37 * 1.12e-3)
    assert np.linalg.norm(tiny.force) / 0.37**2 == pytest.approx(force, rel=1e-6)


@pytest.mark.filterwarnings("ignore:the contact reaches:quasirigid.QuasirigidWarning")
# On the mesh as it is.
@pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")
def test_a_scanned_finger_with_its_bone_keeps_its_volume_to_first_order() -> None:
    whole = finger(FINGERS[0])
    along = whole.vertices[:, 1]
    part = qr.cut_out(whole, keep=along > along.max() - 0.035)
    surface, bone = part.surface, qr.models.bone_of(part)
    response = qr.Body(bone=bone, fixed=part.fixed, coarse_edge_length=0)
    body = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    low = surface.vertices[:, 2].min() + 3e-3
    announced: list[str] = []
    prepared = body.prepared(
        surface,
        np.flatnonzero(surface.skin_mask & (surface.vertices[:, 2] < low)),
        progress=lambda what, _: announced.append(what),
    )
    # Announced before it is spent.
    assert float(announced[0].split(": ")[1].split(" GB")[0]) < 1.0
    plate = qr.Obstacle.half_space([0, 0, -0.05], UP)
    for depth in DEPTHS[:2]:
        contact = qr.press(surface, plate, prepared, UP, depth=depth, options=AS_GIVEN)
        assert contact.status == "solved"
        assert contact.max_penetration_after < 1e-6 * depth
        inward = -np.einsum("ij,ij->i", contact.displacement, surface.vertex_normals)
        displaced = np.maximum(inward, 0) @ surface.vertex_areas
        assert abs(contact.volume_change) < 5e-3 * displaced


# The rim of the mug stands between vertices of the hand.
@pytest.mark.filterwarnings("ignore:the deformed skin still penetrates:quasirigid.QuasirigidWarning")
@pytest.mark.filterwarnings("ignore:the target of .*mesh around:quasirigid.RefinementWarning")
def test_a_mug_from_below_meets_the_palm_of_a_whole_hand() -> None:
    hand = qr.read_surface(DATA / "hands" / "libhand_right_13k.ply", unit="m")
    vertices, faces = qr.read_mesh(DATA / "products" / "tbm_mug.ply", unit="m")
    middle = (hand.vertices.min(axis=0) + hand.vertices.max(axis=0)) / 2
    center = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    mug = qr.Obstacle.mesh(vertices + (middle - center) * [1, 1, 0], faces)
    contact = qr.press(hand, mug, SKIN, UP, depth=2e-3)
    assert contact.status == "solved"
    assert contact.force[2] > 0
    assert any("far" in what for what, _ in contact.left_out)


# Skin that goes back and forth between facets of the bottle comes to the same forces twice.
@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize("seed", [231, 441, 736, 1110])
def test_where_a_product_comes_from_changes_nothing(seed: int) -> None:
    surface = finger("webxr_right_middle_1500")
    vertices, faces = qr.read_mesh(DATA / "products" / "ycb_bleach_bottle.ply", unit="m")
    random = np.random.default_rng(seed)
    vertex = random.choice(np.flatnonzero(surface.skin_mask))
    way = -surface.vertex_normals[vertex] + 0.3 * random.normal(size=3)
    way /= np.linalg.norm(way)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    place = surface.vertices[vertex] - turn @ random.choice(vertices) - 0.5 * way
    depth = random.uniform(0.3e-3, 2e-3)
    near, *farther = (
        qr.press(
            surface, qr.Obstacle.mesh(vertices, faces).moved(turn, place - back * way), SKIN, way, depth=depth
        )
        for back in (0.0, 0.1, 0.2)
    )
    for far in farther:
        np.testing.assert_allclose(far.force, near.force, atol=1e-9 * np.linalg.norm(near.force))
        assert far.contact_area == pytest.approx(near.contact_area, rel=1e-9)
