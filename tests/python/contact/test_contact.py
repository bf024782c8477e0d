"""Presses from Python: what comes back, and how failures look."""

from __future__ import annotations

import subprocess
import sys
import warnings
from functools import partial
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, ball, grid

SKIN = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
RADIUS, APPROACH = 0.2, 0.5e-3
MODULUS = qr.reference.contact_modulus(shear_modulus=60e3, poisson_ratio=0.5)
HERTZ = qr.reference.Hertz(radius=RADIUS, contact_modulus=MODULUS)
PLATE = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])


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
    assert {"first_touch", "signed_distance", "response", "lcp", "outcome"} == set(contact.timings)
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
    assert "skin_mask=" in contact.warnings[0].message


def test_the_response_matrix_is_what_the_contact_uses() -> None:
    surface = qr.Surface(*ball(8e-3, 4))
    contact = qr.press(surface, PLATE, SKIN, [0, 0, 2], depth=0.5e-3, options=AS_GIVEN)
    matrix = qr.response_matrix(surface, SKIN, contact.candidates)
    rise = matrix @ contact.node_force[contact.candidates]
    start = surface.vertices[contact.candidates, 2] - contact.travel
    # Entries hold to 1e-6 relative and are all positive.
    np.testing.assert_allclose(start + rise, contact.gap[contact.candidates], atol=2e-6 * rise.max())


def test_a_balanced_gaussian_keeps_volume_on_a_wide_flat_mesh() -> None:
    cells, spacing = 60, 1e-3
    surface = qr.Surface(*grid(cells, spacing))
    middle = (cells + 1) * cells // 2 + cells // 2
    response = qr.GaussianCorrected.balanced(width=10e-3, cutoff=15e-3)
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    volume = qr.net_volume(surface, skin, middle)
    # The mesh sums the kernel's peak and its jump at the cutoff with an error of spacing / cutoff.
    assert abs(volume.net) < 0.02 * volume.gross
    half_space = qr.net_volume(surface, SKIN, middle)
    assert half_space.net == pytest.approx(half_space.gross)


@pytest.mark.parametrize("cells", [44, 50, 60])
def test_an_incompressible_layer_keeps_volume_on_a_wide_flat_mesh(cells: int) -> None:
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.Layer(thickness=1e-3))
    surface = qr.Surface(*grid(cells, 1e-3))
    volume = qr.net_volume(surface, skin, (cells + 1) * cells // 2 + cells // 2)
    # The kernel fades as exp(-0.76 r / h): what lies beyond 22 thicknesses is some 2e-7 of all.
    assert abs(volume.net) < 1e-6 * volume.gross


def test_a_galerkin_layer_is_symmetric_and_positive_definite_up_to_its_border() -> None:
    surface = qr.Surface(*grid(6, 1e-3))
    nodes = np.arange(len(surface.vertices))
    response = qr.Layer(thickness=0.3e-3, discretization="galerkin")
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    matrix = qr.response_matrix(surface, skin, nodes)
    np.testing.assert_array_equal(matrix, matrix.T)
    assert np.linalg.eigvalsh(matrix)[0] > 0


def test_condition_and_definiteness_are_known_when_cheap_or_asked_for() -> None:
    surface = qr.Surface(*ball(8e-3, 4))
    small = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=0.2e-3, options=AS_GIVEN)
    assert len(small.candidates) <= 64
    assert small.accuracy.definite is True
    matrix = qr.response_matrix(surface, SKIN, small.candidates)
    assert small.accuracy.condition == pytest.approx(qr.definiteness(matrix).condition, rel=1e-4)
    asked = qr.press(
        surface, PLATE, SKIN, [0, 0, 1], depth=1.12e-3, options=qr.ContactOptions(condition=True)
    )
    assert len(asked.candidates) > 64
    assert asked.accuracy.condition is not None
    assert 1 < asked.accuracy.condition < 1e3
    assert asked.accuracy.definite is not None
    unasked = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=1.12e-3, options=AS_GIVEN)
    assert len(unasked.candidates) > 64
    assert (unasked.accuracy.condition, unasked.accuracy.definite) == (None, None)


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
    [([0, 0, 2], "2"), ([0, 0, 0], "0"), ([0.6, 0, 0.800002], "1.0000016"), ([0, np.nan, 1], "nan")],
)
def test_directions_that_are_not_unit_are_refused(
    fingertip: qr.Surface, direction: list[float], length: str
) -> None:
    expected = rf"^directions\[1\] has length {length}, expected a unit vector$"
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
    expected = f"^{name} is {least - below}, expected an integer of at least {least} "
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


@pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")
@pytest.mark.parametrize("away", [0.1, 1.0, 10.0, 1000.0])
def test_a_small_ball_from_afar_touches_where_a_near_one_does(fingertip: qr.Surface, away: float) -> None:
    x, y, z = fingertip.vertices[fingertip.vertices[:, 2].argmin()]
    near, far = (
        qr.press(
            fingertip,
            qr.Obstacle.sphere([x, y, z - start], 1e-5),
            SKIN,
            [0, 0, 1],
            depth=5e-6,
            options=AS_GIVEN,
        )
        for start in (1e-3, away)
    )
    # Coordinates are rounded by 1e-16 of the way, a share of the depth.
    share = 1e-15 * (1.0 + away) / 5e-6
    np.testing.assert_allclose(far.force, near.force, rtol=10 * share, atol=10 * share * near.force[2])
    np.testing.assert_allclose(far.travel - away, near.travel - 1e-3, atol=1e-15 * (1 + away))


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_thin_box_from_afar_presses_as_hard(fingertip: qr.Surface) -> None:
    forces = []
    for away in (0.1, 100.0):
        box = qr.Obstacle.box([0.02, 0.02, 1e-4]).moved(np.eye(3), [0, 0, -away])
        forces.append(qr.press(fingertip, box, SKIN, [0, 0, 1], depth=1e-3, options=AS_GIVEN).force[2])
    assert forces[1] == pytest.approx(forces[0], rel=1e-9)


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


def test_a_matrix_that_memory_does_not_hold_is_refused_before_it_is_made() -> None:
    # 202,500 vertices that all touch: 328 GB.
    side = np.arange(450) * 1e-3
    x, y = (axis.ravel() for axis in np.meshgrid(side, side))
    cell = (np.arange(449)[:, None] * 450 + np.arange(449)).ravel()
    low, high = [cell, cell + 1, cell + 451], [cell, cell + 451, cell + 450]
    faces = np.concatenate([np.column_stack(low), np.column_stack(high)])
    sheet = qr.Surface(np.column_stack([x, y, np.zeros(len(x))]), faces)
    plate = qr.Obstacle.half_space([0, 0, 1], [0, 0, -1])
    with pytest.raises(qr.ResponseError, match=r"over 202500 nodes needs 328050000000 bytes, more than"):
        qr.press(sheet, plate, SKIN, [0, 0, -1], depth=1e-3, options=AS_GIVEN)


# Poses at which a linearization puts all skin that was inside on the far side of the obstacle.
PASSED_BY = {
    "pin": (
        (2, qr.Obstacle.cylinder(1.51e-3, 1.01e-3), 2.64e-3),
        [[-0.105, -0.317, -0.943], [0.98, 0.128, -0.152], [0.169, -0.94, 0.297]],
        [-6.5e-4, -2.74e-3, -0.05],
    ),
    "disc": (
        (1, qr.Obstacle.cylinder(1.62e-3, 1.09e-3), 2.44e-3),
        [[0.0415, -0.419, 0.907], [0.35, 0.856, 0.38], [-0.936, 0.302, 0.182]],
        [6e-5, 3.1e-3, -0.05],
    ),
    "plate": (
        (1, qr.Obstacle.box([7.88e-3, 8.15e-3, 2.62e-4]), 4.61e-3),
        [[0.443, 0.872, 0.208], [-0.374, -0.0309, 0.927], [0.815, -0.488, 0.313]],
        [1.08e-3, -3.61e-3, -0.05],
    ),
}


