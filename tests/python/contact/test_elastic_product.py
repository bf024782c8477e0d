"""Products with a material: shares, what is drawn, files, pickles, refusals."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, ball, grid

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")

G, NU = 60e3, 0.5
SKIN = qr.Skin(shear_modulus=G, poisson_ratio=NU, response=qr.HalfSpace())
UP = [0.0, 0.0, 1.0]
PLATE = qr.Obstacle.half_space([0, 0, 0], UP)
BALL = qr.Obstacle.mesh(*ball(0.02, 4))


def soft(obstacle: qr.Obstacle, response: qr.Response | None = None) -> qr.Obstacle:
    return obstacle.with_material(shear_modulus=G, poisson_ratio=NU, response=response)


def pressed(obstacle: qr.Obstacle, **how: Any) -> qr.Contact:
    surface = qr.Surface(*ball(8e-3, 3))
    return qr.press(surface, obstacle, SKIN, UP, **({"depth": 5e-4} | how))


def test_a_product_as_soft_as_the_skin_takes_half_the_force() -> None:
    skin = qr.Skin(shear_modulus=G, poisson_ratio=NU, response=qr.HalfSpace(discretization="galerkin"))
    surface = qr.Surface(*ball(8e-3, 3))
    rigid, elastic = (qr.press(surface, obstacle, skin, UP, depth=5e-4) for obstacle in (PLATE, soft(PLATE)))
    assert elastic.force[2] == pytest.approx(0.5 * rigid.force[2], rel=5e-3)
    assert elastic.obstacle_share == pytest.approx(0.5, rel=1e-9)
    assert rigid.obstacle_share == 0.0
    # Half of the way each: the plate's level lies between the skin and the product.
    active, moved = elastic.active, elastic.obstacle_displacement
    level = elastic.deformed.vertices[active, 2] - moved[active, 2]
    sag = 5e-4 / elastic.accuracy.cells_per_radius**2
    np.testing.assert_allclose(level, elastic.travel, rtol=0, atol=1e-3 * 5e-4 + sag)
    off = np.setdiff1d(np.arange(len(moved)), elastic.candidates)
    assert not moved[off].any()
    assert not moved.flags.writeable
    assert not rigid.obstacle_displacement.any()
    assert elastic.deformed_obstacle is None


def test_a_mesh_product_is_drawn_with_its_dent() -> None:
    below = BALL.moved(np.eye(3), [0, 0, -0.04])
    rigid, elastic = pressed(below), pressed(soft(below))
    vertices, faces = elastic.obstacle.triangles()  # type: ignore[misc]
    still, moved = rigid.deformed_obstacle, elastic.deformed_obstacle
    assert still is not None
    assert moved is not None
    np.testing.assert_array_equal(still.vertices, rigid.obstacle.triangles()[0])  # type: ignore[index]
    # Halved edges add vertices behind those of the product, under the contact alone.
    assert len(moved.faces) > len(faces)
    whole = (moved.faces[: len(faces)] == faces).all(axis=1)
    assert whole[(vertices[faces, 2] < vertices[:, 2].max() - 0.02).all(axis=1)].all()
    way = moved.vertices[: len(vertices)] - vertices
    deepest = np.abs(elastic.obstacle_displacement[:, 2]).max()
    # The product gives way down, by no more than where it is touched, and not at all on its far side.
    assert -1.02 * deepest < way[:, 2].min() < -0.5 * deepest
    assert not way[vertices[:, 2] < vertices[:, 2].max() - 0.02].any()
    assert moved is elastic.deformed_obstacle


@pytest.mark.parametrize(
    "response",
    [
        None,
        qr.Layer(thickness=4e-3),
        qr.GaussianCorrected(height=0.0, width=5e-3, cutoff=15e-3),
        qr.GivenMatrix(nodes=np.arange(2562), compliance=np.full((2562, 2562), 1e-4)),
    ],
    ids=["half-space", "layer", "Gaussian", "matrix"],
)
def test_a_material_stays_through_moves_and_pickles(response: qr.Response | None) -> None:
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    obstacle = soft(BALL, response).moved(turn, [0, 0, -0.04])
    for copied in (obstacle, pickle.loads(pickle.dumps(obstacle))):
        material = copied.material
        assert material[:2] == (G, NU)
        assert type(material.response) is type(response or qr.HalfSpace())
        assert repr(material) in repr(copied)
    assert "shear_modulus=60000.0" in repr(obstacle)
    here, there = pressed(obstacle), pressed(copied)
    np.testing.assert_array_equal(here.pressure, there.pressure)
    assert here.obstacle_share is not None
    assert 0.0 < here.obstacle_share < 1.0
    assert here.obstacle.material is not None
    assert BALL.material is None
    assert "modulus" not in repr(BALL)
    again = pickle.loads(pickle.dumps(here))
    np.testing.assert_array_equal(again.obstacle_displacement, here.obstacle_displacement)
    assert again.obstacle_share == here.obstacle_share
    assert again.deformed_obstacle is not None
    np.testing.assert_array_equal(again.deformed_obstacle.vertices, here.deformed_obstacle.vertices)  # type: ignore[union-attr]


def test_a_rigid_contact_comes_back_with_its_product() -> None:
    again = pickle.loads(pickle.dumps(pressed(BALL.moved(np.eye(3), [0, 0, -0.04]))))
    assert again.obstacle_share == 0.0
    assert not again.obstacle_displacement.any()
    assert again.deformed_obstacle is not None


def test_the_files_of_a_contact_say_what_the_product_is_made_of(tmp_path: Path) -> None:
    contact = pressed(soft(BALL.moved(np.eye(3), [0, 0, -0.04])))
    names = {path.name for path in contact.save(tmp_path)}
    assert "deformed_product.ply" in names
    record = json.loads((tmp_path / "contact.json").read_text())
    assert record["product"]["material"] == {
        "shear_modulus": {"value": G, "unit": "Pa"},
        "poisson_ratio": {"value": NU, "unit": "1"},
        "response": "HalfSpace()",
    }
    assert record["obstacle_share"] == {"value": contact.obstacle_share, "unit": "1"}
    stored = np.load(tmp_path / "contact.npz")
    np.testing.assert_array_equal(stored["obstacle_displacement"], contact.obstacle_displacement)
    vertices, _ = qr.read_mesh(tmp_path / "deformed_product.ply", unit="m")
    np.testing.assert_array_equal(vertices, contact.deformed_obstacle.vertices)  # type: ignore[union-attr]
    assert "share of the product" in contact.summary()
    rigid = pressed(PLATE)
    assert "share of the product" not in rigid.summary()
    assert "deformed_product.ply" not in {path.name for path in rigid.save(tmp_path / "rigid")}


def test_a_body_meets_an_elastic_product() -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    vertices, faces = ball(3e-3, 2)
    bone = qr.Surface(vertices + np.array([0, 0, 5e-3]), faces)
    skin = qr.Skin(shear_modulus=G, poisson_ratio=NU, response=qr.Body(bone=bone)).prepared(surface)
    rigid, elastic = (qr.press(surface, obstacle, skin, UP, depth=5e-4) for obstacle in (PLATE, soft(PLATE)))
    # The bone makes the skin the stiffer of the two.
    assert elastic.obstacle_share is not None
    assert 0.5 < elastic.obstacle_share < 0.8
    assert elastic.force[2] < 0.5 * rigid.force[2]
    active = elastic.active
    level = elastic.deformed.vertices[active, 2] - elastic.obstacle_displacement[active, 2]
    np.testing.assert_allclose(level, elastic.travel, rtol=0, atol=1e-3 * 5e-4)


def test_a_prepared_skin_meets_an_elastic_product() -> None:
    surface = qr.Surface(*grid(20, 1e-3))
    punch = soft(qr.Obstacle.sphere([0, 0, 49.7e-3], 50e-3))
    plain, prepared = (
        qr.solve_contact(surface, punch, skin, options=AS_GIVEN).force[2]
        for skin in (SKIN, SKIN.prepared(surface))
    )
    assert prepared == pytest.approx(plain, rel=1e-9)


def slab_of(thickness: float) -> tuple[qr.Obstacle, int]:
    """Return a slab below z = 0, and how many vertices its upper side has; the lower side's follow."""
    points, squares = grid(12, 6e-3)
    count = len(points)
    rim = {(int(a), int(b)) for face in squares for a, b in zip(face, np.roll(face, -1), strict=True)}
    open_edges = [(a, b) for a, b in rim if (b, a) not in rim]
    sides = [[b, a, a + count] for a, b in open_edges] + [[b, a + count, b + count] for a, b in open_edges]
    vertices = np.concatenate([points, points - [0, 0, thickness]])
    return qr.Obstacle.mesh(vertices, np.concatenate([squares, squares[:, ::-1] + count, sides])), count


