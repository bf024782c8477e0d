"""The built-in fingers and products: closed, outward, well shaped, of the size asked for."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from numpy.typing import NDArray
from quasirigid._geometry import sides_of
from quasirigid.errors import ObstacleError, SurfaceError
from quasirigid.models import bottle, cylinder_handle, finger, fingertip, rounded_box
from shapes import Mesh

FINGERS = {
    "fingertip": lambda: fingertip(edge_length=1.2e-3),
    "fine fingertip": lambda: fingertip(edge_length=0.5e-3),
    "coarse fingertip": lambda: fingertip(edge_length=4e-3),
    "finger": lambda: finger(edge_length=1.85e-3),
    "small finger": lambda: finger(length=0.060, breadth=0.014, depth=0.012, edge_length=1.5e-3),
    "deep finger": lambda: finger(length=0.085, breadth=0.022, depth=0.021, edge_length=1.2e-3),
}
PRODUCTS = {
    "handle": lambda: cylinder_handle(edge_length=2.5e-3),
    "disc": lambda: cylinder_handle(radius=0.030, length=0.010, edge_radius=0.005, edge_length=2e-3),
    "box": rounded_box,
    "coarse box": lambda: rounded_box(edge_length=3.75e-3),
    "ball": lambda: rounded_box(size=(0.02, 0.02, 0.02), edge_radius=0.010, edge_length=2e-3),
    "bottle": lambda: bottle(edge_length=3e-3),
}


def triangles(product: qr.Obstacle) -> Mesh:
    found = product.triangles()
    assert found is not None
    return found


def smallest_angle(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> float:
    """In degrees."""
    corners = vertices[faces]
    angles = []
    for corner in range(3):
        one = corners[:, (corner + 1) % 3] - corners[:, corner]
        other = corners[:, (corner + 2) % 3] - corners[:, corner]
        cosine = (one * other).sum(axis=1) / np.linalg.norm(one, axis=1) / np.linalg.norm(other, axis=1)
        angles.append(np.degrees(np.arccos(cosine)))
    return float(np.min(angles))


def volume(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> float:
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def assert_closed_sphere(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> None:
    """Each edge once in either direction, every vertex used, as many pieces as a sphere has."""
    edges = sides_of(faces)
    keys = edges[:, 0] * len(vertices) + edges[:, 1]
    turned = edges[:, 1] * len(vertices) + edges[:, 0]
    assert len(np.unique(keys)) == len(keys)
    assert np.array_equal(np.sort(keys), np.sort(turned))
    assert np.array_equal(np.unique(faces), np.arange(len(vertices)))
    assert len(vertices) - len(keys) // 2 + len(faces) == 2


@pytest.mark.parametrize("build", FINGERS.values(), ids=FINGERS.keys())
def test_a_finger_is_closed_outward_and_free_of_slivers(build: Callable[[], qr.Surface]) -> None:
    vertices, faces = build().vertices, build().faces
    assert_closed_sphere(vertices, faces)
    assert volume(vertices, faces) > 0.0
    assert smallest_angle(vertices, faces) > 28.0


@pytest.mark.parametrize("build", PRODUCTS.values(), ids=PRODUCTS.keys())
def test_a_product_is_closed_outward_and_free_of_slivers(build: Callable[[], qr.Obstacle]) -> None:
    vertices, faces = triangles(build())
    assert_closed_sphere(vertices, faces)
    assert volume(vertices, faces) > 0.0
    assert smallest_angle(vertices, faces) > 28.0


def test_a_finger_has_the_length_and_breadth_asked_for() -> None:
    vertices = finger(edge_length=0.5e-3).vertices
    assert vertices[:, 1].min() == 0.0
    assert vertices[:, 1].max() == pytest.approx(0.076, rel=1e-12)
    at_joint = np.abs(vertices[:, 1] - (0.076 - 0.0213)) < 0.5e-3
    # The section's widest points lie up to half an edge off a vertex.
    assert np.ptp(vertices[at_joint, 0]) == pytest.approx(0.018, rel=0.02)


def test_the_pad_hangs_to_minus_z_and_the_joints_are_thicker_than_their_neighbours() -> None:
    vertices = finger(edge_length=0.5e-3).vertices

    def breadth(from_tip: float) -> float:
        return float(np.ptp(vertices[np.abs(vertices[:, 1] - (0.076 - from_tip)) < 0.5e-3, 0]))

    distal = vertices[vertices[:, 1] > 0.060]
    assert -distal[:, 2].min() > distal[:, 2].max()
    assert breadth(0.0476) > max(breadth(0.0345), breadth(0.062))
    # Men's PIP and DIP joints are about 22.5 and 20 mm broad (Greiner 1991).
    assert breadth(0.0476) / breadth(0.0213) == pytest.approx(22.5 / 20.0, abs=0.05)


@pytest.mark.parametrize("edge_length", [0.6e-3, 1.2e-3, 2.4e-3])
def test_edges_are_as_long_as_asked(edge_length: float) -> None:
    built = finger(edge_length=edge_length)
    ends = built.vertices[built.faces[:, :2]]
    edges = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    assert edges.mean() == pytest.approx(edge_length, rel=0.05)
    assert edges.max() < 1.6 * edge_length


def test_the_volume_settles_with_the_square_of_the_edge_length() -> None:
    volumes = [fingertip(edge_length=edge).volume for edge in (2e-3, 1e-3, 0.25e-3)]
    coarse, fine = abs(volumes[0] - volumes[2]), abs(volumes[1] - volumes[2])
    assert coarse / fine == pytest.approx(4.0, rel=0.35)


def test_fifty_thousand_vertices_take_less_than_a_second() -> None:
    start = time.process_time()
    assert len(finger(edge_length=0.32e-3).vertices) > 50_000
    assert time.process_time() - start < 1.0


def test_round_products_have_their_exact_volume_in_the_limit() -> None:
    # Bar with rims rounded by r: cylinder less the ring that the rounding cuts off (Pappus).
    radius, length, rim = 0.016, 0.110, 0.003
    corner = (1.0 - np.pi / 4.0) * rim**2
    # Centroid of the cut-off corner, from the rim inwards: r (10 - 3 pi) / (12 - 3 pi).
    inwards = rim * (10.0 - 3.0 * np.pi) / (12.0 - 3.0 * np.pi)
    exact = np.pi * radius**2 * length - 2.0 * corner * 2.0 * np.pi * (radius - inwards)
    handle = cylinder_handle(radius=radius, length=length, edge_radius=rim, edge_length=0.5e-3)
    # Inscribed polygons of edge h lose about h^2 / (4 r^2) of the volume.
    assert volume(*triangles(handle)) == pytest.approx(exact, rel=1e-3)


def test_a_rounded_box_has_its_exact_volume_in_the_limit() -> None:
    # Steiner: inner box, slabs on its faces, quarter cylinders on its edges, eighths of a ball at corners.
    sides, radius = np.array([0.04, 0.05, 0.02]), 0.004
    x, y, z = sides - 2.0 * radius
    exact = (
        x * y * z
        + 2 * radius * (x * y + y * z + z * x)
        + np.pi * radius**2 * (x + y + z)
        + 4 / 3 * np.pi * radius**3
    )
    vertices, faces = triangles(rounded_box(size=tuple(sides), edge_radius=radius, edge_length=0.5e-3))
    # Twelve chords a quarter turn lose 0.3 % of the roundings, which are a ninth of the whole.
    assert volume(vertices, faces) == pytest.approx(exact, rel=4e-4)
    assert np.ptp(vertices, axis=0) == pytest.approx(sides, rel=1e-12)


def test_the_public_models_are_accepted_as_skin_and_product() -> None:
    for skin in (fingertip(), finger()):
        assert skin.is_closed
        cut = ~qr.skin_without_caps(skin)
        assert np.array_equal(cut, skin.vertices[:, 1] == 0.0)
    for product in (cylinder_handle(), rounded_box(), bottle()):
        distance, _, _ = product.signed_distance([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
        assert distance[0] < 0.0 < distance[1]


def test_products_do_not_cross_themselves() -> None:
    for build in PRODUCTS.values():
        qr.Obstacle.mesh(*triangles(build()), check_crossings=True)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"length": -0.03}, "length is -0.03 m"),
        ({"breadth": float("nan")}, "breadth is nan m"),
        ({"depth": 0.0}, "depth is 0.0 m"),
        ({"edge_length": 0.0}, "edge_length is 0.0 m"),
        ({"length": 0.01}, "at least 0.8 times the breadth"),
        ({"edge_length": 6e-3}, "at most a quarter"),
    ],
)
def test_a_finger_that_cannot_be_is_refused(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(SurfaceError, match=message):
        fingertip(**arguments)


def test_a_product_that_cannot_be_is_refused() -> None:
    with pytest.raises(ObstacleError, match=r"edge_radius is 0\.02 m"):
        cylinder_handle(edge_radius=0.020)
    with pytest.raises(ObstacleError, match=r"edge_length is 0\.01 m"):
        rounded_box(edge_length=0.010)
    with pytest.raises(ObstacleError, match=r"size is \(0\.075, 0\.15\), expected three"):
        rounded_box(size=(0.075, 0.150))
    with pytest.raises(ObstacleError, match=r"neck_radius is 0\.04 m"):
        bottle(neck_radius=0.04)
    with pytest.raises(ObstacleError, match=r"height is 0\.05 m"):
        bottle(height=0.05)


def test_lengths_in_millimetres_ask_for_no_memory() -> None:
    with pytest.raises(qr.ObstacleError, match=r"edge_length is 0\.0015 m, which makes some .* vertices"):
        qr.models.rounded_box(size=(75, 150, 9))
    with pytest.raises(qr.ObstacleError, match="check that every length is in m"):
        qr.models.cylinder_handle(radius=16, length=110)
    with pytest.raises(qr.ObstacleError, match="check that every length is in m"):
        qr.models.bottle(radius=32, height=215)
    with pytest.raises(qr.SurfaceError, match="check that every length is in m"):
        qr.models.finger(length=76, breadth=18)


@pytest.mark.parametrize("value", ["x", [1, 2], 10**400, np.nan, -1.0])
def test_what_is_no_length_is_named(value: Any) -> None:
    with pytest.raises(qr.SurfaceError, match=r"edge_length is .*, expected a length above 0"):
        qr.models.fingertip(edge_length=value)
    with pytest.raises(qr.ObstacleError, match=r"edge_radius is .*, expected a length above 0"):
        qr.models.cylinder_handle(edge_radius=value)
    with pytest.raises(qr.ObstacleError, match=r"size.* is .*, expected"):
        qr.models.rounded_box(size=(0.01, 0.01, value))
