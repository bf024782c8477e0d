"""Refinement over a body or a prepared kernel, against finite elements of a sphere with a rigid core."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr
from numpy.typing import NDArray
from refined import MATERIAL, TARGET, UP, Floats, jittered_ball
from shapes import AS_GIVEN, PLATE, ball

# Scenes are coarse on purpose, and taken as they are; some are metres wide.
pytestmark = [
    pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning"),
    pytest.mark.filterwarnings("ignore::quasirigid.SizeWarning"),
]


@pytest.mark.parametrize(
    "response",
    [
        qr.HalfSpace(),
        qr.HalfSpace(discretization="galerkin"),
        qr.Layer(thickness=4e-3),
        qr.GaussianCorrected.balanced(width=10e-3, cutoff=15e-3),
    ],
    ids=["half-space", "Galerkin", "layer", "Gaussian"],
)
def test_a_prepared_kernel_refines_as_the_kernel_does(response: qr.Response) -> None:
    surface = jittered_ball(1)
    skin = qr.Skin(**MATERIAL, response=response)
    one = qr.press(surface, PLATE, skin, UP, depth=0.5e-3)
    two = qr.press(surface, PLATE, skin.prepared(surface), UP, depth=0.5e-3)
    assert len(one.parents) == len(two.parents) > 0
    assert two.force[2] == pytest.approx(one.force[2], rel=1e-9)


def test_a_layer_as_thick_at_every_vertex_is_the_even_one() -> None:
    surface = jittered_ball(1)

    def force(thickness: float | Floats) -> float:
        skin = qr.Skin(**MATERIAL, response=qr.Layer(thickness=thickness))
        contact = qr.press(surface, PLATE, skin, UP, depth=0.5e-3)
        assert len(contact.parents) > 0
        return float(contact.force[2])

    even = force(4e-3)
    assert force(np.full(len(surface.vertices), 4e-3)) == pytest.approx(even, rel=1e-9)
    # From 3 to 5 mm across the ball.
    sloping = force(4e-3 + surface.vertices[:, 0] / 8)
    assert force(5e-3) < sloping < force(3e-3)


def core() -> qr.Surface:
    """A rigid core of 3 mm in the middle of the ball."""
    vertices, faces = ball(3e-3, 2)
    return qr.Surface(vertices + 5e-3 * UP, faces)


@pytest.fixture(scope="module", params=[None, 0], ids=["two levels", "one level"])
def body(request: pytest.FixtureRequest) -> tuple[qr.Surface, qr.PreparedSkin]:
    """A ball that its core holds, and its body, the low part prepared."""
    surface = qr.Surface(*ball(8e-3, 3))
    response = qr.Body(bone=core(), bone_pressure=True, coarse_edge_length=request.param)
    return surface, qr.Skin(**MATERIAL, response=response).prepared(surface, low_vertices(surface))


def low_vertices(surface: qr.Surface) -> NDArray[np.int64]:
    return np.flatnonzero(surface.vertices[:, 2] < 4e-3)


Prepared = tuple[qr.Surface, qr.PreparedSkin]


@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
def test_a_prepared_body_refines(body: Prepared) -> None:
    surface, prepared = body
    sphere = qr.reference.plate_on_cored_sphere()[0]
    true = sphere.indentations[0.6e-3]
    contact = qr.press(surface, PLATE, prepared, UP, depth=0.6e-3)
    as_given = qr.press(surface, PLATE, prepared, UP, depth=0.6e-3, options=AS_GIVEN)
    assert len(contact.parents) > 0
    accuracy = contact.accuracy
    assert accuracy.force_error is not None
    assert accuracy.mesh_error is not None
    assert accuracy.body_error is not None
    assert accuracy.force_error == accuracy.mesh_error + accuracy.body_error
    assert accuracy.mesh_error <= TARGET
    assert accuracy.body_error > 0
    error = abs(contact.force[2] / true - 1)
    assert error <= accuracy.force_error + sphere.accuracy
    assert error <= abs(as_given.force[2] / true - 1)


@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
@pytest.mark.parametrize("coarse_edge_length", [1.5e-3, 2e-3, 3e-3, 4e-3])
def test_the_estimate_of_a_coarse_body_covers_its_error(coarse_edge_length: float) -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    response = qr.Body(bone=core(), coarse_edge_length=coarse_edge_length)
    for sphere in qr.reference.plate_on_cored_sphere():
        material = {"shear_modulus": 60e3, "poisson_ratio": sphere.poisson_ratio}
        prepared = qr.Skin(**material, response=response).prepared(surface, low_vertices(surface))
        for depth, true in sphere.indentations.items():
            contact = qr.press(surface, PLATE, prepared, UP, depth=depth)
            assert contact.accuracy.force_error is not None
            assert abs(contact.force[2] / true - 1) <= contact.accuracy.force_error + sphere.accuracy


# Forces (N) of a rigid ball by its radius and Poisson's ratio, at depths (m), the contact solved to the end:
# of the large one by axisymmetric finite elements, of the small one by the series of the shell.
BALLS_ON_CORED_SPHERE = {
    (known.indenter_radius, known.poisson_ratio): known.indentations
    for known in qr.reference.ball_on_cored_sphere()
} | {
    (3e-3, 0.3): {0.5e-3: 0.1359, 1e-3: 0.3894, 2e-3: 1.0320},
    (3e-3, 0.495): {0.5e-3: 0.1703, 1e-3: 0.4598, 2e-3: 1.1116},
}


@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
@pytest.mark.parametrize("coarse_edge_length", [None, 0], ids=["two levels", "one level"])
@pytest.mark.parametrize(("radius", "poisson_ratio"), BALLS_ON_CORED_SPHERE)
def test_a_ball_leans_on_a_body_as_in_finite_elements(
    radius: float, poisson_ratio: float, coarse_edge_length: float | None
) -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    skin = qr.Skin(
        shear_modulus=60e3,
        poisson_ratio=poisson_ratio,
        response=qr.Body(bone=core(), coarse_edge_length=coarse_edge_length),
    )
    prepared = skin.prepared(surface, low_vertices(surface))
    indenter = qr.Obstacle.sphere([0, 0, -0.05], radius)
    for depth, true in BALLS_ON_CORED_SPHERE[radius, poisson_ratio].items():
        contact = qr.press(surface, indenter, prepared, UP, depth=depth)
        assert contact.force[2] == pytest.approx(true, rel=0.025)


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_compressible_body_is_as_stiff_as_its_modulus_however_soft() -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    forces = []
    for modulus in (60e3, 1e-3, 1e-20):
        skin = qr.Skin(shear_modulus=modulus, poisson_ratio=0.3, response=qr.Body(bone=core()))
        prepared = skin.prepared(surface, low_vertices(surface))
        contact = qr.press(surface, qr.Obstacle.sphere([0, 0, -0.05], 5e-3), prepared, UP, depth=1e-3)
        assert np.isfinite(contact.deformed.vertices).all()
        forces.append(contact.force[2] / modulus)
    np.testing.assert_allclose(forces, forces[0], rtol=1e-9)


@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
@pytest.mark.parametrize("coarse_edge_length", [None, 0], ids=["two levels", "one level"])
def test_the_drawn_skin_of_a_refined_body_lies_on_the_plate_and_is_still_where_it_is_fixed(
    coarse_edge_length: float | None,
) -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    held = surface.vertices[:, 2] > 15e-3
    response = qr.Body(bone=core(), fixed=held, coarse_edge_length=coarse_edge_length)
    prepared = qr.Skin(**MATERIAL, response=response).prepared(surface, low_vertices(surface))
    contact = qr.press(surface, PLATE, prepared, UP, depth=0.6e-3)
    heights = contact.obstacle.signed_distance(contact.deformed.vertices)[0]
    assert np.abs(heights[contact.active]).max() < 1e-9
    free = np.setdiff1d(contact.candidates, contact.active)
    np.testing.assert_allclose(heights[free], contact.gap[free], atol=1e-9)
    assert not contact.displacement[: len(held)][held].any()


@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
def test_the_bone_feels_a_refined_contact_as_a_given_one_of_its_force(body: Prepared) -> None:
    surface, prepared = body
    contact = qr.press(surface, PLATE, prepared, UP, depth=0.6e-3)
    as_given = qr.press(surface, PLATE, prepared, UP, depth=0.6e-3, options=AS_GIVEN)
    found, known = (prepared.bone_pressure(one) / one.force[2] for one in (contact, as_given))
    # From afar only the force counts and, in second order, how wide it is spread.
    np.testing.assert_allclose(found, known, atol=0.03 * known.max())
    # Loads of one's own are at the given vertices.
    with pytest.raises(qr.ResponseError, match="force"):
        prepared.bone_pressure(contact.force_vectors)
