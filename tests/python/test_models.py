"""The built-in fingers and products: closed, outward, well shaped, of the size asked for."""

from __future__ import annotations

import time

import numpy as np
import pytest
import quasirigid as qr
from numpy.typing import NDArray
from quasirigid.errors import ObstacleError, SurfaceError
from quasirigid.models.fingers import build_finger
from quasirigid.models.products import build_bottle, build_cylinder_handle, build_rounded_box

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]

FINGERS = {
    "fingertip": (0.030, 0.018, None, 1.2e-3, 1.0),
    "fine fingertip": (0.030, 0.018, None, 0.5e-3, 1.0),
    "coarse fingertip": (0.030, 0.018, None, 4e-3, 1.0),
    "finger": (0.076, 0.018, None, 1.85e-3, 1.0),
    "small finger": (0.060, 0.014, 0.012, 1.5e-3, 0.79),
    "deep finger": (0.085, 0.022, 0.021, 1.2e-3, 1.12),
}
PRODUCTS = {
    "handle": lambda: build_cylinder_handle(0.016, 0.110, 0.003, 2.5e-3),
    "disc": lambda: build_cylinder_handle(0.030, 0.010, 0.005, 2e-3),
    "box": lambda: build_rounded_box((0.075, 0.150, 0.009), 0.003, 2.5e-3),
    "coarse box": lambda: build_rounded_box((0.075, 0.150, 0.009), 0.003, 3.75e-3),
    "ball": lambda: build_rounded_box((0.02, 0.02, 0.02), 0.010, 2e-3),
    "bottle": lambda: build_bottle(0.0325, 0.215, 0.014, 0.030, 0.003, 3e-3),
}


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
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys = edges[:, 0] * len(vertices) + edges[:, 1]
    turned = edges[:, 1] * len(vertices) + edges[:, 0]
    assert len(np.unique(keys)) == len(keys)
    assert np.array_equal(np.sort(keys), np.sort(turned))
    assert np.array_equal(np.unique(faces), np.arange(len(vertices)))
    assert len(vertices) - len(keys) // 2 + len(faces) == 2


@pytest.mark.parametrize("size", FINGERS.values(), ids=FINGERS.keys())
def test_a_finger_is_closed_outward_and_free_of_slivers(
    size: tuple[float, float, float | None, float, float],
) -> None:
    vertices, faces = build_finger(*size)
    assert_closed_sphere(vertices, faces)
    assert volume(vertices, faces) > 0.0
    assert smallest_angle(vertices, faces) > 28.0


@pytest.mark.parametrize("build", PRODUCTS.values(), ids=PRODUCTS.keys())
def test_a_product_is_closed_outward_and_free_of_slivers(build: object) -> None:
    assert callable(build)
    vertices, faces = build()
    assert_closed_sphere(vertices, faces)
    assert volume(vertices, faces) > 0.0
    assert smallest_angle(vertices, faces) > 28.0


def test_a_finger_has_the_length_and_breadth_asked_for() -> None:
    vertices, _ = build_finger(0.076, 0.018, None, 0.5e-3, 1.0)
    assert vertices[:, 1].min() == 0.0
    assert vertices[:, 1].max() == pytest.approx(0.076, rel=1e-12)
    at_joint = np.abs(vertices[:, 1] - (0.076 - 0.0213)) < 0.5e-3
    # The section's widest points lie up to half an edge off a vertex.
    assert np.ptp(vertices[at_joint, 0]) == pytest.approx(0.018, rel=0.02)


def test_the_pad_hangs_to_minus_z_and_the_joints_are_thicker_than_their_neighbours() -> None:
    vertices, _ = build_finger(0.076, 0.018, None, 0.5e-3, 1.0)

    def breadth(from_tip: float) -> float:
        return float(np.ptp(vertices[np.abs(vertices[:, 1] - (0.076 - from_tip)) < 0.5e-3, 0]))

    distal = vertices[vertices[:, 1] > 0.060]
    assert -distal[:, 2].min() > distal[:, 2].max()
    assert breadth(0.0476) > max(breadth(0.0345), breadth(0.062))
    # Men's PIP and DIP joints are about 22.5 and 20 mm broad (Greiner 1991).
    assert breadth(0.0476) / breadth(0.0213) == pytest.approx(22.5 / 20.0, abs=0.05)


