"""Even triangles on an implicit surface: split, collapse, flip, relax (Botsch and Kobbelt 2004).

Each pass changes edges that are out of each other's reach all at once, the worst first. Vertices stay on the
surface; those of the flat cut stay in its plane, those of its rim on the curve where the two meet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..._arrays import Floats, Indices, Mask
from ..._geometry import face_normals
from .contour import Distance
from .topology import Edges, best_of_all, edges_of, neighbours, pairs_of

__all__ = ["CUT", "RIM", "SKIN", "remeshed"]

SKIN, RIM, CUT = 0, 1, 2  # what a vertex lies on
LONG, SHORT = 4.0 / 3.0, 4.0 / 5.0  # edges beyond these are split or collapsed, over the edge length
SHARP = 0.75  # cosine: angles wider than this are left as they are
ROUNDS = 3
SPLITS, COLLAPSES, FLIPS = 8, 14, 5  # passes at the most
FEW = 1e-3  # of all edges: fewer changes end a pass


@dataclass(frozen=True)
class Body:
    """An implicit body that ends flat at y = `cut`."""

    distance: Distance
    cut: float
    step: float  # of difference quotients (m)

    def project(self, points: Floats, kinds: Indices, steps: int = 1) -> Floats:
        """Return the points moved onto what they lie on, by Newton's steps along the gradient."""
        points = points.copy()
        points[kinds != SKIN, 1] = self.cut
        off = np.flatnonzero(kinds != CUT)
        held = kinds[off] == RIM
        for _ in range(steps):
            distance = self.distance(points[off])
            ahead = [self.distance(points[off] + self.step * axis) for axis in np.eye(3)]
            gradient = np.stack([(value - distance) / self.step for value in ahead], axis=1)
            gradient[held, 1] = 0.0
            points[off] -= (distance / (gradient**2).sum(axis=1))[:, None] * gradient
        return points


@dataclass
class _Mesh:
    vertices: Floats
    faces: Indices
    on_cut: Mask
    edges: Edges
    kinds: Indices
    _corners: tuple[Indices, Indices] | None = None

    def renew(self) -> None:
        """Find edges and kinds again after faces changed."""
        count = len(self.vertices)
        self._corners = None
        self.edges = edges_of(self.faces, count)
        touches = np.zeros((2, count), dtype=bool)
        for side in (0, 1):
            touches[side, self.faces[self.on_cut == bool(side)].ravel()] = True
        self.kinds = np.where(touches.all(axis=0), RIM, np.where(touches[1], CUT, SKIN))

    def sharp(self) -> Mask:
        """Return which edges lie on the rim."""
        sides = self.on_cut[self.edges.faces]
        found: Mask = sides[:, 0] != sides[:, 1]
        return found

    def corners(self) -> tuple[Indices, Indices]:
        """Return where each vertex's corners begin (n + 1,) and the corners, 3 * face + place, in one row."""
        if self._corners is None:
            order = np.argsort(self.faces.ravel())
            self._corners = (
                np.searchsorted(self.faces.ravel()[order], np.arange(self.edges.count + 1)),
                order,
            )
        return self._corners

    def lengths(self) -> Floats:
        ends = self.vertices[self.edges.ends]
        found: Floats = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        return found


def remeshed(
    vertices: Floats, faces: Indices, on_cut: Mask, body: Body, edge_length: float
) -> tuple[Floats, Indices]:
    """Return vertices and faces of a mesh with edges near `edge_length` (m)."""
    mesh = _Mesh(vertices, faces, on_cut, edges_of(faces, len(vertices)), np.zeros(0, dtype=np.int64))
    mesh.renew()
    for number in range(ROUNDS):
        _collapse(mesh, SHORT * edge_length, LONG * edge_length)
        _split(mesh, LONG * edge_length, body)
        _flip(mesh, by_valence=number < ROUNDS - 1)
        for _ in range(2):
            _relax(mesh, body)
    # What is still short or sharp, most of it at the rim.
    _collapse(mesh, 0.6 * edge_length, 1.1 * LONG * edge_length)
    for _ in range(2):
        _flip(mesh, by_valence=False)
        _relax(mesh, body)
    mesh.vertices = body.project(mesh.vertices, mesh.kinds, steps=2)
    return mesh.vertices, mesh.faces


def _split(mesh: _Mesh, longest: float, body: Body) -> None:
    for _ in range(SPLITS):
        lengths, edges = mesh.lengths(), mesh.edges
        chosen = np.flatnonzero(lengths > longest)
        if len(chosen) == 0:
            return
        ranks = _ranks(-lengths[chosen])
        best = best_of_all(edges.faces[chosen], ranks, len(mesh.faces))
        chosen = chosen[(best[edges.faces[chosen]] == ranks[:, None]).all(axis=1)]
        ends, number = edges.ends[chosen], len(mesh.vertices) + np.arange(len(chosen))
        faces, both = mesh.faces.copy(), edges.faces[chosen]
        added, tags = [], []
        for side in (0, 1):
            face, third = both[:, side], edges.across[chosen, side]
            along = edges.forward[chosen] == (side == 0)
            start, end = np.where(along, ends.T, ends.T[::-1])
            faces[face] = np.stack([start, number, third], axis=1)
            added.append(np.stack([number, end, third], axis=1))
            tags.append(mesh.on_cut[face])
        mesh.vertices = np.concatenate([mesh.vertices, mesh.vertices[ends].mean(axis=1)])
        mesh.faces, mesh.on_cut = np.concatenate([faces, *added]), np.concatenate([mesh.on_cut, *tags])
        mesh.renew()
        mesh.vertices[number] = body.project(mesh.vertices[number], mesh.kinds[number])