def test_a_product_on_a_spring_gives_way_between_fingers_on_both_sides() -> None:
    slab, count = slab_of(4e-3)
    finger, faces = ball(8e-3, 3)
    # 1 mm and 0.4 mm deep, off the vertices.
    beside = np.array([[1.3e-3, 0.7e-3, -1e-3], [1.3e-3, 0.7e-3, -19.6e-3]])
    vertices = np.concatenate([finger + place for place in beside])
    surface = qr.Surface(vertices, np.concatenate([faces, faces + len(finger)]))
    softness = 2e-4
    matrix = np.full((2 * count, 2 * count), softness)
    spring = soft(slab, qr.GivenMatrix(nodes=np.arange(2 * count), compliance=matrix))
    held = qr.solve_contact(surface, spring, SKIN, options=AS_GIVEN)
    assert [np.sign(patch.force[2]) for patch in held.patches] == [1.0, -1.0]
    # The force on the slab moves it, and it stays as it is.
    sunk = -softness * held.force
    rigid = qr.solve_contact(surface, slab.moved(translation=[0, 0, sunk[2]]), SKIN, options=AS_GIVEN)
    assert held.force[2] == pytest.approx(rigid.force[2], rel=5e-3)
    for part, alone in zip(held.patches, rigid.patches, strict=True):
        assert part.force[2] == pytest.approx(alone.force[2], rel=5e-3)
    assert held.deformed_obstacle is not None
    moved = held.deformed_obstacle.vertices - slab.triangles()[0]
    np.testing.assert_allclose(moved, np.broadcast_to(sunk, moved.shape), rtol=0, atol=1e-3 * abs(sunk[2]))


