"""A hand from a GLB file with a skin."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..._check import short
from ...errors import HandError
from ...io.check import weld_equal
from ..bend import by_joint
from ..hand import Hand
from ..rig.frames import uniform_frames
from ..rig.joints import PARENTS, lacking
from ..rig.kinematics import inverse_motions
from ..rig.rotations import nearest_rotations
from .gltf import Gltf

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from ..._arrays import Floats

_SCALE_TOLERANCE = 1e-3  # of the entries of R'R - I: files store frames as float32


def read_glb(path: Path) -> Hand:
    """Return the hand of a GLB file at rest, where its inverse bind matrices place the joints."""
    file = Gltf(path)
    skins = file.objects("skins") if "skins" in file.description else []
    if len(skins) != 1:
        what = "export the mesh with its joints" if not skins else "export the hand alone"
        raise HandError(f"{path}: it has {len(skins)} skins, expected one: {what}")
    vertices, faces, joints, weights = _mesh(file)
    vertices, faces, joints, weights = _welded(path, vertices, faces, joints, weights)
    names = [str(file.description["nodes"][node].get("name", f"joint-{node}")) for node in _nodes(file)]
    missing = lacking(names)
    if missing:
        raise HandError(f"{path}: it has no {missing}")
    frames, scale = _bind_frames(file, len(names))
    vertices, frames[:, :3, 3] = scale * vertices, scale * frames[:, :3, 3]
    parents = _parents(file, names)
    rest, side = uniform_frames(names, frames)
    return Hand(
        vertices,
        faces,
        joint_names=names,
        parents=parents,
        rest=rest,
        joints=joints,
        weights=weights,
        side=side,
    )


def _nodes(file: Gltf) -> list[int]:
    """Return the nodes that are joints, each of them there."""
    nodes: list[int] = file.entry("skins", 0, "joints")
    if not isinstance(nodes, list):
        raise HandError(f"{file.path}: the joints of its skin are {short(nodes)}, no list")
    file.objects("nodes")
    for node in nodes:
        file.entry("nodes", node)
    return nodes


def _mesh(file: Gltf) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64], Floats]:
    """Return vertices, faces, joints and weights of the one mesh that the skin moves."""
    path = file.path
    skinned = [node for node in file.objects("nodes") if "skin" in node and "mesh" in node]
    if len(skinned) != 1:
        raise HandError(f"{path}: its skin moves {len(skinned)} meshes, expected one")
    joint_count = len(_nodes(file))
    primitives = file.objects("meshes", skinned[0]["mesh"], "primitives")
    if not primitives:
        raise HandError(f"{path}: its mesh has no parts")
    parts, start = [], 0
    for number, primitive in enumerate(primitives):
        if primitive.get("mode", 4) != 4 or "indices" not in primitive:
            raise HandError(f"{path}: part {number} of its mesh is no indexed triangles")
        attributes = primitive.get("attributes", {})
        if not isinstance(attributes, dict):
            raise HandError(f"{path}: part {number} of its mesh has attributes that are no object")
        for name in ("POSITION", "JOINTS_0", "WEIGHTS_0"):
            if name not in attributes:
                raise HandError(f"{path}: part {number} of its mesh has no {name}")
        sets = [at for at in range(8) if f"JOINTS_{at}" in attributes and f"WEIGHTS_{at}" in attributes]
        points = file.rows(attributes["POSITION"]).astype(np.float64)
        corners = file.rows(primitive["indices"]).astype(np.int64).ravel()
        if len(corners) % 3 or (len(corners) and corners.max() >= len(points)):
            raise HandError(f"{path}: part {number} of its mesh has faces of vertices that it has not")
        joints = np.hstack([file.rows(attributes[f"JOINTS_{at}"]) for at in sets]).astype(np.int64)
        weights = np.hstack([file.rows(attributes[f"WEIGHTS_{at}"]) for at in sets]).astype(np.float64)
        if len(points) != len(joints) or joints.shape != weights.shape:
            raise HandError(
                f"{path}: part {number} of its mesh has {len(points)} points, joints {joints.shape} and "
                f"weights {weights.shape}"
            )
        if not 0 <= joints.min(initial=0) <= joints.max(initial=0) < joint_count:
            raise HandError(
                f"{path}: part {number} of its mesh names joint {joints.max()}, but there are {joint_count}"
            )
        parts.append((points, corners.reshape(-1, 3) + start, joints, weights))
        start += len(points)
    if len({part[2].shape[1] for part in parts}) != 1:
        raise HandError(f"{path}: the parts of its mesh have different numbers of weights a point")
    points, faces, joints, weights = (np.concatenate(column) for column in zip(*parts, strict=True))
    return points, faces, joints, weights


def _welded(
    path: Path, vertices: Floats, faces: NDArray[np.int64], joints: NDArray[np.int64], weights: Floats
) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64], Floats]:
    """Return the mesh with bit-equal points as one, in the order of the first of each."""
    kept, number = weld_equal(vertices)
    first = kept[number]
    all_weights = by_joint(joints, weights, int(joints.max(initial=0)) + 1)
    differ = np.abs(all_weights - all_weights[first]).max(axis=1) > _SCALE_TOLERANCE
    if differ.any():
        vertex = int(np.flatnonzero(differ)[0])
        place = ", ".join(f"{value:.6g}" for value in vertices[vertex])
        raise HandError(
            f"{path}: the points {int(first[vertex])} and {vertex} at ({place}) m are one, but their "
            f"weights differ ({np.count_nonzero(differ)} such points)"
        )
    corners = number[faces]
    thin = (corners == np.roll(corners, 1, axis=1)).any(axis=1)
    used, corners = np.unique(corners[~thin], return_inverse=True)
    kept = kept[used]
    return vertices[kept], corners.reshape(-1, 3), joints[kept], weights[kept]


def _bind_frames(file: Gltf, count: int) -> tuple[Floats, float]:
    """Return the frames (J, 4, 4) of the joints where the mesh was bound to them, and metres in its unit."""
    path = file.path
    if "inverseBindMatrices" not in file.objects("skins")[0]:
        raise HandError(
            f"{path}: its skin has no inverse bind matrices, so the mesh stands in the frame of each joint: "
            "export the mesh as it was bound"
        )
    matrices = file.rows(file.entry("skins", 0, "inverseBindMatrices")).astype(np.float64)
    if matrices.shape != (count, 16) or not np.isfinite(matrices).all():
        raise HandError(
            f"{path}: its inverse bind matrices are {matrices.shape}, expected ({count}, 16), finite"
        )
    # Column by column in the file.
    inverse = matrices.reshape(count, 4, 4).transpose(0, 2, 1)
    scale = np.cbrt(np.abs(np.linalg.det(inverse[:, :3, :3])))
    turns, excess = nearest_rotations(inverse[:, :3, :3] / scale[:, None, None])
    if not (excess < _SCALE_TOLERANCE).all():
        joint = int(np.argmax(~(excess < _SCALE_TOLERANCE)))
        raise HandError(f"{path}: the bind matrix of joint {joint} shears or flattens")
    frames = np.tile(np.eye(4), (count, 1, 1))
    frames[:, :3, :3] = turns
    frames[:, :3, 3] = inverse[:, :3, 3] / scale[:, None]
    scales = scale * [_scale_of(file, node) for node in _nodes(file)]
    if not np.ptp(scales) <= _SCALE_TOLERANCE * scales.mean():
        raise HandError(
            f"{path}: its joints have scales of {scales.min():.6g} to {scales.max():.6g}, expected one: "
            "apply the scales before the export"
        )
    return inverse_motions(frames), float(scales.mean())


def _scale_of(file: Gltf, node: int) -> float:
    """Return the scale of a node in the scene, with those that it hangs on."""
    nodes, above = file.objects("nodes"), _holders(file)
    scale, at = 1.0, node
    while True:
        try:
            if "matrix" in nodes[at]:
                own = np.reshape(nodes[at]["matrix"], (4, 4))[:3, :3]
            else:
                own = np.diag(np.reshape(nodes[at].get("scale", (1.0, 1.0, 1.0)), 3))
            factor = np.cbrt(np.linalg.det(own))
            excess = np.abs(own @ own.T - factor**2 * np.eye(3)).max()
        except (TypeError, ValueError):
            raise HandError(f"{file.path}: {_named(nodes, at)} has no place: {short(nodes[at])}") from None
        if not (factor > 0.0 and excess <= _SCALE_TOLERANCE * factor**2):
            raise HandError(
                f"{file.path}: {_named(nodes, at)} has an uneven or mirrored scale: apply it in the program "
                "that wrote the file"
            )
        scale *= factor
        if at not in above:
            return float(scale)
        at = above[at]


def _parents(file: Gltf, names: list[str]) -> list[int]:
    """Return the parent of each joint: that of the file, else the root; between WebXR's may stand others."""
    nodes, above = _nodes(file), _holders(file)
    parents = [_joint_above(node, nodes, above) for node in nodes]
    of_file = parents.copy()
    for joint, name in enumerate(names):
        known = PARENTS.get(name)
        if known is None:
            continue
        first = of_file[joint]
        while first >= 0 and names[first] not in PARENTS:
            first = of_file[first]
        if first < 0 or names[first] != known:
            parents[joint] = names.index(known)
    root = names.index("wrist")
    for _ in names:
        root = parents[root] if parents[root] >= 0 else root
    return [root if at < 0 and joint != root else at for joint, at in enumerate(parents)]


