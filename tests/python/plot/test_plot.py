"""Pictures: what is drawn where, and that every ending can be drawn."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes
from quasirigid import plot
from quasirigid._text import as_percent
from quasirigid.errors import MissingExtraError
from quasirigid.plot import section
from quasirigid.plot.outline import contact_side
from quasirigid.plot.raster import rasterise
from quasirigid.plot.section import cut_lines, polylines
from quasirigid.plot.shading import lit_skin
from quasirigid.plot.style import (
    color_bar,
    new_figure,
    pressure_colors,
    round_steps,
    scale_bar,
    window_around,
)
from quasirigid.plot.view import View
from shapes import AS_GIVEN, SKIN, ball

FRONT = View.along(np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0]))


def test_a_view_is_right_handed() -> None:
    view = View.along(np.array([0.0, 0.0, 2.0]), np.array([0.0, 1.0, 0.5]))
    assert view.toward == pytest.approx([0.0, 0.0, -1.0])
    assert view.up == pytest.approx([0.0, 1.0, 0.0])
    # Seen from below, with +y upwards, +x lies to the left.
    assert view.right == pytest.approx([-1.0, 0.0, 0.0])


def test_views_can_be_compared() -> None:
    assert FRONT == FRONT
    assert View.along([0, 0, -1], [0, 1, 0]) != FRONT


def test_the_nearest_triangle_is_seen_and_those_turned_away_are_not() -> None:
    corners = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    vertices = np.concatenate([np.column_stack([corners, np.full(3, height)]) for height in (0.0, 1.0, 2.0)])
    faces = np.array([[0, 1, 2], [3, 4, 5], [6, 8, 7]])
    frame = rasterise(FRONT.project(vertices), faces, (0.0, 4.0, 0.0, 4.0), 4, 4)
    assert set(frame.face.tolist()) == {1}
    # Middles of pixels below the long side, counted from the top row.
    assert frame.pixel.tolist() == [0, 4, 5, 8, 9, 10, 12, 13, 14, 15]


def test_values_are_interpolated_linearly_over_a_triangle() -> None:
    vertices = np.array([[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]])
    faces = np.array([[0, 1, 2]])
    frame = rasterise(FRONT.project(vertices), faces, (0.0, 8.0, 0.0, 8.0), 8, 8)
    rows, columns = np.divmod(frame.pixel, 8)
    x, y = columns + 0.5, 7.5 - rows
    assert frame.interpolate(faces, 3.0 * vertices[:, 0] - vertices[:, 1]) == pytest.approx(3.0 * x - y)


def test_the_picture_covers_the_area_of_the_mesh(pressed: qr.Contact) -> None:
    vertices, faces = pressed.deformed.vertices, pressed.deformed.faces
    projected = FRONT.project(vertices)
    low, high = projected.min(axis=0), projected.max(axis=0)
    frame = rasterise(projected, faces, (low[0], high[0], low[1], high[1]), 400, 600)
    a, b, c = (projected[faces[:, corner], :2] for corner in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    # A closed body without overhangs: its shadow is the sum over the faces that look up.
    shadow = areas[areas > 0.0].sum() / np.prod((high - low)[:2])
    assert len(frame.pixel) / 240_000 == pytest.approx(shadow, rel=5e-3)


def test_a_press_from_below_is_seen_from_below_with_the_tip_on_top(pressed: qr.Contact) -> None:
    view = plot.pad_view(pressed)
    assert view.toward == pytest.approx([0.0, 0.0, -1.0])
    assert view.up == pytest.approx([0.0, 1.0, 0.0])


def test_the_rim_of_a_hertz_contact_is_found_between_the_vertices() -> None:
    # p = sqrt(1 - r^2) inside, and outside the gap of a sphere on a half-space (Johnson 1985, section 3.4).
    step, radius = 0.2, 1.0
    across = np.arange(-10, 11) * step
    x, y = (grid.ravel() for grid in np.meshgrid(across, across, indexing="ij"))
    r = np.maximum(np.hypot(x, y), 1e-9)
    inside = r < radius
    pressure = np.where(inside, np.sqrt(np.maximum(1.0 - r**2, 0.0)), 0.0)
    far = np.maximum(r, radius)
    lift = ((2.0 - far**2) * np.arcsin(1.0 / far) + np.sqrt(far**2 - 1.0)) / np.pi
    gap = np.where(inside, 0.0, 0.5 * r**2 - 1.0 + lift)
    vertices = np.column_stack([x, y, np.zeros_like(x)])
    corner = np.arange(20)[:, None] * 21 + np.arange(20)
    faces = np.concatenate(
        [
            np.stack([corner, corner + 21, corner + 22], axis=-1).reshape(-1, 3),
            np.stack([corner, corner + 22, corner + 1], axis=-1).reshape(-1, 3),
        ]
    )
    side = contact_side(vertices, faces, pressure, gap)
    assert np.array_equal(side > 0.0, inside)
    crossing = polylines(cut_lines(faces, side, vertices[:, :2]))
    radii = np.hypot(*crossing[~np.isnan(crossing[:, 0])].T)
    # Half-way points would stray by half a step or more; the fit stays within a fifth of it.
    assert np.abs(radii - radius).max() < 0.2 * step


def test_a_cut_through_a_mesh_is_one_closed_line(pressed: qr.Contact) -> None:
    vertices, faces = pressed.deformed.vertices, pressed.deformed.faces
    line = polylines(cut_lines(faces, vertices[:, 0] - 1e-4, vertices[:, 1:]))
    assert np.isnan(line[:, 0]).sum() == 1
    assert line[0] == pytest.approx(line[-2])


def test_the_light_on_the_skin_is_the_same_in_any_unit(pressed: qr.Contact) -> None:
    vertices, faces = pressed.deformed.vertices, pressed.deformed.faces
    nothing = np.zeros(len(vertices))
    pictures = []
    for points in (vertices, 1e-12 * vertices):
        window = window_around(FRONT.project(points))
        pictures.append(lit_skin(points, faces, FRONT, nothing, nothing, pressure_colors(), window, 60))
    # Where rounding moves a rim by a pixel the colors differ, and nowhere else.
    same = np.isclose(*pictures, rtol=0.0, atol=1e-6).all(axis=2)
    assert same.mean() > 0.99


def test_no_power_of_ten_lies_on_the_label_of_an_axis(pressed: qr.Contact) -> None:
    for largest in (1e-9, 1e9):
        figure = new_figure((3.0, 3.0))
        ax = figure.subplots()
        color_bar(ax, pressure_colors(), largest, "pressure (kPa)")
        figure.draw_without_rendering()
        bar = figure.axes[1].xaxis
        assert bar.get_offset_text().get_text() == ""
        numbers = [label.get_text().replace("\N{MINUS SIGN}", "-") for label in bar.get_ticklabels()]
        assert 0.5 * largest < max(map(float, numbers)) <= 1.5 * largest


@pytest.mark.parametrize("largest", [0.03, 1.0, 7.3, 64.0, 950.0])
def test_levels_are_round_and_few(largest: float) -> None:
    steps = round_steps(largest)
    assert 3 <= len(steps) <= 9
    assert steps[-1] < largest


def test_every_panel_draws_into_the_axes_it_is_given(pressed: qr.Contact) -> None:
    figure = plot.contact_figure(pressed)
    ax = figure.axes[0]
    assert plot.plot_skin(pressed, ax=ax, pixels=60) is ax
    assert plot.plot_footprint(pressed, ax=ax) is ax
    assert plot.plot_section(pressed, ax=ax) is ax


def test_pictures_name_their_units(pressed: qr.Contact) -> None:
    figure = plot.footprint_figure(pressed)
    labels = [text for ax in figure.axes for text in (ax.get_xlabel(), ax.get_ylabel())]
    assert {"across (mm)", "along (mm)", "pressure (kPa)"} <= set(labels)
    force = float(np.linalg.norm(pressed.force))
    error = pressed.accuracy.force_error
    assert error is not None
    assert f"{force:.3g} N ± {as_percent(error, figures=1)}" in figure.get_suptitle()


@pytest.mark.filterwarnings("ignore::quasirigid.PenetrationWarning")
def test_a_picture_of_a_contact_on_an_edge_says_that_its_peak_is_unbounded(fingertip: qr.Surface) -> None:
    low = min(fingertip.vertices[fingertip.skin_mask], key=lambda vertex: vertex[2])
    box = qr.Obstacle.box([0.02, 0.01, 0.01]).moved(translation=low - [0.0, 0.01, 0.1])
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    contact = qr.press(fingertip, box, skin, [0.0, 0.0, 1.0], depth=1e-3)
    assert contact.accuracy.max_pressure_error == np.inf
    assert "infinite at an edge" in plot.footprint_figure(contact).get_suptitle()
    assert "infinite at an edge" in plot.comparison_figure({"edge": contact}).axes[0].get_title()


@pytest.mark.parametrize("ending", ["pressed", "apart", "unsolved"])
def test_every_ending_can_be_drawn(ending: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    contact = request.getfixturevalue(ending)
    plot.contact_figure(contact).savefig(tmp_path / "skin.png", dpi=40)
    plot.footprint_figure(contact).savefig(tmp_path / "footprint.png", dpi=40)
    assert (tmp_path / "skin.png").stat().st_size > 3000


def test_drawing_opens_no_window(pressed: qr.Contact) -> None:
    import matplotlib

    backend = matplotlib.get_backend()
    plot.footprint_figure(pressed)
    assert matplotlib.get_backend() == backend


def test_a_missing_matplotlib_is_named_with_its_remedy(
    pressed: qr.Contact, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'quasirigid\[plot\]'"):
        plot.footprint_figure(pressed)


def test_the_cut_goes_through_the_patch_with_the_largest_force(monkeypatch: pytest.MonkeyPatch) -> None:
    # Two balls side by side, the one at +x 0.5 mm deeper.
    vertices, faces = ball(8e-3, 3)
    apart = np.array([[-0.02, 0, 0], [0.02, 0, -0.5e-3]])
    both = (vertices + apart[:, None]).reshape(-1, 3)
    surface = qr.Surface(both, np.concatenate([faces, faces + len(vertices)]))
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    contact = qr.press(surface, qr.Obstacle.half_space([0, 0, -1], [0, 0, 1]), skin, [0, 0, 1], depth=1e-3)
    assert len(contact.patches) == 2
    centers = []
    cut = section._cut

    def noted(vertices: object, faces: object, center: np.ndarray, view: object) -> object:
        centers.append(center)
        return cut(vertices, faces, center, view)

    monkeypatch.setattr(section, "_cut", noted)
    lines = plot.plot_section(contact, view=FRONT).lines
    assert all(center[0] == pytest.approx(0.02, abs=1e-4) for center in centers)
    assert any(len(line.get_xdata()) > 2 for line in lines)


UP = [0.0, 0.0, 1.0]
FLOOR = qr.Obstacle.half_space([0, 0, -1], UP)


@pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")
@pytest.mark.parametrize("depth", [1e-6, 2e-5])
def test_a_contact_of_one_vertex_is_drawn_with_the_faces_around_it(
    fingertip: qr.Surface, depth: float, tmp_path: Path
) -> None:
    contact = qr.press(fingertip, FLOOR, SKIN, UP, depth=depth, options=AS_GIVEN)
    assert len(contact.active) in (1, 2)
    ax = plot.plot_footprint(contact)
    edge = 1e3 * fingertip.mean_edge_length
    assert ax.get_xlim()[1] - ax.get_xlim()[0] > 2 * edge
    contact.save(tmp_path, pictures=True)
    assert (tmp_path / "footprint.png").is_file()


@pytest.fixture(scope="module")
def pinched() -> qr.Contact:
    """Two balls between two plates: a box pushes up on the one, its other side down on the other."""
    vertices, faces = ball(8e-3, 3)
    both = np.concatenate([vertices, -vertices - [0, 0, 0.02]])
    turned = faces[:, ::-1]
    surface = qr.Surface(both, np.concatenate([faces, turned + len(vertices)]))
    plate = qr.Obstacle.box([0.02, 0.02, 0.0105]).moved(translation=[1e-3, 0, -0.01])
    return qr.solve_contact(surface, plate, SKIN, options=AS_GIVEN)


def texts(ax: Axes) -> list[str]:
    return [text.get_text() for text in ax.texts if text.get_text()]


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_patches_that_face_away_are_counted(pinched: qr.Contact) -> None:
    assert len(pinched.patches) == 2
    first, second = (patch.force for patch in pinched.patches)
    assert np.linalg.norm(first + second) < 0.5 * np.linalg.norm(first)
    largest = max((first, second), key=np.linalg.norm)
    assert plot.pad_view(pinched).toward == pytest.approx(-np.sign(largest[2]) * np.array(UP))
    (note,) = texts(plot.plot_footprint(pinched))
    hidden = min(float(np.linalg.norm(one)) for one in (first, second))
    words = re.fullmatch(r"1 of 2 patches not seen from here \((.*) N\)", note)
    assert words is not None
    assert float(words[1]) == pytest.approx(hidden, rel=0.06)


def test_a_contact_that_faces_away_is_said_to(pressed: qr.Contact) -> None:
    assert texts(plot.plot_footprint(pressed)) == []
    assert texts(plot.plot_footprint(pressed, view=View.along([0, 0, -1], [0, 1, 0]))) == [
        "not seen from here"
    ]


@pytest.mark.parametrize("size", [1e-5, 1e-3, 1.0, 40.0])
def test_a_scale_bar_fits_into_any_picture_and_leaves_its_limits(size: float) -> None:
    window = (0.0, 1e3 * size, 0.0, 1.5e3 * size)
    ax = new_figure((2.0, 3.0)).subplots()
    ax.imshow(np.zeros((3, 2)), extent=window)
    scale_bar(ax, window)
    assert (*ax.get_xlim(), *ax.get_ylim()) == window
    left, right = ax.lines[0].get_xdata()
    length = right - left
    assert 0.2 * 0.42 * window[1] < length <= 0.42 * window[1]
    assert f"{length:.0e}"[0] in "125"
    assert texts(ax) == [f"{length:g} mm"]


@pytest.mark.parametrize(
    ("draw", "error", "message"),
    [
        (
            lambda c: plot.plot_skin(c, show="foo"),
            qr.ContactError,
            'show is .foo., expected one of "pressure"',
        ),
        (lambda c: plot.plot_skin(c, pixels=0), qr.ContactError, "pixels is 0, expected an integer"),
        (
            lambda c: plot.plot_skin(c, pixels=10**7),
            qr.ContactError,
            r"pixels is 10000000, which makes a picture of .*e\+13 pixels, expected at most 5.0e\+06",
        ),
        (lambda c: plot.plot_skin(c, pixels=2.5), TypeError, "pixels is 2.5, expected an integer"),
        (lambda c: plot.plot_footprint(c, top=0), qr.ContactError, "top is 0, expected a number above 0"),
        (lambda c: plot.comparison_figure({}), qr.ContactError, "contacts is empty"),
        (lambda c: plot.comparison_figure([c]), TypeError, "contacts is a list, expected a mapping"),
        (lambda c: c.plot(bone=c.obstacle), TypeError, "bone is an Obstacle, expected a Surface"),
        (lambda c: View.along(UP, UP), qr.ContactError, "up is .*, along the sight"),
        (lambda c: View.along([0, 0, 0], UP), qr.ContactError, "sight is .*, expected a direction"),
        (
            lambda c: View(right=[1, 0, 0], up=[0, 0, 0], toward=[0, 0, 1]),
            qr.ContactError,
            r"right \[1, 0, 0\], up \[0, 0, 0\].*expected unit vectors",
        ),
        # Seen in a mirror.
        (lambda c: View(right=[-1, 0, 0], up=[0, 1, 0], toward=[0, 0, 1]), qr.ContactError, "right x up"),
        *(
            (
                lambda c, draw=draw: draw(c.surface),
                TypeError,
                "contact is a Surface, expected a Contact",
            )
            for draw in (
                plot.plot_footprint,
                plot.plot_section,
                plot.plot_skin,
                plot.pad_view,
                plot.contact_figure,
                plot.footprint_figure,
            )
        ),
        (lambda c: plot.plot_footprint(c, ax="x"), TypeError, "ax is the word 'x', expected an Axes"),
        *(
            (
                lambda c, draw=draw: draw(c, ax=new_figure((2.0, 2.0)).add_subplot(projection="3d")),
                TypeError,
                "ax is an Axes3D of projection '3d', expected flat axes",
            )
            for draw in (plot.plot_footprint, plot.plot_section, plot.plot_skin)
        ),
        (lambda c: plot.plot_skin(c, view=[0, 0, 1]), TypeError, "view is a list, expected a View"),
        (lambda c: plot.plot_skin(c, view="palm"), TypeError, "view is the word 'palm', expected a View"),
        (lambda c: plot.comparison_figure({"a": 1}), TypeError, r"contacts\['a'\] is an int"),
        (lambda c: plot.sweep_figure(c), TypeError, "sweep is a Contact, expected a Sweep"),
        (lambda c: plot.grasp_figure(c), TypeError, "grasp is a Contact, expected a Grasp"),
        (lambda c: plot.hand_figure(c), TypeError, r"hand is a Contact, expected a PosedHand: hand\.posed"),
        (lambda c: c.save("nowhere", inputs=[1]), TypeError, "inputs is a list, expected a mapping"),
    ],
)
def test_what_cannot_be_drawn_or_written_is_named(
    draw: Callable[[qr.Contact], object], error: type[Exception], message: str, pressed: qr.Contact
) -> None:
    with pytest.raises(error, match=message):
        draw(pressed)


def test_a_skin_of_any_shape_is_drawn_at_the_height_left_out(fingertip: qr.Surface) -> None:
    rod = qr.Surface(fingertip.vertices * [1e-2, 1.0, 1e-2], fingertip.faces)
    contact = qr.solve_contact(rod, FLOOR, SKIN)
    assert plot.plot_skin(contact, view=View.along(np.array(UP), np.array([1.0, 0.0, 0.0]))).images
