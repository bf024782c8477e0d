"""A hand as GLB: skin, joints and weights; of a contact, pressure and the deformed skin."""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from ..._check import as_path
from ...errors import HandError
from ...io.atomic import atomic_write
from ...io.check import check_float32
from ..bend import shares_of
from ..rig.kinematics import inverse_motions

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    from ..._arrays import Floats
    from ...contact.result import Contact
    from ..hand import Hand

_UNLOADED, _LOADED = np.array([0.87, 0.68, 0.57]), np.array([0.70, 0.05, 0.10])  # linear RGB
_WEIGHTS_A_SET = 4
_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_COMPONENTS = {"float32": 5126, "uint16": 5123, "uint32": 5125}
_TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


def save_glb(hand: Hand, path: str | PathLike[str], contact: Contact | None) -> None:
    """Write a hand at rest, as `Hand.save` describes."""
    file = as_path("path", path)
    if file.suffix.lower() != ".glb":
        raise HandError(f"{file}: the ending is '{file.suffix}', expected .glb")
    vertices, faces = hand.surface.vertices, hand.surface.faces
    weights = shares_of(hand)
    attributes: dict[str, NDArray[Any]] = {}
    pressed: dict[str, NDArray[Any]] = {}
    if contact is not None:
        vertices, faces, weights = _on_mesh_of(contact, hand, weights)
        attributes = {"COLOR_0": _colors(contact.pressure), "_PRESSURE": contact.pressure[:, None]}
        pressed = {"POSITION": contact.deformed.vertices - vertices}
    check_float32(vertices, faces, str(file), "move the hand to the origin first")
    joints, shares = _sets(weights)
    attributes["POSITION"] = vertices
    if contact is None:
        attributes["NORMAL"] = hand.surface.vertex_normals
    for at in range(0, joints.shape[1], _WEIGHTS_A_SET):
        attributes[f"JOINTS_{at // _WEIGHTS_A_SET}"] = joints[:, at : at + _WEIGHTS_A_SET]
        attributes[f"WEIGHTS_{at // _WEIGHTS_A_SET}"] = shares[:, at : at + _WEIGHTS_A_SET]
    with atomic_write(file) as stream:
        stream.write(_file(hand, attributes, pressed, faces))


def _on_mesh_of(contact: Contact, hand: Hand, weights: Floats) -> tuple[Floats, NDArray[np.int64], Floats]:
    """Return vertices at rest, faces and weights on the mesh that was solved."""
    given = contact.given_vertex_count
    if given != len(weights):
        raise HandError(f"the contact is of a skin of {given} vertices, the hand has {len(weights)}")
    vertices = np.vstack([hand.surface.vertices, np.zeros((len(contact.parents), 3))])
    weights = np.vstack([weights, np.zeros((len(contact.parents), weights.shape[1]))])
    # An added vertex lies between its parents, which come before it.
    for row, (a, b) in enumerate(contact.parents, start=given):
        vertices[row] = 0.5 * (vertices[a] + vertices[b])
        weights[row] = 0.5 * (weights[a] + weights[b])
    return vertices, contact.surface.faces, weights


