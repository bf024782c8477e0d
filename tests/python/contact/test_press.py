"""Presses from Python: what comes back, and how failures look."""

from __future__ import annotations

import subprocess
import sys
from functools import partial
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, PLATE, SKIN, ball, grid

RADIUS, APPROACH = 0.2, 0.5e-3
MODULUS = qr.reference.contact_modulus(shear_modulus=60e3, poisson_ratio=0.5)
HERTZ = qr.reference.Hertz(radius=RADIUS, contact_modulus=MODULUS)


@pytest.fixture
def paper_skin() -> qr.Skin:
    """The constants printed in the paper, which are not well posed."""
    response = qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3)
    with pytest.warns(qr.QuasirigidWarning, match="not well posed"):
        return qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)


@pytest.fixture(scope="module")
def contact() -> qr.Contact:
    return qr.press(qr.Surface(*ball(8e-3, 4)), PLATE, SKIN, [0, 0, 2], depth=0.5e-3)


def test_a_sphere_on_flat_skin_gives_hertz(contact: qr.Contact) -> None:
    cells = 8
    surface = qr.Surface(*grid(3 * cells, HERTZ.contact_radius(APPROACH) / cells))
    sphere = qr.Obstacle.sphere([0, 0, RADIUS - APPROACH], RADIUS)
    pressed = qr.solve_contact(surface, sphere, SKIN, options=AS_GIVEN)
    # The true sphere differs by 0.1 % from Hertz's parabola, the mesh by 0.1 % at 8 cells.
    assert -pressed.force[2] == pytest.approx(HERTZ.force(APPROACH), rel=2e-3)
    assert pressed.max_pressure == pytest.approx(HERTZ.max_pressure(APPROACH), rel=5e-3)