@pytest.mark.parametrize("edge_length", [0.6e-3, 1.2e-3, 2.4e-3])
def test_edges_are_as_long_as_asked(edge_length: float) -> None:
    vertices, faces = build_finger(0.076, 0.018, None, edge_length, 1.0)
    edges = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1)
    assert edges.mean() == pytest.approx(edge_length, rel=0.05)
    assert edges.max() < 1.6 * edge_length


def test_the_volume_settles_with_the_square_of_the_edge_length() -> None:
    volumes = [volume(*build_finger(0.030, 0.018, None, edge, 1.0)) for edge in (2e-3, 1e-3, 0.25e-3)]
    coarse, fine = abs(volumes[0] - volumes[2]), abs(volumes[1] - volumes[2])
    assert coarse / fine == pytest.approx(4.0, rel=0.35)


def test_fifty_thousand_vertices_take_less_than_a_second() -> None:
    start = time.process_time()
    vertices, _ = build_finger(0.076, 0.018, None, 0.32e-3, 1.0)
    assert len(vertices) > 50_000
    assert time.process_time() - start < 1.0


def test_round_products_have_their_exact_volume_in_the_limit() -> None:
    # Bar with rims rounded by r: cylinder less the ring that the rounding cuts off (Pappus).
    radius, length, rim = 0.016, 0.110, 0.003
    corner = (1.0 - np.pi / 4.0) * rim**2
    # Centroid of the cut-off corner, from the rim inwards: r (10 - 3 pi) / (12 - 3 pi).
    inwards = rim * (10.0 - 3.0 * np.pi) / (12.0 - 3.0 * np.pi)
    exact = np.pi * radius**2 * length - 2.0 * corner * 2.0 * np.pi * (radius - inwards)
    # Inscribed polygons of edge h lose about h^2 / (4 r^2) of the volume.
    assert volume(*build_cylinder_handle(radius, length, rim, 0.5e-3)) == pytest.approx(exact, rel=1e-3)


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
    vertices, faces = build_rounded_box(sides, radius, 0.5e-3)
    # Twelve chords a quarter turn lose 0.3 % of the roundings, which are a ninth of the whole.
    assert volume(vertices, faces) == pytest.approx(exact, rel=4e-4)
    assert np.ptp(vertices, axis=0) == pytest.approx(sides, rel=1e-12)


def test_the_public_models_are_accepted_as_skin_and_product() -> None:
    for finger in (qr.models.fingertip(), qr.models.finger()):
        assert finger.is_closed
        cut = ~qr.flat_cap_mask(finger)
        assert np.array_equal(cut, finger.vertices[:, 1] == 0.0)
    for product in (qr.models.cylinder_handle(), qr.models.rounded_box(), qr.models.bottle()):
        distance, _, _ = product.signed_distance([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
        assert distance[0] < 0.0 < distance[1]


def test_products_do_not_cross_themselves() -> None:
    for build in PRODUCTS.values():
        qr.Obstacle.mesh(*build(), check_crossings=True)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((-0.03, 0.018, None, 1e-3, 1.0), "length is -0.03 m"),
        ((0.03, float("nan"), None, 1e-3, 1.0), "breadth is nan m"),
        ((0.03, 0.018, 0.0, 1e-3, 1.0), "depth is 0.0 m"),
        ((0.03, 0.018, None, 0.0, 1.0), "edge_length is 0.0 m"),
        ((0.01, 0.018, None, 1e-3, 1.0), "at least 0.8 times the breadth"),
        ((0.03, 0.018, None, 6e-3, 1.0), "at most a quarter"),
    ],
)
def test_a_finger_that_cannot_be_is_refused(arguments: tuple[float, ...], message: str) -> None:
    with pytest.raises(SurfaceError, match=message):
        build_finger(*arguments)


def test_a_product_that_cannot_be_is_refused() -> None:
    with pytest.raises(ObstacleError, match=r"edge_radius is 0\.02 m"):
        build_cylinder_handle(0.016, 0.110, 0.020, 2.5e-3)
    with pytest.raises(ObstacleError, match=r"edge_length is 0\.01 m"):
        build_rounded_box((0.075, 0.150, 0.009), 0.003, 0.010)
    with pytest.raises(ObstacleError, match="size has shape"):
        build_rounded_box((0.075, 0.150), 0.003, 0.002)
    with pytest.raises(ObstacleError, match=r"neck_radius is 0\.04 m"):
        build_bottle(0.03, 0.2, 0.04, 0.03, 0.003, 0.003)
    with pytest.raises(ObstacleError, match=r"height is 0\.05 m"):
        build_bottle(0.03, 0.05, 0.014, 0.03, 0.003, 0.003)
