"""Meshes refined around a contact, until force and area are as good as asked for."""

from __future__ import annotations

import math

import numpy as np
import pytest
import quasirigid as qr
from refined import MATERIAL, TARGET, UP, jittered_ball
from shapes import AS_GIVEN, PLATE, SKIN, TURN, ball, grid

# Scenes are coarse on purpose, and taken as they are; some are metres wide.
pytestmark = [
    pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning"),
    pytest.mark.filterwarnings("ignore::quasirigid.SizeWarning"),
]

# So large that sphere and Hertz's parabola are one.
RADIUS, APPROACH = 200.0, 0.5e-3
HERTZ = qr.reference.Hertz(radius=RADIUS, contact_modulus=qr.reference.contact_modulus(**MATERIAL))


def jittered_grid(cells: int, seed: int) -> qr.Surface:
    """A flat square about the origin, of so many cells per radius of the contact of Hertz."""
    spacing = HERTZ.contact_radius(APPROACH) / cells
    vertices, faces = grid(4 * cells, spacing)
    random = np.random.default_rng(seed)
    vertices[:, :2] += random.uniform(-0.25 * spacing, 0.25 * spacing, (len(vertices), 2))
    return qr.Surface(vertices, faces)


def test_without_a_target_the_mesh_is_taken_as_it_is() -> None:
    surface = jittered_ball(1)
    contact = qr.press(surface, PLATE, SKIN, UP, depth=1e-3, options=AS_GIVEN)
    assert contact.surface is surface
    assert contact.given_vertex_count == len(surface.vertices)
    assert contact.parents.shape == (0, 2)
    assert [one.reason for one in contact.refinements] == ["the mesh was taken as it is"]
    # Its errors are estimated all the same.
    assert contact.accuracy.force_error is not None
    assert contact.accuracy.force_error > TARGET


@pytest.mark.parametrize("discretization", ["collocation", "galerkin"])
def test_a_given_mesh_that_meets_the_target_is_not_refined(discretization: qr.Discretization) -> None:
    surface = qr.Surface(*ball(8e-3, 4))
    skin = qr.Skin(**MATERIAL, response=qr.HalfSpace(discretization=discretization))

    def pressed(target: float) -> qr.Contact:
        options = qr.ContactOptions(target_error=target)
        return qr.press(surface, PLATE, skin, UP, depth=2e-3, options=options)

    contact, finer = pressed(0.05), pressed(0.005)
    assert contact.surface is surface
    assert [one.reason for one in contact.refinements] == ["target_error"]
    assert finer.surface is not surface
    force_error, area_error = contact.accuracy.force_error, contact.accuracy.area_error
    assert force_error is not None
    assert area_error is not None
    assert max(force_error, area_error) <= 0.05
    assert np.linalg.norm(contact.force - finer.force) < force_error * np.linalg.norm(contact.force)
    assert abs(contact.contact_area - finer.contact_area) < area_error * contact.contact_area


@pytest.mark.parametrize("kind", ["one rings", "given matrix"])
def test_a_response_on_its_own_nodes_takes_the_mesh_as_it_is(kind: str) -> None:
    surface = jittered_ball(1)
    low = np.flatnonzero(surface.vertices[:, 2] < 2e-3)
    response: qr.Response = qr.HalfSpace(pressure="one_ring")
    if kind == "given matrix":
        response = qr.GivenMatrix(nodes=low, compliance=qr.response_matrix(surface, SKIN, low))
    contact = qr.press(surface, PLATE, qr.Skin(**MATERIAL, response=response), UP, depth=0.5e-3)
    assert contact.surface is surface
    # Nobody refines it where it is too coarse.
    assert {one.category for one in contact.warnings} <= {qr.CoarseMeshWarning}
    assert not any("target_error" in one.message for one in contact.warnings)
    assert {"refinement", "estimates of error"} <= {what for what, _ in contact.left_out}
    accuracy = contact.accuracy
    estimates = (
        accuracy.force_error,
        accuracy.mesh_error,
        accuracy.body_error,
        accuracy.area_error,
        accuracy.max_pressure_error,
    )
    assert estimates == (None,) * 5


def test_apart_there_is_nothing_to_refine_or_estimate() -> None:
    surface = jittered_ball(1)
    apart = qr.solve_contact(surface, PLATE.moved(np.eye(3), [0, 0, -1e-3]), SKIN)
    assert apart.status == "no_contact"
    assert apart.surface is surface
    assert apart.accuracy.force_error is None
    assert "estimates of error" in dict(apart.left_out)


@pytest.mark.parametrize("target", [0.0, -1.0, math.nan, 1.0, 2.0])
def test_a_target_out_of_range_is_named(target: float) -> None:
    options = qr.ContactOptions(target_error=target)
    with pytest.raises(qr.ContactError, match="`target_error` is"):
        qr.press(jittered_ball(1), PLATE, SKIN, UP, depth=0.5e-3, options=options)


def test_the_most_nodes_end_the_refinement_with_a_warning() -> None:
    options = qr.ContactOptions(max_nodes=200, target_error=1e-3)
    with pytest.warns(qr.QuasirigidWarning, match="ended: `max_nodes`"):
        contact = qr.press(jittered_ball(1), PLATE, SKIN, UP, depth=0.5e-3, options=options)
    assert contact.refinements[-1].reason == "max_nodes"
    assert len(contact.refinements) > 1
    assert all(one.nodes <= 200 for one in contact.refinements)
    options = qr.ContactOptions(max_nodes=0)
    with pytest.raises(qr.ContactError, match="max_nodes is 0"):
        qr.press(jittered_ball(1), PLATE, SKIN, UP, depth=0.5e-3, options=options)