def test_the_arrays_add_up_to_the_scalars(contact: qr.Contact) -> None:
    n = len(contact.deformed.vertices)
    assert contact.pressure.shape == contact.node_force.shape == contact.gap.shape == (n,)
    assert contact.displacement.shape == (n, 3)
    assert contact.force[2] == pytest.approx(contact.node_force.sum(), rel=1e-12)
    assert contact.max_pressure == contact.pressure.max()
    np.testing.assert_array_equal(np.flatnonzero(contact.node_force > 0), contact.active)
    assert set(contact.active) <= set(contact.candidates)
    position = contact.deformed.vertices
    center = (contact.node_force[:, None] * position).sum(0) / contact.node_force.sum()
    np.testing.assert_allclose(contact.center_of_pressure, center, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(contact.moment, np.cross(center, contact.force), atol=1e-12)
    assert sum(patch.contact_area for patch in contact.patches) == pytest.approx(contact.contact_area)


def test_the_gaps_are_complementary(contact: qr.Contact) -> None:
    gap, force = contact.gap[contact.candidates], contact.node_force[contact.candidates]
    assert gap.min() >= -1e-12
    assert np.abs(gap * force).max() <= 1e-12 * 0.5e-3 * force.max()
    assert np.isinf(contact.gap).any(), "far vertices are not measured"


def test_a_contact_says_what_it_cost_left_out_and_is_worth(contact: qr.Contact) -> None:
    assert contact.status == "solved"
    solving = {"first_touch", "signed_distance", "response", "lcp", "outcome"}
    assert set(contact.timings) == solving | {"refinement"}
    assert any("product" in what for what, _ in contact.left_out)
    assert contact.natural_residual == contact.accuracy.natural_residual <= 1e-10
    assert contact.accuracy.cells_per_radius > 2
    for error in (contact.accuracy.force_error, contact.accuracy.area_error):
        assert error is not None
        assert 0 < error <= qr.ContactOptions().target_error  # type: ignore[operator]
    assert contact.advice == ""


@pytest.mark.parametrize("option", ["rings", "max_growths", "num_threads", "memory_limit"])
def test_counts_out_of_range_are_named(option: str) -> None:
    surface = qr.Surface(*ball(8e-3, 1))
    for value, error in ((-1, ValueError), (2**70, ValueError), (0.5, TypeError), (True, TypeError)):
        options = qr.ContactOptions(**{option: value})  # type: ignore[arg-type]
        with pytest.raises(error, match=f"{option} is .*expected an integer"):
            qr.press(surface, PLATE, SKIN, [0, 0, 2], depth=0.5e-3, options=options)


def test_an_ending_raises_with_the_contact_or_is_returned(paper_skin: qr.Skin) -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    with pytest.raises(qr.ContactError, match="the contact did not end solved: ray: after") as caught:
        qr.press(surface, PLATE, paper_skin, [0, 0, 1], depth=1.5e-3)
    assert caught.value.contact is not None
    assert caught.value.contact.status is qr.ContactStatus.RAY
    quiet = qr.press(surface, PLATE, paper_skin, [0, 0, 1], depth=1.5e-3, throw=False)
    assert quiet.status == "ray"
    assert quiet.advice
    assert np.isnan(quiet.force).all()


def test_no_contact_is_no_error() -> None:
    apart = qr.solve_contact(qr.Surface(*ball(8e-3, 2)), PLATE.moved(np.eye(3), [0, 0, -1e-3]), SKIN)
    assert apart.status == "no_contact"
    assert not apart.force.any()
    assert apart.contact_area == 0
    assert np.isnan(apart.center_of_pressure).all()
    assert apart.lcp_solutions == ()


def test_bad_questions_raise_and_name_the_fault() -> None:
    surface = qr.Surface(*ball(8e-3, 2))
    with pytest.raises(qr.ContactError, match="cannot be normalised"):
        qr.press(surface, PLATE, SKIN, [0, 0, 0], depth=1e-3)
    with pytest.raises(qr.ContactError, match=r"depth is -0\.001"):
        qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=-1e-3)
    with pytest.raises(qr.ContactError, match="already penetrates"):
        qr.press(surface, PLATE.moved(np.eye(3), [0, 0, 1e-3]), SKIN, [0, 0, 1], depth=1e-3, start="current")
    between = qr.Obstacle.box([0.5e-3, 0.03, 0.01]).moved(translation=[0.0, 0.0, -8.5e-3])
    points, faces = grid(5, 4e-3)
    with pytest.raises(qr.ContactError, match=r"stands in the skin by 1\.50*e-3 m between"):
        qr.press(qr.Surface(points, faces[:, ::-1]), between, SKIN, [0, 0, 1], depth=0.0, start="current")
    with pytest.raises(qr.ContactError, match=r"depth is 1e61 m, expected a depth from 0 to 1e60 m"):
        qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=1e61)
    with pytest.raises(ValueError, match="start is"):
        qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=1e-3, start="somewhere")  # type: ignore[arg-type]
    options = qr.ContactOptions(target_error=2.0)
    with pytest.raises(
        qr.ContactError, match=r"expected a number in \(0, 1\), or None for the mesh as it is"
    ):
        qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=1e-3, options=options)
    options = qr.ContactOptions(method="guess")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="method is"):
        qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=1e-3, options=options)
    with pytest.raises(qr.ResponseError, match="poisson_ratio"):
        qr.Skin(shear_modulus=60e3, poisson_ratio=0.6, response=qr.HalfSpace())


def test_a_product_in_another_unit_is_warned_about() -> None:
    vertices, faces = ball(8e-3, 2)
    huge = qr.Obstacle.mesh(vertices * 1e3 - [0, 0, 17], faces)
    with pytest.warns(qr.SizeWarning, match="unit"):
        qr.solve_contact(qr.Surface(vertices, faces), huge, SKIN)


def test_a_contact_that_the_skin_mask_cuts_is_warned_about_once() -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    surface = surface.with_skin_mask(surface.vertices[:, 0] > 0)
    with pytest.warns(
        qr.QuasirigidWarning, match="reaches the rim of the skin mask, with .* N there"
    ) as told:
        contact = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=0.5e-3)
    assert [(one.category, str(one.message)) for one in told] == list(contact.warnings)
    assert len(told) == 1
    assert contact.warnings[0].category is qr.CutWarning
    assert "(`skin_mask`)" in contact.warnings[0].message


