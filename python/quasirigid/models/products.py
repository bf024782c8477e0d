"""Smooth, closed products of simple form: handle, box, bottle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .._arrays import Floats, Indices
from .._check import as_length, as_vector
from ..errors import ObstacleError
from ..obstacle import Obstacle
from .loft import check_vertex_count, loft, ring_size, rows_along, spread_on_curve


def cylinder_handle(
    *, radius: float = 0.016, length: float = 0.110, edge_radius: float = 0.003, edge_length: float = 1e-3
) -> Obstacle:
    """Return a round bar along z with rounded rims.

    Parameters
    ----------
    radius, length : float
        Of the whole bar (m).
    edge_radius : float
        Of the rounding at both rims (m); at most the radius and half the length.
    edge_length : float
        Mean edge of the mesh (m); at most 1.25 edge radii. Facets lie up to ``edge_length**2 / 8 / radius``
        inside the round, which a fine skin mesh feels.

    Returns
    -------
    Obstacle
        A closed mesh, centered at the origin.

    Raises
    ------
    ObstacleError
        A length is not above 0, or they do not fit together.

    Examples
    --------
    >>> import quasirigid as qr
    >>> handle = qr.models.cylinder_handle(radius=0.012)
    >>> distance, _, _ = handle.signed_distance([[0.020, 0.0, 0.0]])
    >>> bool(abs(distance[0] - 0.008) < 1e-4)
    True
    """
    _check_lengths(radius=radius, length=length, edge_radius=edge_radius, edge_length=edge_length)
    if edge_radius > min(radius, 0.5 * length):
        raise ObstacleError(
            f"edge_radius is {edge_radius} m, expected at most the radius and half the length"
        )
    _check_edge_length(edge_length, edge_radius)
    foot = _foot(radius, edge_radius, 0.5 * length)
    return _obstacle(*_revolve(np.concatenate([foot, _mirrored(foot)]), edge_length))


def bottle(
    *,
    radius: float = 0.0325,
    height: float = 0.215,
    neck_radius: float = 0.014,
    neck_height: float = 0.030,
    edge_radius: float = 0.003,
    edge_length: float = 2e-3,
) -> Obstacle:
    """Return a standing bottle: body, shoulder and neck; by default about the size of a half-litre drink.

    Parameters
    ----------
    radius, height : float
        Of the whole bottle (m).
    neck_radius, neck_height : float
        Of the straight neck above the shoulder (m).
    edge_radius : float
        Of the rounding at foot and mouth (m).
    edge_length : float
        Mean edge of the mesh (m); at most 1.25 edge radii.

    Returns
    -------
    Obstacle
        A closed mesh about the z axis, its bounding box centered at the origin.

    Raises
    ------
    ObstacleError
        A length is not above 0, or they do not fit together.

    Examples
    --------
    >>> import quasirigid as qr
    >>> distance, _, _ = qr.models.bottle().signed_distance([[0.0, 0.0, 0.0], [0.0, 0.0, 0.2]])
    >>> bool(distance[0] < 0 < distance[1])
    True
    """
    _check_lengths(
        radius=radius,
        height=height,
        neck_radius=neck_radius,
        neck_height=neck_height,
        edge_radius=edge_radius,
        edge_length=edge_length,
    )
    if neck_radius > radius:
        raise ObstacleError(f"neck_radius is {neck_radius} m, expected at most the radius of {radius} m")
    shoulder = 1.6 * (radius - neck_radius)
    if height < 2.0 * edge_radius + shoulder + neck_height:
        raise ObstacleError(
            f"height is {height} m, expected at least {2.0 * edge_radius + shoulder + neck_height:.4g} m"
            " for rim, shoulder and neck"
        )
    if edge_radius > neck_radius:
        raise ObstacleError(
            f"edge_radius is {edge_radius} m, expected at most the neck_radius of {neck_radius} m"
        )
    _check_edge_length(edge_length, edge_radius)
    wave = np.linspace(0.0, 1.0, 80)
    shoulder_top = 0.5 * height - neck_height
    profile = np.concatenate(
        [
            _foot(radius, edge_radius, 0.5 * height),
            np.stack(
                [
                    radius + (neck_radius - radius) * 0.5 * (1 - np.cos(np.pi * wave)),
                    shoulder_top + shoulder * (wave - 1.0),
                ],
                axis=1,
            ),
            _mirrored(_foot(neck_radius, edge_radius, 0.5 * height)),
        ]
    )
    return _obstacle(*_revolve(profile, edge_length))


def _foot(radius: float, edge_radius: float, depth: float) -> Floats:
    """Return radius and height (41, 2) in m of a rounded foot at -depth, from the pole up."""
    quarter = np.linspace(0.0, 0.5 * np.pi, 40)
    radii, heights = radius - edge_radius * (1 - np.sin(quarter)), edge_radius * (1 - np.cos(quarter)) - depth
    return np.stack([np.append(0.0, radii), np.append(-depth, heights)], axis=1)


def _mirrored(profile: Floats) -> Floats:
    """Return a profile with top and bottom exchanged."""
    return profile[::-1] * [1.0, -1.0]


def _revolve(profile: Floats, edge_length: float) -> tuple[Floats, Indices]:
    """Return the mesh of a profile turned about the z axis.

    Parameters
    ----------
    profile : (k, 2) float64
        Radius and height (m), from the lower pole (radius 0) to the upper one (radius 0).
    edge_length : float
        Wanted length of the edges (m).
    """
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    check_vertex_count(2.0 * np.pi * float(profile[:, 0].max() * way[-1]), edge_length, ObstacleError)
    rows = max(2, rows_along(way[-1], edge_length))
    stations = np.arange(1, rows) / rows * way[-1]
    radii, heights = np.interp(stations, way, profile[:, 0]), np.interp(stations, way, profile[:, 1])
    rings = []
    for row, (radius, height) in enumerate(zip(radii, heights, strict=True)):

        def circle(angle: Floats, radius: float = radius, height: float = height) -> Floats:
            return np.stack(
                [radius * np.cos(angle), radius * np.sin(angle), np.full_like(angle, height)], axis=1
            )

        size = ring_size(2.0 * np.pi * radius, edge_length)
        rings.append(spread_on_curve(circle, size, row % 2 == 1))
    lower, upper = np.array([0.0, 0.0, profile[0, 1]]), np.array([0.0, 0.0, profile[-1, 1]])
    return loft(rings, lower, upper)


def rounded_box(
    *, size: Sequence[float] = (0.075, 0.150, 0.009), edge_radius: float = 0.003, edge_length: float = 1.5e-3
) -> Obstacle:
    """Return a box with rounded edges and corners; by default about the size of a mobile phone.

    Parameters
    ----------
    size : (3,) float
        Outer lengths along x, y and z (m).
    edge_radius : float
        Of all edges and corners (m); at most half the shortest side.
    edge_length : float
        Mean edge of the mesh (m); at most 1.25 edge radii. From half of one down the skin under an edge feels
        no facets; at a whole one the peak pressure is a third too high.

    Returns
    -------
    Obstacle
        A closed mesh, centered at the origin.

    Raises
    ------
    ObstacleError
        A length is not above 0, or they do not fit together.

    Examples
    --------
    >>> import quasirigid as qr
    >>> box = qr.models.rounded_box(size=(0.04, 0.04, 0.02))
    >>> distance, _, _ = box.signed_distance([[0.0, 0.0, 0.015]])
    >>> round(float(distance[0]), 6)
    0.005
    """
    sides = as_vector("size", size, ObstacleError)
    _check_lengths(
        size_x=float(sides[0]), size_y=float(sides[1]), size_z=float(sides[2]), edge_radius=edge_radius,
        edge_length=edge_length,
    )  # fmt: skip
    if 2.0 * edge_radius > sides.min():
        raise ObstacleError(
            f"edge_radius is {edge_radius} m, expected at most half the shortest side, {sides.min()} m"
        )
    _check_edge_length(edge_length, edge_radius)
    area = 2.0 * float(sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0])
    check_vertex_count(area, edge_length, ObstacleError)
    inner = 0.5 * sides - edge_radius
    # Each face is a grid; a grid point past the inner box is drawn back onto the rounding around it.
    axes = [_grid_line(float(half), edge_radius, edge_length) for half in inner]
    vertices, faces, count = [], [], 0
    for axis in range(3):
        # (axis, first, second) is right-handed, so first x second is the outward normal on the + side.
        first, second = (axis + 1) % 3, (axis + 2) % 3
        grid_u, grid_v = np.meshgrid(axes[first], axes[second], indexing="ij")
        columns, rows = grid_u.shape
        for side in (1.0, -1.0):
            points = np.empty((columns * rows, 3))
            points[:, axis] = side * (inner[axis] + edge_radius)
            points[:, first], points[:, second] = grid_u.ravel(), grid_v.ravel()
            vertices.append(points)
            faces.append(_grid_faces(columns, rows, side < 0.0) + count)
            count += len(points)
    grid = np.concatenate(vertices)
    # Neighbouring faces share their border points bit by bit, as all come from the same grid lines.
    unique, which = np.unique(grid, axis=0, return_inverse=True)
    kept = np.clip(unique, -inner, inner)
    outward = unique - kept
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    return _obstacle(kept + edge_radius * outward, which.reshape(-1)[np.concatenate(faces)])


def _obstacle(vertices: Floats, faces: Indices) -> Obstacle:
    # Nothing built here crosses itself, so the search for crossing faces is left out.
    return Obstacle.mesh(vertices, faces, check_crossings=False)


def _grid_line(half: float, edge_radius: float, edge_length: float) -> Floats:
    """Return grid coordinates (m) along one side: roundings in equal angles to 45 degrees, flat part."""
    bend = max(1, round(0.25 * np.pi * edge_radius / edge_length))
    rounding = edge_radius * np.tan(np.arange(1, bend + 1) / bend * 0.25 * np.pi)
    rounding[-1] = edge_radius
    flat = (
        np.linspace(-half, half, max(1, round(2.0 * half / edge_length)) + 1) if half > 0.0 else np.zeros(1)
    )
    return np.concatenate([-half - rounding[::-1], flat, half + rounding])


def _grid_faces(columns: int, rows: int, turned: bool) -> Indices:
    """Return two triangles a cell, diagonals towards the middle of the face, so corners are cut evenly."""
    u, v = (
        index.ravel() for index in np.meshgrid(np.arange(columns - 1), np.arange(rows - 1), indexing="ij")
    )
    a, b, c, d = u * rows + v, (u + 1) * rows + v, (u + 1) * rows + v + 1, u * rows + v + 1
    outwards = (2 * u < columns - 1) == (2 * v < rows - 1)
    rising = np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1)
    falling = np.stack([np.stack([a, b, d], axis=1), np.stack([b, c, d], axis=1)], axis=1)
    faces = np.where(outwards[:, None, None], rising, falling).reshape(-1, 3)
    return faces[:, ::-1] if turned else faces


def _check_lengths(**lengths: float) -> None:
    for name, value in lengths.items():
        as_length(name, value, ObstacleError)


def _check_edge_length(edge_length: float, edge_radius: float) -> None:
    # Beyond this the rounding would be cut into slivers or lost.
    if edge_length > 1.25 * edge_radius:
        raise ObstacleError(
            f"edge_length is {edge_length} m, expected at most 1.25 times the edge_radius of {edge_radius} m"
        )