@pytest.mark.parametrize("by", [qr.press, qr.solve_contact])
def test_a_ball_between_the_vertices_of_the_skin_is_felt_as_a_mesh_too(by: Any) -> None:
    flat = qr.Surface(*grid(6, 6e-3))
    # Over the middle of a triangle.
    middle = flat.vertices[flat.faces[len(flat.faces) // 2]].mean(axis=0)
    depth = 2e-4
    how = {"direction": [0, 0, -1], "depth": depth} if by is qr.press else {}
    forces = []
    for tip in (qr.Obstacle.mesh(*ball(1.5e-3, 4)), qr.Obstacle.sphere([0, 0, 1.5e-3], 1.5e-3)):
        placed = tip.moved(translation=middle - [0, 0, depth])
        contact = by(flat, placed, SKIN, **how)
        assert contact.status == "solved"
        forces.append(contact.force[2])
        apart = qr.solve_contact(flat, placed.moved(translation=[0, 0, 2 * depth]), SKIN, options=AS_GIVEN)
        assert (apart.status, apart.max_penetration_after, apart.warnings) == ("no_contact", 0.0, ())
    # Its facets lie within the ball by up to 1 % of the depth.
    assert forces[0] == pytest.approx(forces[1], rel=0.03)


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
@pytest.mark.parametrize(("scene", "turn", "place"), PASSED_BY.values(), ids=PASSED_BY.keys())
def test_skin_that_was_inside_is_not_let_through(
    scene: tuple[int, qr.Obstacle, float], turn: list[list[float]], place: list[float]
) -> None:
    subdivisions, obstacle, depth = scene
    left, _, right = np.linalg.svd(turn)
    obstacle = obstacle.moved(left @ right, place)
    surface = qr.Surface(*ball(8e-3, subdivisions))
    contact = qr.press(surface, obstacle, SKIN, [0, 0, 1], depth=depth, options=AS_GIVEN)
    assert contact.max_penetration_before > 0.0
    assert contact.force[2] > 0.0
    assert contact.candidates.size


def test_a_product_that_slid_past_the_skin_presses_no_more() -> None:
    surface = qr.Surface(*ball(8e-3, 4))
    center = surface.vertices.mean(axis=0)
    # 0.3 mm of overlap at the lowest point.
    start = qr.Obstacle.sphere(center + np.array([-30e-3, 0, -10.7e-3]), 3e-3)
    grazing = qr.press(surface, start, SKIN, [1, 0, 0], depth=3e-3)
    there = qr.solve_contact(surface, grazing.obstacle, SKIN)
    assert grazing.force[2] > 0.05
    np.testing.assert_allclose(grazing.force, there.force, rtol=1e-6, atol=1e-9)
    assert qr.press(surface, start, SKIN, [1, 0, 0], depth=6e-3).status == "no_contact"


@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")  # of skin beside the rim
@pytest.mark.filterwarnings("ignore::quasirigid.RefinementWarning")  # of the area, which ends at a sharp edge
def test_a_flat_face_that_leans_a_little_presses_as_one_that_does_not() -> None:
    rng = np.random.default_rng(1)
    vertices, faces = grid(60, 0.5e-3)
    inner = np.abs(vertices[:, :2]).max(axis=1) < 14.8e-3
    vertices[inner, :2] += rng.uniform(-1e-4, 1e-4, (inner.sum(), 2))
    surface = qr.Surface(vertices, faces)
    radius, depth = 5e-3, 0.2e-3
    punch = qr.Obstacle.cylinder(half_height=20e-3, radius=radius)
    for lean in (0.0, 1e-5, 1e-4):
        turned = np.array([[1, 0, lean], [0, 1, 0], [-lean, 0, 1]]) / np.sqrt([1 + lean**2, 1, 1 + lean**2])
        there = punch.moved(turned, [20e-3 * lean, 0, 20e-3 - depth])
        contact = qr.solve_contact(surface, there, SKIN)
        assert contact.accuracy.force_error is not None
        assert -contact.force[2] == pytest.approx(8 * 60e3 * radius * depth, rel=0.005)
        assert abs(contact.center_of_pressure[0]) < 0.1e-3


# Of the tip, between the vertices.
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
def test_a_blunt_tip_between_the_vertices_of_the_skin_touches_first() -> None:
    # Sneddon (1948): F = 2/pi E* tan(half angle) d^2
    sides, height, half = 100, 1e-3, np.tan(np.radians(89.5))
    around = 2 * np.pi * np.arange(sides) / sides
    rim = np.stack([half * np.cos(around), half * np.sin(around), np.ones(sides)], axis=1)
    corners = np.vstack([[0, 0, 0], height * rim, [0, 0, height]])
    pairs = [(1 + k, 1 + (k + 1) % sides) for k in range(sides)]
    faces = [t for a, b in pairs for t in ([0, b, a], [sides + 1, a, b])]
    cone = qr.Obstacle.mesh(corners, np.array(faces)).moved(None, [0.4e-3, 0.2e-3, 10e-3])
    vertices, flat = grid(30, 1.3e-3)
    depth = 5.8e-3 * np.pi / 2 / half
    contact = qr.press(qr.Surface(vertices, flat), cone, SKIN, [0, 0, -1], depth=depth, options=AS_GIVEN)
    assert contact.travel == pytest.approx(10e-3 + depth, rel=1e-12)


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


def test_penetration_left_beside_a_sharp_edge_is_told() -> None:
    half, third, sixth = np.sqrt([1 / 2, 1 / 3, 1 / 6])
    on_edge = [[1, 0, 0], [0, half, -half], [0, half, half]]
    on_corner = [[half, -half, 0], [sixth, sixth, -2 * sixth], [third, third, third]]
    shares = []
    for turn in (on_edge, on_corner):
        bar = qr.Obstacle.box([10e-3, 10e-3, 10e-3]).moved(turn, [2e-3, 1e-3, -50e-3])
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            contact = qr.press(qr.models.fingertip(), bar, SKIN, [0, 0, 1], depth=1.2e-3)
        shares.append(contact.max_penetration_after / contact.max_penetration_before)
        texts = [str(one.message) for one in told if one.category is qr.PenetrationWarning]
        assert (shares[-1] > 0.02) == any("still penetrates" in text for text in texts), (shares[-1], texts)
    assert min(shares) <= 0.02 < max(shares)