def test_the_galerkin_form_nears_hertz_with_a_symmetric_matrix() -> None:
    response = qr.HalfSpace(discretization="galerkin")
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    errors = []
    for cells in (5, 10):
        surface = qr.Surface(*grid(3 * cells, HERTZ.contact_radius(APPROACH) / cells))
        sphere = qr.Obstacle.sphere([0, 0, RADIUS - APPROACH], RADIUS)
        galerkin = qr.solve_contact(surface, sphere, skin, options=AS_GIVEN)
        errors.append(abs(-galerkin.force[2] / HERTZ.force(APPROACH) - 1))
        matrix = qr.response_matrix(surface, skin, galerkin.candidates)
        np.testing.assert_array_equal(matrix, matrix.T)
        assert qr.definiteness(matrix).positive_definite
        # A vertex may keep a penetration, of the order of the mesh error h^2 / 2 R.
        assert galerkin.max_penetration_after < 2 * APPROACH / (2 * cells**2)
    # A true sphere is 0.15 % softer than Hertz's parabola at this depth; the mesh adds less.
    assert max(errors) < 3e-3


def test_conjugate_gradients_name_the_form_that_is_symmetric() -> None:
    surface = qr.Surface(*ball(8e-3, 4))
    options = qr.ContactOptions(method="projected_cg", target_error=None)
    with pytest.raises(qr.QuasirigidError, match=r"symmetric.*galerkin"):
        qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=0.5e-3, options=options)
    for response in (
        qr.HalfSpace(discretization="galerkin"),
        qr.Layer(thickness=4e-3, discretization="galerkin"),
    ):
        skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
        contact = qr.press(surface, PLATE, skin, [0, 0, 1], depth=0.5e-3, options=options)
        assert contact.lcp_solutions[0].method == "projected_cg"


def test_fingers_are_solved_apart_unless_asked_otherwise() -> None:
    vertices, faces = ball(8e-3, 3)
    two = np.concatenate([vertices, vertices + np.array([20e-3, 0, 0])])
    surface = qr.Surface(two, np.concatenate([faces, faces + len(vertices)]))
    apart = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=0.5e-3)
    one = qr.press(qr.Surface(vertices, faces), PLATE, SKIN, [0, 0, 1], depth=0.5e-3)
    assert len(apart.lcp_solutions) == 2
    assert dict(apart.left_out).get("coupling between fingers")
    assert apart.force[2] == pytest.approx(2 * one.force[2], rel=1e-9)
    options = qr.ContactOptions(couple_fingers=True)
    coupled = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=0.5e-3, options=options)
    assert len(coupled.lcp_solutions) == 1
    assert coupled.force[2] < apart.force[2]


def test_a_bare_response_is_no_skin() -> None:
    finger = qr.models.fingertip(edge_length=2e-3)
    ball = qr.Obstacle.sphere((0.0, 0.0, -0.1), 0.05)
    with pytest.raises(TypeError, match="skin is a HalfSpace, expected a Skin"):
        qr.press(finger, ball, qr.HalfSpace(), (0, 0, 1), depth=1e-3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="skin is a NoneType"):
        qr.response_matrix(finger, None, [0, 1])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("direction", "length"),
    [([0, 0, 2], "2"), ([0, 0, 0], "0"), ([0.6, 0, 0.800002], "1.0000016"), ([0, np.nan, 1], "NaN")],
)
def test_directions_that_are_not_unit_are_refused(
    fingertip: qr.Surface, direction: list[float], length: str
) -> None:
    expected = rf"^directions\[1\] has length {length}\d*, expected a unit vector$"
    with pytest.raises(qr.ResponseError, match=expected):
        qr.response_matrix(fingertip, SKIN, [0, 1], directions=[[0, 0, 1], direction])
    normals = fingertip.vertex_normals[:2].astype(np.float32)
    found = qr.response_matrix(fingertip, SKIN, [0, 1], directions=-normals)
    np.testing.assert_array_equal(found, qr.response_matrix(fingertip, SKIN, [0, 1]))
    for wrong, refusal in (("up", TypeError), ([["0", "0", "1"]] * 2, TypeError), ([0, 0, 1], ValueError)):
        with pytest.raises(refusal, match="directions"):
            qr.response_matrix(fingertip, SKIN, [0, 1], directions=wrong)