def _collapse(mesh: _Mesh, shortest: float, longest: float) -> None:
    for _ in range(COLLAPSES):
        lengths, edges, kinds = mesh.lengths(), mesh.edges, mesh.kinds
        starts, around = neighbours(edges)
        valence = np.diff(starts)
        one, other = edges.ends.T
        rim_one, rim_other = kinds[one] == RIM, kinds[other] == RIM
        allowed = (lengths < shortest) & (mesh.sharp() | ~(rim_one & rim_other))
        allowed &= (valence[edges.across] > 4).all(axis=1) & (valence[one] + valence[other] <= 12)
        candidates = np.flatnonzero(allowed)
        # Onto the rim where one end lies there, else to the middle.
        share = np.where(rim_one == rim_other, 0.5, np.where(rim_other, 1.0, 0.0))
        for _ in range(3):
            chosen = _apart(edges, candidates, lengths)
            ends = edges.ends[chosen]
            places = mesh.vertices[ends[:, 0]]
            places = places + share[chosen, None] * (mesh.vertices[ends[:, 1]] - places)
            good = _keeps_shape(mesh, ends, places, starts, around, longest)
            if 2 * good.sum() > len(chosen):
                break
            candidates = np.setdiff1d(candidates, chosen[~good], assume_unique=True)
        if good.any():
            _merge(mesh, ends[good], places[good])
        if good.sum() < FEW * len(lengths):
            return


def _apart(edges: Edges, candidates: Indices, lengths: Floats) -> Indices:
    """Return the shortest of the candidates that are out of each other's reach."""
    ranks = _ranks(lengths[candidates])
    ends, across = edges.ends[candidates], edges.across[candidates]
    # No edge may join the ends of two, and no corner across be shared.
    claims = best_of_all(ends, ranks, edges.count)
    reach = claims.copy()
    np.minimum.at(reach, edges.ends[:, 0], claims[edges.ends[:, 1]])
    np.minimum.at(reach, edges.ends[:, 1], claims[edges.ends[:, 0]])
    corners = best_of_all(across, ranks, edges.count)
    free = (reach[ends] == ranks[:, None]).all(axis=1) & (corners[across] == ranks[:, None]).all(axis=1)
    kept: Indices = candidates[free]
    return kept


def _ranks(values: Floats) -> Indices:
    """Return each value's place in ascending order."""
    ranks = np.empty(len(values), dtype=np.int64)
    ranks[np.argsort(values, kind="stable")] = np.arange(len(values))
    return ranks