def _sets(weights: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Return joints and weights (n, 4 k), the largest first, all that are not 0."""
    most = max(int((weights > 0.0).sum(axis=1).max()), 1)
    columns = -(-most // _WEIGHTS_A_SET) * _WEIGHTS_A_SET
    padded = np.pad(weights, ((0, 0), (0, max(columns - weights.shape[1], 0))))
    joints = np.argsort(-padded, axis=1, kind="stable")[:, :columns]
    shares = np.take_along_axis(padded, joints, axis=1)
    joints[shares == 0.0] = 0
    return joints, shares


def _colors(pressure: Floats) -> Floats:
    """Return colors (n, 3): skin without pressure, red at the largest."""
    largest = float(pressure.max(initial=0.0))
    share = pressure[:, None] / largest if largest > 0.0 else np.zeros((len(pressure), 1))
    colors: Floats = _UNLOADED + np.sqrt(share) * (_LOADED - _UNLOADED)
    return colors


class _Buffers:
    """Arrays one after the other, with what describes them."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, rows: NDArray[Any], kind: str, target: int | None = None, bounds: bool = False) -> int:
        """Append rows (n, k) and return the number of their accessor."""
        stored = np.ascontiguousarray(rows, dtype=np.dtype(kind).newbyteorder("<"))
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.data), "byteLength": stored.nbytes}
        if target is not None:
            view["target"] = target
        self.data += stored.tobytes()
        self.data += b"\0" * (-len(self.data) % 4)
        accessor = {
            "bufferView": len(self.views),
            "componentType": _COMPONENTS[kind],
            "count": len(stored),
            "type": _TYPES[stored.shape[1]],
        }
        if bounds:
            accessor |= {"min": stored.min(axis=0).tolist(), "max": stored.max(axis=0).tolist()}
        self.views.append(view)
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def packed(self, description: dict[str, Any]) -> bytes:
        """Return a GLB file of the arrays and the objects that are made of them."""
        description = description | {
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.data)}],
        }
        text = json.dumps(description, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = b"".join(
            struct.pack("<I4s", len(chunk), kind) + chunk
            for kind, chunk in ((b"JSON", text), (b"BIN\0", self.data))
        )
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _file(
    hand: Hand,
    attributes: dict[str, NDArray[Any]],
    pressed: dict[str, NDArray[Any]],
    faces: NDArray[np.int64],
) -> bytes:
    """Return the bytes of the file."""
    buffers = _Buffers()

    def added(arrays: dict[str, NDArray[Any]]) -> dict[str, int]:
        def kind(name: str) -> str:
            return "uint16" if name.startswith("JOINTS") else "float32"

        return {
            name: buffers.add(rows, kind(name), _ARRAY_BUFFER, bounds=name == "POSITION")
            for name, rows in arrays.items()
        }

    primitive: dict[str, Any] = {
        "attributes": added(attributes),
        "indices": buffers.add(faces.reshape(-1, 1), "uint32", _ELEMENT_BUFFER),
        "material": 0,
    }
    mesh: dict[str, Any] = {"name": "skin", "primitives": [primitive]}
    if pressed:
        primitive["targets"] = [added(pressed)]
        mesh |= {"weights": [0.0], "extras": {"targetNames": ["pressed"]}}
    inverse = inverse_motions(hand.rest).transpose(0, 2, 1).reshape(-1, 16)
    count = len(hand.joint_names)
    roots = [joint for joint in range(count) if hand.parents[joint] < 0]
    skin = {
        "inverseBindMatrices": buffers.add(inverse, "float32"),
        "joints": list(range(count)),
        "name": "hand",
    }
    color = [1.0, 1.0, 1.0] if "COLOR_0" in attributes else _UNLOADED.tolist()
    surface = {"baseColorFactor": [*color, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.6}
    return buffers.packed(
        {
            "asset": {"version": "2.0", "generator": "quasirigid"},
            "scene": 0,
            "scenes": [{"nodes": [*roots, count]}],
            "nodes": [*_joint_nodes(hand), {"name": "skin", "mesh": 0, "skin": 0}],
            "meshes": [mesh],
            "skins": [skin],
            "materials": [{"pbrMetallicRoughness": surface}],
        }
    )


def _joint_nodes(hand: Hand) -> list[dict[str, Any]]:
    """Return a node for each joint, placed in the frame of its parent."""
    inverse = inverse_motions(hand.rest)
    nodes: list[dict[str, Any]] = []
    for joint, name in enumerate(hand.joint_names):
        parent = int(hand.parents[joint])
        local = hand.rest[joint] if parent < 0 else inverse[parent] @ hand.rest[joint]
        node: dict[str, Any] = {"name": name, "matrix": local.T.ravel().tolist()}
        children = np.flatnonzero(hand.parents == joint).tolist()
        if children:
            node["children"] = children
        nodes.append(node)
    return nodes
