"""Sweeps over depths and forces."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, SKIN, ball

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")

UP = [0.0, 0.0, 1.0]
PLATE = qr.Obstacle.half_space([0.0, 0.0, -0.05], UP)
FIGURES = ("normal_force", "contact_area", "max_pressure", "force_error", "area_error")


@pytest.fixture(scope="module")
def surface() -> qr.Surface:
    return qr.Surface(*ball(8e-3, 2))


def test_every_row_is_the_press_of_its_depth(surface: qr.Surface, by_depth: qr.Sweep) -> None:
    assert len(by_depth) == 3
    assert by_depth.status == ("solved", "no_contact", "solved")
    np.testing.assert_array_equal(by_depth.depth, [1e-3, 0.0, 0.4e-3])
    for step, depth in enumerate(by_depth.depth):
        contact = qr.press(surface, PLATE, SKIN, UP, depth=depth)
        np.testing.assert_array_equal(by_depth.force[step], contact.force)
        np.testing.assert_array_equal(by_depth.moment[step], contact.moment)
        assert by_depth.normal_force[step] == contact.force[2]
        assert by_depth.contact_area[step] == contact.contact_area
        assert by_depth.max_pressure[step] == contact.max_pressure
        for name in ("force_error", "area_error", "max_pressure_error"):
            known = getattr(contact.accuracy, name)
            np.testing.assert_equal(getattr(by_depth, name)[step], np.nan if known is None else known)
    assert (by_depth.seconds > 0.0).all()


def mesh_rounds(contact: qr.Contact) -> int:
    """Count the meshes that a contact was solved on."""
    return sum(one.kind == "mesh" for one in contact.refinements)


@pytest.fixture(scope="module")
def rising(surface: qr.Surface) -> qr.Sweep:
    """Small steps on a plate."""
    return qr.sweep(surface, PLATE, SKIN, UP, depths=np.linspace(0.3e-3, 1.2e-3, 19))


def test_small_steps_go_on_on_one_mesh(surface: qr.Surface, rising: qr.Sweep) -> None:
    contacts = list(rising)
    # The first begins on the given mesh; few others do, as the contact's radius doubles.
    assert mesh_rounds(contacts[0]) > 1
    assert sum(mesh_rounds(contact) == 1 for contact in contacts) >= len(contacts) // 2
    for contact, row in zip(contacts, rising.force, strict=True):
        np.testing.assert_array_equal(contact.force, row)
        assert len(contact.surface.vertices) == len(contact.gap)
        assert contact.given_vertex_count == len(surface.vertices)
        np.testing.assert_allclose(contact.force_vectors.sum(axis=0), contact.force, atol=1e-12)


def test_steps_are_those_of_presses_within_their_errors(surface: qr.Surface, rising: qr.Sweep) -> None:
    for step, depth in enumerate(rising.depth):
        contact = qr.press(surface, PLATE, SKIN, UP, depth=depth)
        off = abs(rising.normal_force[step] / contact.force[2] - 1.0)
        assert off <= rising.force_error[step] + contact.accuracy.force_error
        off = abs(rising.contact_area[step] / contact.contact_area - 1.0)
        assert off <= rising.area_error[step] + contact.accuracy.area_error
    assert (np.diff(rising.normal_force) > 0.0).all()
    assert (rising.force_error <= 0.02).all()
    assert (rising.area_error <= 0.02).all()


@pytest.mark.parametrize("response", [qr.HalfSpace(discretization="galerkin"), qr.Layer(thickness=4e-3)])
def test_other_kernels_go_on_too(surface: qr.Surface, response: qr.HalfSpace | qr.Layer) -> None:
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=response)
    depths = np.linspace(0.8e-3, 1e-3, 5)
    curve = qr.sweep(surface, PLATE, skin, UP, depths=depths)
    assert any(mesh_rounds(contact) == 1 for contact in curve)
    alone = [qr.press(surface, PLATE, skin, UP, depth=depth).force[2] for depth in depths]
    np.testing.assert_allclose(curve.normal_force, alone, rtol=0.02)


def test_a_spot_beside_the_contact_gets_cells_of_its_own() -> None:
    vertices, faces = ball(8e-3, 4)
    # A second crest, half a millimetre above the first and 6 mm beside it.
    crest = np.exp(-(((vertices[:, 0] - 6e-3) ** 2 + vertices[:, 1] ** 2) / 1.2e-3**2))
    low = vertices[:, 2] < 8e-3
    vertices[low, 2] -= 2.2e-3 * crest[low]
    surface = qr.Surface(vertices, faces)
    depths = np.linspace(0.3e-3, 1.6e-3, 27)
    curve = qr.sweep(surface, PLATE, SKIN, UP, depths=depths)
    contacts = [qr.press(surface, PLATE, SKIN, UP, depth=depth) for depth in depths]
    assert len(contacts[0].patches) < len(contacts[-1].patches)
    for contact, force, error in zip(contacts, curve.normal_force, curve.force_error, strict=True):
        assert abs(force / contact.force[2] - 1.0) <= error + contact.accuracy.force_error


@pytest.mark.filterwarnings("ignore::quasirigid.RefinementWarning")
# Of skin that hangs over the edge of the box.
@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
def test_a_mesh_taken_as_it_is_and_a_sharp_edge_begin_anew_each_step(surface: qr.Surface) -> None:
    options = qr.ContactOptions(target_error=None)
    depths = [0.5e-3, 0.52e-3]
    beside = qr.Obstacle.box([0.02, 0.02, 0.02]).moved(translation=[0.02, 0.0, -0.05])
    for obstacle, how in ((PLATE, options), (beside, None)):
        curve = qr.sweep(surface, obstacle, SKIN, UP, depths=depths, options=how)
        for step, depth in enumerate(depths):
            contact = qr.press(surface, obstacle, SKIN, UP, depth=depth, options=how)
            np.testing.assert_array_equal(curve.force[step], contact.force)


@pytest.mark.parametrize("direction", [[-0.1, 0.7, 0.9], [2.0, 3.0, 3.0], [3.0, 2.0, 3.0]])
def test_a_step_along_a_slanted_direction_is_its_press_to_the_bit(
    surface: qr.Surface, direction: list[float]
) -> None:
    options = qr.ContactOptions(target_error=None)
    given = np.array(direction)
    across = qr.Obstacle.half_space(-0.05 * given, given)
    curve = qr.sweep(surface, across, SKIN, given, depths=[1e-3], options=options)
    contact = qr.press(surface, across, SKIN, direction, depth=1e-3, options=options)
    np.testing.assert_array_equal(curve.force[0], contact.force)
    along = given / np.linalg.norm(given)
    np.testing.assert_allclose(curve.normal_force[0], contact.force @ along, rtol=1e-14)
    given[:] = 0.0
    np.testing.assert_array_equal(curve[0].force, contact.force)


def test_each_step_keeps_its_warnings(fingertip: qr.Surface) -> None:
    options = qr.ContactOptions(target_error=None)
    with pytest.warns(qr.QuasirigidWarning):
        curve = qr.sweep(fingertip, PLATE, SKIN, UP, depths=[0.0, 20e-3], options=options)
    assert curve.warnings[0] == ()
    assert qr.DepthWarning in [category for category, _ in curve.warnings[1]]


def test_a_step_is_solved_again_when_asked(by_depth: qr.Sweep) -> None:
    for step in (0, 2, -1):
        np.testing.assert_array_equal(by_depth[step].force, by_depth.force[step])
    assert [contact.status for contact in by_depth] == list(by_depth.status)
    for step in (3, -4):
        with pytest.raises(IndexError, match=rf"there is no step {step} in a sweep of 3 steps"):
            by_depth[step]
    wrong: Any
    for wrong in (slice(0, 1), 1.0, "1"):
        with pytest.raises(TypeError, match=r"step is .*, expected an integer"):
            by_depth[wrong]


def test_forces_are_found_one_by_one(surface: qr.Surface) -> None:
    forces = [2.0, 0.5, 0.52, 0.54]
    curve = qr.sweep(surface, PLATE, SKIN, UP, forces=forces)
    np.testing.assert_allclose(curve.normal_force, forces, rtol=1e-6)
    assert curve.depth[0] > curve.depth[3] > curve.depth[2] > curve.depth[1] > 0.0
    assert curve[1].depth == curve.depth[1]


def test_an_infinite_error_has_no_bar(by_depth: qr.Sweep) -> None:
    pytest.importorskip("matplotlib")
    unknown = np.array([np.nan, np.nan, np.inf])
    curve = replace(by_depth, force_error=unknown, area_error=unknown)
    for ax, values in zip(curve.plot().axes, (curve.normal_force, 1e6 * curve.contact_area), strict=True):
        assert values.max() < ax.get_ylim()[1] < 1.2 * values.max()


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")  # of the step out of reach
def test_a_bad_step_is_nan_and_the_rest_goes_on(surface: qr.Surface) -> None:
    small = qr.Obstacle.sphere([0.0, 0.0, -0.05], 1e-3)
    options = qr.ContactOptions(target_error=None)
    curve = qr.sweep(surface, small, SKIN, UP, forces=[0.1, 1e3, 0.2], options=options)
    assert curve.status == ("solved", "not_reached", "solved")
    for name in ("depth", "force", "moment", *FIGURES):
        assert np.isnan(getattr(curve, name)[1]).all()
        assert np.isfinite(getattr(curve, name)[[0, 2]]).all()
    with pytest.raises(qr.ContactError, match="not reached") as caught:
        curve[1]
    assert curve.messages == ("", str(caught.value), "")
    assert pickle.loads(pickle.dumps(curve)).messages == curve.messages
    columns = qr.io.sweep_columns(curve)
    assert (columns["status"], columns["message"]) == (list(curve.status), list(curve.messages))
    # What was asked stands beside the figures, which the step has none of.
    for asked in (curve.asked, columns["asked_force (N)"]):
        np.testing.assert_array_equal(asked, [0.1, 1e3, 0.2])


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")  # of the step out of reach
def test_an_iterator_goes_on_after_a_force_out_of_reach(surface: qr.Surface) -> None:
    small = qr.Obstacle.sphere([0.0, 0.0, -0.05], 1e-3)
    curve = qr.sweep(surface, small, SKIN, UP, forces=[0.1, 1e3, 0.2], options=AS_GIVEN)
    contacts = iter(curve)
    np.testing.assert_array_equal(next(contacts).force, curve.force[0])
    with pytest.raises(qr.ContactError, match="not reached"):
        next(contacts)
    np.testing.assert_array_equal(next(contacts).force, curve.force[2])
    assert list(contacts) == []


def test_a_step_out_of_reach_warns_once(surface: qr.Surface) -> None:
    plate = qr.Obstacle.box([4e-3, 4e-3, 4e-3]).moved(translation=[0.0, 0.0, -0.05])
    with pytest.warns(qr.QuasirigidWarning) as caught:
        curve = qr.sweep(surface, plate, SKIN, UP, forces=[1e3, 0.01], options=AS_GIVEN)
    assert curve.status[0] == "not_reached"
    told = [str(one.message) for one in caught]
    expected = [message for step in curve.warnings for _, message in step]
    assert curve.warnings[0]
    assert told == expected


def test_a_step_that_the_response_refuses_says_why(surface: qr.Surface) -> None:
    low = np.flatnonzero(surface.vertices[:, 2] < 1e-3)
    options = qr.ContactOptions(target_error=None)
    curve = qr.sweep(surface, PLATE, SKIN.prepared(surface, low), UP, depths=[0.5e-3, 4e-3], options=options)
    assert curve.status == ("solved", "refused")
    assert curve.messages[0] == ""
    assert f"prepared for {len(low)} other vertices" in curve.messages[1]


@pytest.mark.filterwarnings("ignore:.*not well posed:quasirigid.QuasirigidWarning")
def test_a_bad_ending_is_nan_with_its_status(fingertip: qr.Surface) -> None:
    response = qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3)
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    curve = qr.sweep(fingertip, PLATE, skin, UP, depths=[2e-3, 0.1e-3])
    assert curve.status[0] not in ("solved", "no_contact")
    assert curve.status[1] == "solved"
    assert curve.messages == (curve[0].advice, "")
    assert curve.messages[0].startswith(curve.status[0])
    np.testing.assert_array_equal(np.isnan(curve.normal_force), [True, False])
    np.testing.assert_array_equal(curve.depth, [2e-3, 0.1e-3])


def test_progress_counts_the_steps(surface: qr.Surface, capsys: pytest.CaptureFixture[str]) -> None:
    seen: list[tuple[int, int]] = []
    depths = [1e-4, 2e-4]
    qr.sweep(surface, PLATE, SKIN, UP, depths=depths, progress=lambda *at: seen.append(at))
    assert seen == [(1, 2), (2, 2)]
    qr.sweep(surface, PLATE, SKIN, UP, depths=depths, progress=True)
    assert capsys.readouterr().err == "1 of 2 presses\n2 of 2 presses\n"
    with pytest.raises(TypeError, match="progress is 3"):
        qr.sweep(surface, PLATE, SKIN, UP, depths=depths, progress=3)  # type: ignore[arg-type]


def test_bad_questions_are_named(surface: qr.Surface) -> None:
    def ask(**goal: object) -> None:
        qr.sweep(surface, PLATE, SKIN, UP, **goal)  # type: ignore[arg-type]

    with pytest.raises(qr.ContactError, match="given: neither"):
        ask()
    with pytest.raises(qr.ContactError, match="given: both"):
        ask(depths=[1e-3], forces=[1.0])
    with pytest.raises(qr.ContactError, match=r"depths\[1\] is -1.0"):
        ask(depths=[0.0, -1.0])
    with pytest.raises(qr.ContactError, match=r"forces\[0\] is 0.0"):
        ask(forces=[0.0])
    for empty in ([], 1e-3, [[1e-3]], "deep", [10**400]):
        with pytest.raises(qr.ContactError, match="expected a row of numbers"):
            ask(depths=empty)
    beside = qr.Obstacle.sphere([1.0, 0.0, 0.0], 1e-3)
    with pytest.raises(qr.ContactError, match="never meets the skin"):
        qr.sweep(surface, beside, SKIN, UP, depths=[1e-3, 2e-3])


def test_a_sweep_is_frozen_and_pickles(by_depth: qr.Sweep) -> None:
    with pytest.raises(ValueError, match="read-only"):
        by_depth.force[0] = 0.0
    again = pickle.loads(pickle.dumps(by_depth))
    np.testing.assert_array_equal(again.force, by_depth.force)
    assert again.status == by_depth.status
    assert repr(by_depth).startswith("Sweep(3 steps, 3 with figures, up to ")


def test_a_sweep_becomes_a_data_frame(by_depth: qr.Sweep) -> None:
    pytest.importorskip("pandas")
    frame = by_depth.to_dataframe()
    assert len(frame) == 3
    np.testing.assert_array_equal(frame["depth (m)"], by_depth.depth)
    np.testing.assert_array_equal(frame["force_z (N)"], by_depth.force[:, 2])
    assert list(frame["status"]) == list(by_depth.status)
    assert list(frame["message"]) == [""] * 3


def test_a_sweep_is_drawn_over_its_depth(by_depth: qr.Sweep) -> None:
    pytest.importorskip("matplotlib")
    axes = by_depth.plot().axes
    assert [ax.get_ylabel() for ax in axes] == ["force along the press (N)", "contact area (mm²)"]
    # In the order of the depths, in mm.
    np.testing.assert_allclose(axes[0].lines[0].get_xdata(), [0.0, 0.4, 1.0])
    np.testing.assert_allclose(axes[0].lines[0].get_ydata(), by_depth.normal_force[[1, 2, 0]])


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")  # of the step out of reach
def test_steps_that_are_not_drawn_are_counted(surface: qr.Surface, by_depth: qr.Sweep) -> None:
    pytest.importorskip("matplotlib")
    small = qr.Obstacle.sphere([0.0, 0.0, -0.05], 1e-3)
    curve = qr.sweep(surface, small, SKIN, UP, forces=[0.1, 1e3, 0.2], options=AS_GIVEN)
    assert curve.plot().get_suptitle() == "1 of 3 steps without figures are not drawn"
    assert by_depth.plot().get_suptitle() == ""