def test_two_fingers_on_one_matrix_push_each_other_through_the_product() -> None:
    lower, faces = ball(8e-3, 3)
    vertices = np.concatenate([lower - np.array([20e-3, 0, 0]), lower + np.array([20e-3, 0, 0])])
    surface = qr.Surface(vertices, np.concatenate([faces, faces + len(lower)]))
    slab, count = slab_of(10e-3)
    # A slab on a spring: what one finger pushes, the other loses.
    softness = 2e-4
    spring = soft(slab, qr.GivenMatrix(nodes=np.arange(count), compliance=np.full((count, count), softness)))
    both = qr.press(surface, spring, SKIN, UP, depth=1e-3, options=AS_GIVEN)
    sunk = softness * both.node_force.sum()
    rigid = qr.press(surface, slab, SKIN, UP, depth=1e-3 - sunk, options=AS_GIVEN)
    assert both.force[2] == pytest.approx(rigid.force[2], rel=5e-3)
    assert len(both.patches) == 2
    why = dict(both.left_out)["coupling between fingers"]
    assert "joined by the product alone" in why


def test_two_fingers_on_a_kernel_push_each_other_through_the_product() -> None:
    lower, faces = ball(8e-3, 3)
    pitch, depth = 40e-3, 5e-4
    both = qr.Surface(
        np.concatenate([lower, lower + np.array([pitch, 0, 0])]), np.concatenate([faces, faces + len(lower)])
    )
    product = soft(PLATE)
    together = qr.press(both, product, SKIN, UP, depth=depth, options=AS_GIVEN)
    # What one finger presses the half-space down by under the other, far from both: K F / r.
    assert product.material is not None
    softness = (1.0 - product.material.poisson_ratio) / (2.0 * np.pi * product.material.shear_modulus)
    sunk = softness * together.force[2] / 2.0 / pitch
    alone = qr.press(qr.Surface(lower, faces), product, SKIN, UP, depth=depth - sunk, options=AS_GIVEN)
    assert together.force[2] == pytest.approx(2 * alone.force[2], rel=1e-3)
    assert "joined by the product alone" in dict(together.left_out)["coupling between fingers"]


@pytest.mark.filterwarnings("ignore::quasirigid.ResponseRangeWarning")  # thin, for what a kernel leaves out
def test_fingers_on_two_sides_of_a_kernel_do_not_push_each_other() -> None:
    finger, faces = ball(8e-3, 3)
    slab = soft(slab_of(4e-3)[0])
    # 0.5 mm deep from above and from below.
    above, below = (finger + np.array([1.3e-3, 0.7e-3, z]) for z in (-0.5e-3, -19.5e-3))
    pinched = qr.solve_contact(
        qr.Surface(np.concatenate([above, below]), np.concatenate([faces, faces + len(finger)])),
        slab,
        SKIN,
        options=AS_GIVEN,
    )
    alone = qr.solve_contact(qr.Surface(above, faces), slab, SKIN, options=AS_GIVEN)
    assert pinched.patches[0].force[2] == pytest.approx(alone.force[2], rel=1e-9)
    assert "face away from each other" in dict(pinched.left_out)["coupling through the product"]


def test_a_combined_skin_meets_an_elastic_product() -> None:
    finger = qr.models.finger(edge_length=2.2e-3)
    finger = finger.with_skin_mask(qr.skin_without_caps(finger))
    part = qr.cut_out(finger, tip=int(np.argmax(finger.vertices[:, 1])), point=[0, 0.04, 0], normal=[0, 2, 0])
    response = part.body(bone=qr.models.bone_of(part.surface, cut=part.fixed))
    tip = qr.Skin(shear_modulus=G, poisson_ratio=NU, response=response).prepared(part.surface)
    whole = SKIN.combined(finger, {"tip": (part, tip)})
    below = finger.vertices[finger.vertices[:, 1] > 0.045, 2].min() - 60e-3
    punch = soft(qr.Obstacle.sphere([0, 0.055, below], 60e-3))
    elastic, alone = (
        qr.press(surface, punch, skin, UP, depth=5e-4, options=AS_GIVEN)
        for surface, skin in ((finger, whole), (part.surface, tip))
    )
    assert elastic.force[2] == pytest.approx(alone.force[2], rel=1e-6)
    assert elastic.obstacle_share == pytest.approx(alone.obstacle_share, rel=1e-6)