def _joint_above(node: int, nodes: list[int], above: dict[int, int]) -> int:
    """Return the number of the joint that a node hangs on, with what is no joint between; -1 of none."""
    while node in above:
        node = above[node]
        if node in nodes:
            return nodes.index(node)
    return -1


def _holders(file: Gltf) -> dict[int, int]:
    """Return the node that each node hangs on: they are to be strict trees (glTF 2.0, 3.5.2)."""
    nodes = file.objects("nodes")
    above: dict[int, int] = {}
    for number, node in enumerate(nodes):
        children = node.get("children", [])
        if not isinstance(children, list):
            raise HandError(f"{file.path}: the children of node {number} are {short(children)}, no list")
        for child in children:
            file.entry("nodes", child)
            if child in above:
                raise HandError(
                    f"{file.path}: {_named(nodes, child)} hangs on two nodes, {_named(nodes, above[child])} "
                    f"and {_named(nodes, number)}: nodes are to form trees"
                )
            above[child] = number
    rooted: set[int] = set()
    for at in above:
        way: set[int] = set()
        while at in above and at not in rooted:
            if at in way:
                raise HandError(f"{file.path}: its nodes run in a circle through {_named(nodes, at)}")
            way.add(at)
            at = above[at]
        rooted |= way
    return above


def _named(nodes: list[Any], node: int) -> str:
    name = nodes[node].get("name")
    return f"node {node}" if name is None else f"node {node} ({name!r})"
