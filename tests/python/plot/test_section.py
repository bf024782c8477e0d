"""The cut through a contact: how much of it is shown, and from where."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr
from quasirigid import plot
from shapes import AS_GIVEN, SKIN, ball

pytest.importorskip("matplotlib")

from quasirigid.plot.section import _section_window

# Of sizes and coarse meshes.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")

UP = [0.0, 0.0, 1.0]


def pressed_in_unit(surface: qr.Surface, factor: float) -> qr.Contact:
    """The finger pressed by a ball, all lengths times a factor."""
    skin = qr.Surface(factor * surface.vertices, surface.faces)
    product = qr.Obstacle.sphere(factor * np.array([0.0, 0.062, -0.03]), factor * 0.012)
    return qr.press(skin, product, SKIN, UP, depth=factor * 1e-3, options=AS_GIVEN)


def limits(contact: qr.Contact) -> list[float]:
    ax = plot.plot_section(contact)
    return [*ax.get_xlim(), *ax.get_ylim()]


@pytest.fixture(scope="module")
def finger() -> qr.Surface:
    return qr.models.finger(edge_length=2.5e-3)


@pytest.mark.parametrize("factor", [1e-6, 1e3])
def test_the_cut_shows_the_same_in_any_unit(finger: qr.Surface, factor: float) -> None:
    shown = limits(pressed_in_unit(finger, 1.0))
    assert limits(pressed_in_unit(finger, factor)) == pytest.approx(factor * np.array(shown), rel=1e-6)


def test_the_cut_shows_the_contact_of_a_long_finger_and_all_of_a_short_one(
    finger: qr.Surface, fingertip: qr.Surface
) -> None:
    long = pressed_in_unit(finger, 1.0)
    left, right, bottom, top = limits(long)
    assert right - left < 0.9e3 * np.ptp(finger.vertices[:, 1])
    along, _, up = 1e3 * long.center_of_pressure[[1, 0, 2]]
    assert left < along < right
    assert bottom < up < top
    thickness = 1e3 * np.ptp(finger.vertices[:, 2])
    assert along - left > 1.5 * thickness
    short = pressed_in_unit(fingertip.moved(translation=[0.0, 0.04, 0.0]), 1.0)
    left, right, *_ = limits(short)
    low, high = 1e3 * (fingertip.vertices[:, 1].min() + 0.04), 1e3 * (fingertip.vertices[:, 1].max() + 0.04)
    assert left < low < high < right


def test_a_cut_that_lies_apart_from_its_middle_is_shown_upright() -> None:
    points = np.array([[100.0, 5.0], [120.0, 9.0]])
    left, right, bottom, top = _section_window(points, np.array([0.0, 50.0]), 8.0)
    assert left < 100.0 < 108.0 < right < 120.0
    assert bottom < 5.0 < 9.0 < top


def test_a_cut_between_two_bodies_shows_where_they_are() -> None:
    vertices, faces = ball(8e-3, 2)
    both = (vertices + np.array([[-0.02, 0, 0], [0.02, 0, 0]])[:, None]).reshape(-1, 3)
    surface = qr.Surface(both, np.concatenate([faces, faces + len(vertices)]))
    floor = qr.Obstacle.half_space([0.0, 0.0, -1.0], UP)
    contact = qr.solve_contact(surface, floor, SKIN)
    view = plot.View.along(np.array(UP), np.array([0.0, 1.0, 0.0]))
    ax = plot.plot_section(contact, view=view)
    assert ax.get_xlim()[0] < -8.0 < 8.0 < ax.get_xlim()[1]


def test_a_needle_is_seen_from_where_it_comes(fingertip: qr.Surface) -> None:
    needle = qr.Obstacle.capsule([0.0, 0.02, -0.06], [0.0, 0.02, -0.03], 3e-4)
    contact = qr.press(fingertip, needle, SKIN, UP, depth=1.4e-3)
    # It went in by almost five times its radius, and still pushes back the way it came.
    assert contact.force[2] > 0.98 * np.linalg.norm(contact.force)
    assert plot.pad_view(contact).toward == pytest.approx([0.0, 0.0, -1.0])
    # The cut goes through the needle: its outline is that of 0.6 mm.
    ax = plot.plot_section(contact)
    outline = np.concatenate([line.vertices for line in ax.collections[1].get_paths()])
    assert 0.4 < np.ptp(outline[:, 0]) <= 0.61