def test_the_cut_shows_the_product_before_and_after() -> None:
    pytest.importorskip("matplotlib")
    below = [0, 0, -0.04]
    for obstacle, labels in (
        (BALL, {"product"}),
        (soft(BALL), {"product before", "product after"}),
        (soft(qr.Obstacle.sphere([0, 0, 0], 0.02)), {"product before"}),
    ):
        ax = qr.plot.plot_section(pressed(obstacle.moved(np.eye(3), below)))
        names = ax.get_legend_handles_labels()[1]
        assert {name for name in names if name.startswith("product")} == labels


def test_constants_out_of_range_are_refused() -> None:
    with pytest.raises(qr.ResponseError, match="poisson_ratio"):
        PLATE.with_material(shear_modulus=1e5, poisson_ratio=0.6)


@pytest.mark.parametrize(
    ("response", "why"),
    [
        (qr.Body(fixed=np.zeros(4, dtype=bool)), "a Body is solved under its own skin"),
        (qr.HalfSpace(pressure="one_ring"), "leave them out"),
        (qr.HalfSpace(discretization="galerkin"), "leave them out"),
        (qr.Layer(thickness=np.full(4, 1e-3)), "one thickness everywhere"),
        (qr.GivenMatrix(nodes=[0], compliance=[[1e-4]]), "a primitive has none"),
        (qr.GivenMatrix(nodes=[0], compliance=np.zeros((1, 3, 1, 3))), "along the force"),
    ],
)
def test_a_response_that_no_product_has_is_refused(response: qr.Response, why: str) -> None:
    with pytest.raises(qr.ResponseError, match=why):
        soft(PLATE, response)


def test_a_response_that_is_not_well_posed_is_warned_of_once() -> None:
    with pytest.warns(qr.QuasirigidWarning, match="not well posed") as caught:
        plate = soft(PLATE, qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3))
    assert caught[0].filename == __file__
    # Silent from then on: pytest would make an error of a warning.
    assert pickle.loads(pickle.dumps(plate)).material == plate.material


def test_what_is_no_response_is_refused() -> None:
    with pytest.raises(TypeError, match="expected one of"):
        soft(PLATE, "half_space")  # type: ignore[arg-type]


def test_a_matrix_of_the_product_names_what_it_lacks() -> None:
    few = soft(BALL, qr.GivenMatrix(nodes=[0, 1], compliance=np.eye(2) * 1e-4))
    with pytest.raises(qr.ResponseError, match="none of the 2 nodes of the product's matrix"):
        pressed(few.moved(np.eye(3), [0, 0, -0.04]))
    with pytest.raises(qr.ResponseError, match="but there are 2562 vertices"):
        soft(BALL, qr.GivenMatrix(nodes=[2562], compliance=[[1e-4]]))


# A skin as hard as steel, on cells as long as the layer is thick.
@pytest.mark.filterwarnings("ignore::quasirigid.ModulusWarning")
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
@pytest.mark.parametrize("discretization", ["collocation", "galerkin"])
@pytest.mark.parametrize("target_error", [None, 0.02])
def test_a_layer_touches_as_much_on_the_product_as_on_the_skin(
    discretization: str, target_error: float | None
) -> None:
    surface = qr.Surface(*grid(24, 20e-3 / 24))
    indenter = qr.Obstacle.sphere([0.3e-3, 0.2e-3, 50e-3], 50e-3)
    gives = {"shear_modulus": 30e3, "poisson_ratio": 0.5}
    hard = {"shear_modulus": 1e12, "poisson_ratio": 0.4}
    on_skin = qr.Skin(**gives, response=qr.Layer(thickness=0.5e-3, discretization=discretization))
    under = qr.Skin(**hard, response=qr.HalfSpace(discretization=discretization))
    on_product = indenter.with_material(**gives, response=qr.Layer(thickness=0.5e-3))
    options = qr.ContactOptions(target_error=target_error)
    one, other = (
        qr.press(surface, obstacle, skin, [0.0, 0.0, -1.0], depth=0.2e-3, options=options)
        for obstacle, skin in ((indenter, on_skin), (on_product, under))
    )
    assert other.force[2] == pytest.approx(one.force[2], rel=1e-3)
    assert other.contact_area == pytest.approx(one.contact_area, rel=1e-3)