@pytest.mark.parametrize("target", [0.1, 0.02, 0.005])
def test_the_rounds_lead_to_the_figures_and_the_estimates_to_the_target(target: float) -> None:
    options = qr.ContactOptions(target_error=target)
    contact = qr.press(jittered_ball(1), PLATE, SKIN, UP, depth=0.5e-3, options=options)
    first, *rounds = contact.refinements
    as_given = qr.press(jittered_ball(1), PLATE, SKIN, UP, depth=0.5e-3, options=AS_GIVEN)
    np.testing.assert_array_equal(first.force, as_given.force)
    assert first.contact_area == as_given.contact_area
    last = rounds[-1]
    np.testing.assert_array_equal(last.force, contact.force)
    assert (last.contact_area, last.max_pressure) == (contact.contact_area, contact.max_pressure)
    assert last.nodes == len(contact.candidates)
    assert [one.reason for one in contact.refinements] == [""] * len(rounds) + ["target_error"]
    nodes = [one.nodes for one in contact.refinements]
    assert nodes == sorted(set(nodes))
    accuracy = contact.accuracy
    assert (last.force_error, last.area_error) == (accuracy.force_error, accuracy.area_error)
    assert accuracy.mesh_error is not None
    assert accuracy.area_error is not None
    assert accuracy.max_pressure_error is not None
    assert 0 <= accuracy.mesh_error <= target
    assert 0 <= accuracy.area_error <= target
    assert accuracy.max_pressure_error >= 0
    assert accuracy.body_error == 0
    assert accuracy.force_error == accuracy.mesh_error


@pytest.mark.parametrize("discretization", qr.Discretization)
@pytest.mark.parametrize("seed", range(8))
def test_a_coarse_grid_reaches_hertz_within_the_estimate(
    seed: int, discretization: qr.Discretization
) -> None:
    sphere = qr.Obstacle.sphere([0, 0, RADIUS - APPROACH], RADIUS)
    skin = qr.Skin(**MATERIAL, response=qr.HalfSpace(discretization=discretization))
    contact = qr.solve_contact(jittered_grid(3, seed), sphere, skin)
    found = [-contact.force[2], contact.contact_area]
    true = [HERTZ.force(APPROACH), math.pi * HERTZ.contact_radius(APPROACH) ** 2]
    errors = np.abs(np.divide(found, true) - 1)
    # An estimate is no bound: the errors of the Galerkin form scatter about it.
    errors *= 0.5 if discretization == "galerkin" else 1.0
    assert contact.accuracy.force_error is not None
    assert contact.accuracy.area_error is not None
    assert errors[0] <= contact.accuracy.force_error < TARGET
    assert errors[1] <= contact.accuracy.area_error < TARGET


def test_place_scale_and_numbering_do_not_matter() -> None:
    surface = jittered_ball(2)
    force = qr.press(surface, PLATE, SKIN, UP, depth=0.5e-3).force[2]

    shift = [0.4, -0.2, 1.3]
    plate = PLATE.moved(TURN, shift)
    turned = qr.press(surface.moved(TURN, shift), plate, SKIN, TURN @ UP, depth=0.5e-3)
    np.testing.assert_allclose(turned.force, TURN @ [0, 0, force], atol=1e-6 * force)

    large = qr.Surface(1e3 * surface.vertices, surface.faces)
    assert qr.press(large, PLATE, SKIN, UP, depth=0.5).force[2] / 1e6 == pytest.approx(force, rel=1e-6)

    random = np.random.default_rng(3)
    order = random.permutation(len(surface.vertices))
    faces = np.argsort(order)[surface.faces][random.permutation(len(surface.faces))]
    renumbered = qr.Surface(surface.vertices[order], np.roll(faces, 1, axis=1))
    assert qr.press(renumbered, PLATE, SKIN, UP, depth=0.5e-3).force[2] == pytest.approx(force, rel=1e-6)


@pytest.mark.parametrize("count", [1, 2])
def test_results_are_equal_to_the_bit_for_any_number_of_threads(count: int) -> None:
    options = qr.ContactOptions(num_threads=count)
    one = qr.press(jittered_ball(2), PLATE, SKIN, UP, depth=0.5e-3, options=options)
    default = qr.press(jittered_ball(2), PLATE, SKIN, UP, depth=0.5e-3)
    np.testing.assert_array_equal(one.node_force, default.node_force)
    np.testing.assert_array_equal(one.surface.vertices, default.surface.vertices)


@pytest.mark.filterwarnings("ignore::quasirigid.ResponseRangeWarning")
def test_a_refined_contact_without_answer_keeps_its_rounds() -> None:
    tip = qr.models.fingertip(edge_length=2.5e-3)
    tip = tip.with_skin_mask(qr.skin_without_caps(tip))
    # Between the vertices of the given mesh, with a kernel that draws a lone vertex in.
    near = np.array([[0.4313, -0.3891, -0.8140], [-0.5482, 0.6036, -0.5790], [0.7166, 0.6959, 0.0470]])
    left, _, right = np.linalg.svd(near)
    box = qr.models.rounded_box(size=(0.04, 0.03, 0.008), edge_length=2.5e-3).moved(
        left @ right, [0.1923, -0.1022, 0.2994]
    )
    skin = qr.Skin(
        shear_modulus=1e5,
        poisson_ratio=0.0,
        response=qr.GaussianCorrected(height=None, width=1.5e-3, cutoff=0.01),
    )
    contact = qr.press(tip, box, skin, [-0.529, 0.276, -0.803], depth=2e-5, throw=False)
    assert contact.status == "ray"
    rounds = [one for one in contact.refinements if one.kind == "mesh"]
    assert [one.nodes for one in rounds] == [0, 1]
    assert rounds[-1].reason == "a complementarity problem did not end solved"
    assert rounds[-1].force_error is None