def _keeps_shape(
    mesh: _Mesh, ends: Indices, places: Floats, starts: Indices, around: Indices, longest: float
) -> Mask:
    """Return which collapses leave a manifold, no turned face and no long edge."""
    edges = mesh.edges
    rows, near = pairs_of(starts, around, ends[:, 0])
    shared = np.bincount(rows[edges.has(near, ends[rows, 1])], minlength=len(ends))
    good: Mask = shared == 2
    first, order = mesh.corners()
    for side in (0, 1):
        rows, near = pairs_of(starts, around, ends[:, side])
        far = np.linalg.norm(mesh.vertices[near] - places[rows], axis=1) > longest
        good[rows[far]] = False
        rows, face = pairs_of(first, order // 3, ends[:, side])
        keeps = ~(mesh.faces[face] == ends[rows, 1 - side][:, None]).any(axis=1)
        rows, face = rows[keeps], face[keeps]
        corners = mesh.vertices[mesh.faces[face]]
        before = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        corners = np.where(
            (mesh.faces[face] == ends[rows, side][:, None])[:, :, None], places[rows][:, None], corners
        )
        after = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        sizes = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
        # A sliver has no direction worth keeping.
        turned = ((before * after).sum(axis=1) < 0.3 * sizes) & (
            np.linalg.norm(before, axis=1) > 0.02 * longest**2
        )
        turned |= np.linalg.norm(after, axis=1) < 1e-3 * longest**2
        good[rows[turned]] = False
    return good


def _merge(mesh: _Mesh, ends: Indices, places: Floats) -> None:
    mesh.vertices[ends[:, 0]] = places
    target = np.arange(len(mesh.vertices))
    target[ends[:, 1]] = ends[:, 0]
    faces = target[mesh.faces]
    kept = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    used = np.ones(len(target), dtype=bool)
    used[ends[:, 1]] = False
    numbers = np.cumsum(used) - 1
    mesh.vertices = mesh.vertices[used]
    mesh.faces, mesh.on_cut = numbers[faces[kept]], mesh.on_cut[kept]
    mesh.renew()


def _flip(mesh: _Mesh, by_valence: bool) -> None:
    for _ in range(FLIPS):
        edges = mesh.edges
        a, b = edges.ends.T
        # c lies left of a -> b, d right.
        c, d = np.where(edges.forward, edges.across.T, edges.across.T[::-1])
        gain = _valence_gain(mesh, a, b, c, d) if by_valence else _angle_gain(mesh, a, b, c, d)
        hopeful = np.flatnonzero((gain > 1e-9) & ~mesh.sharp() & ~edges.has(c, d))
        a, b, c, d = a[hopeful], b[hopeful], c[hopeful], d[hopeful]
        v = mesh.vertices
        allowed = np.ones(len(hopeful), dtype=bool)
        old = np.cross(v[b] - v[a], v[c] - v[a]) + np.cross(v[d] - v[a], v[b] - v[a])
        for one, other, third in ((a, d, c), (d, b, c)):
            new = np.cross(v[other] - v[one], v[third] - v[one])
            allowed &= (new * old).sum(axis=1) > 0.5 * np.linalg.norm(new, axis=1) * np.linalg.norm(
                old, axis=1
            )
        if allowed.sum() <= FEW * len(gain):
            return
        corners, chosen = np.stack([a, b, c, d], axis=1)[allowed], hopeful[allowed]
        ranks = _ranks(-gain[chosen])
        free = (best_of_all(corners, ranks, edges.count)[corners] == ranks[:, None]).all(axis=1)
        pair, corners = edges.faces[chosen[free]], corners[free]
        mesh.faces[pair[:, 0]] = corners[:, [0, 3, 2]]
        mesh.faces[pair[:, 1]] = corners[:, [3, 1, 2]]
        mesh.renew()


def _valence_gain(mesh: _Mesh, a: Indices, b: Indices, c: Indices, d: Indices) -> Floats:
    """Return by how much a flip lessens the squared distance of the valences from 6, halved."""
    excess = np.bincount(mesh.edges.ends.ravel(), minlength=mesh.edges.count) - 6
    gain = (excess[a] + excess[b] - excess[c] - excess[d] - 2).astype(np.float64)
    return gain


def _angle_gain(mesh: _Mesh, a: Indices, b: Indices, c: Indices, d: Indices) -> Floats:
    """Return by how much (cosine) a flip opens the smallest of the six angles, where that is a sharp one."""
    before = _sharpest(mesh.vertices, *mesh.faces.T)[mesh.edges.faces].max(axis=1)
    sharp = np.flatnonzero(before > SHARP)
    one, other, left, right = a[sharp], b[sharp], c[sharp], d[sharp]
    after = _sharpest(mesh.vertices, one, right, left)
    after = np.maximum(after, _sharpest(mesh.vertices, right, other, left))
    gain = np.zeros(len(a))
    gain[sharp] = before[sharp] - after
    return gain


def _sharpest(vertices: Floats, a: Indices, b: Indices, c: Indices) -> Floats:
    """Return the largest cosine of the angles of triangles."""
    largest = np.full(len(a), -1.0)
    sides = [vertices[b] - vertices[a], vertices[c] - vertices[b], vertices[a] - vertices[c]]
    sizes = [np.linalg.norm(side, axis=1) for side in sides]
    for corner in range(3):
        product = sizes[corner] * sizes[corner - 1]
        cosine = -(sides[corner] * sides[corner - 1]).sum(axis=1) / np.maximum(product, 1e-300)
        largest = np.maximum(largest, cosine)
    return largest


def _relax(mesh: _Mesh, body: Body) -> None:
    """Move vertices towards the middle of their neighbours, along the surface."""
    edges, count = mesh.edges, mesh.edges.count
    sharp = mesh.sharp()
    a, b = edges.ends.T
    rim = mesh.kinds == RIM
    # Rim vertices look along the rim alone.
    to_a, to_b = ~rim[a] | sharp, ~rim[b] | sharp
    ends = np.concatenate([a[to_a], b[to_b]])
    others = mesh.vertices[np.concatenate([b[to_a], a[to_b]])]
    degree = np.bincount(ends, minlength=count)
    middle = _summed(ends, others, count) / degree[:, None]
    # Normals of the skin: the cut has no say at the rim.
    areas = np.where(mesh.on_cut[:, None], 0.0, face_normals(mesh.vertices, mesh.faces))
    normals = _summed(mesh.faces.T.ravel(), np.tile(areas, (3, 1)), count)
    normals[rim, 1] = 0.0
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    move = middle - mesh.vertices
    move[~rim] -= (move[~rim] * normals[~rim]).sum(axis=1)[:, None] * normals[~rim]
    places = mesh.vertices + 0.7 * move
    off = mesh.kinds != CUT
    places[off] -= body.distance(places[off])[:, None] * normals[off]
    mesh.vertices = places


def _summed(places: Indices, values: Floats, count: int) -> Floats:
    """Return the sums (count, 3) of rows at each place."""
    return np.stack([np.bincount(places, values[:, axis], count) for axis in range(3)], axis=1)