@pytest.mark.parametrize(
    ("name", "least"),
    [
        ("max_nodes", 1),
        ("max_linearizations", 1),
        ("rings", 0),
        ("num_threads", 1),
        ("memory_limit", 0),
        ("max_growths", 0),
    ],
)
@pytest.mark.parametrize("below", [1, 2])
def test_counts_below_the_least_are_errors_of_the_contact(
    fingertip: qr.Surface, name: str, least: int, below: int
) -> None:
    plate = qr.Obstacle.half_space([0, 0, -1], [0, 0, 1])
    counts: dict[str, Any] = {name: least - below}
    expected = f"^{name} is {least - below}, expected an integer of at least {least}$"
    with pytest.raises(qr.ContactError, match=expected):
        qr.press(fingertip, plate, SKIN, [0, 0, 1], depth=1e-3, options=qr.ContactOptions(**counts))


@pytest.mark.skipif(sys.platform != "linux", reason="the limit of addresses is read on Linux")
def test_what_a_limit_of_addresses_leaves_is_what_is_free() -> None:
    code = """
import re, resource
from pathlib import Path
import numpy as np, quasirigid as qr
tip = qr.models.fingertip(edge_length=0.6e-3)
skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
qr.response_matrix(tip, skin, np.arange(100))
taken = 1024 * int(re.search("VmSize: *\\t* *([0-9]+)", Path("/proc/self/status").read_text())[1])
resource.setrlimit(resource.RLIMIT_AS, (taken + 300_000_000,) * 2)
try:
    qr.response_matrix(tip, skin, np.arange(5000))
except qr.ResponseError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    # The matrix and its copy by rows.
    assert "5000 nodes needs 400000000 bytes" in done.stdout


@pytest.mark.parametrize("options", [{}, 5, "auto", [], qr.LcpOptions()])
def test_options_of_another_kind_are_refused_by_name(fingertip: qr.Surface, options: Any) -> None:
    plate = qr.Obstacle.half_space([0, 0, -1], [0, 0, 1])
    for solve in (
        partial(qr.solve_contact, fingertip, plate, SKIN),
        partial(qr.press, fingertip, plate, SKIN, [0, 0, 1], depth=1e-3),
        partial(qr.sweep, fingertip, plate, SKIN, [0, 0, 1], depths=[1e-3]),
    ):
        with pytest.raises(TypeError, match=r"options is .*, expected a ContactOptions"):
            solve(options=options)
    if not isinstance(options, qr.LcpOptions):
        with pytest.raises(TypeError, match=r"options is .*, expected an LcpOptions"):
            qr.solve_lcp([[1.0]], [-1.0], options=options)


@pytest.mark.parametrize("num_threads", [5_000, 2**40])
def test_no_number_of_threads_is_more_than_the_machine_can_start(
    fingertip: qr.Surface, num_threads: int
) -> None:
    plate = qr.Obstacle.half_space([0, 0, -1], [0, 0, 1])
    one, many = (
        qr.press(fingertip, plate, SKIN, [0, 0, 1], depth=1e-3, options=qr.ContactOptions(num_threads=count))
        for count in (1, num_threads)
    )
    np.testing.assert_array_equal(one.node_force, many.node_force)
    threads = qr.response_matrix(fingertip, SKIN, [0, 1, 2], num_threads=num_threads)
    np.testing.assert_array_equal(threads, qr.response_matrix(fingertip, SKIN, [0, 1, 2]))


def test_the_estimate_on_a_thin_layer_knows_how_thick_it_is() -> None:
    thickness, radius = 1e-3, 1.0
    layer = qr.Layer(thickness=thickness)
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=layer)
    # F = 2 pi G R^2 d^3 / h^3 of an incompressible film (Johnson 1985, 5.8); with 20 thicknesses a
    # radius some 3 % more.
    reach = 20 * thickness
    depth = reach**2 / (4 * radius)
    film = 1.03 * 2 * np.pi * 60e3 * radius**2 * depth**3 / thickness**3
    surface = qr.Surface(*grid(20, 3e-3))
    ball_of_1_m = qr.Obstacle.sphere([6e-3, 4e-3, radius + 10e-3], radius)
    contact = qr.press(surface, ball_of_1_m, skin, [0, 0, -1], depth=depth, options=AS_GIVEN)
    force, accuracy = -contact.force[2], contact.accuracy
    assert force < 0.85 * film
    assert accuracy.force_error is not None
    assert accuracy.max_pressure_error is not None
    assert film / force - 1 < accuracy.force_error < 3 * (film / force - 1)
    assert film / force - 1 < accuracy.max_pressure_error
