"""Units, scales and frames of the files that hands are read from."""

from __future__ import annotations

import base64
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from glb_files import glb_parts, glb_with
from hands import GLB, parts_of
from quasirigid.hand.rig.frames import uniform_frames
from shared_meshes import hand_file


@pytest.mark.parametrize(("unit", "length"), [("mm", "0.0002"), ("cm", "0.002"), ("inch", "0.005")])
def test_a_hand_in_another_unit_is_told(unit: Any, length: str) -> None:
    path = hand_file("makehuman_male_right_13k")
    with pytest.warns(qr.SizeWarning, match=rf"the hand is {length}\d* m long .* another unit"):
        qr.read_hand(path, unit=unit)


def test_joints_in_another_unit_than_the_skin_are_told(hand: qr.Hand) -> None:
    vertices, faces = hand.surface.vertices, hand.surface.faces
    # Joints in metres all lie in the wrist of a skin in millimetres.
    with pytest.raises(qr.HandError, match=r"mm inside the skin, .* same unit and frame"):
        qr.Hand(vertices * 1e3, faces, **parts_of(hand))
    with pytest.raises(qr.HandError, match=r"mm outside the skin .* same unit and frame"):
        qr.Hand(vertices * 1e-3, faces, **parts_of(hand))


@pytest.mark.parametrize("pose", ["flat", "relaxed", "cylinder"])
@pytest.mark.parametrize("quarter", [0, 1])
def test_a_hand_that_was_bound_bent_comes_back_from_its_file(tmp_path: Path, pose: str, quarter: int) -> None:
    made = qr.models.hand(edge_length=5e-3)
    for hand in (made, made.mirrored()):
        posed = hand.posed(pose)
        bound = qr.Hand(
            posed.surface.vertices,
            hand.surface.faces,
            **(parts_of(hand) | {"rest": posed.joints}),
            side=hand.side,
        )
        # As the file of another program, whose bones lead along x and whose backs look along y.
        turned = posed.joints.copy()
        if quarter:
            turned[:, :3, :3] = turned[:, :3, [1, 2, 0]]
        frames, side = uniform_frames(hand.joint_names, turned)
        assert side == hand.side
        cosines = np.einsum("jab,jab->jb", frames[:, :3, :3], posed.joints[:, :3, :3])
        assert cosines[1:].min() > (math.cos(0.3) if quarter else 1.0 - 1e-12)
        bound.save(tmp_path / "bound.glb")
        back = qr.read_hand(tmp_path / "bound.glb")
        # float32
        np.testing.assert_allclose(back.rest, bound.rest, atol=1e-6)
        assert (back.labels == bound.labels).all()


def test_scales_of_bind_matrices_and_nodes_count(tmp_path: Path) -> None:
    made = qr.models.hand(edge_length=5e-3)
    made.save(tmp_path / "hand.glb")
    described, binary = glb_parts(tmp_path / "hand.glb")

    def array(accessor: int, columns: int) -> np.ndarray:
        known = described["accessors"][accessor]
        view = described["bufferViews"][known["bufferView"]]
        start = view.get("byteOffset", 0) + known.get("byteOffset", 0)
        return np.frombuffer(binary, "<f4", known["count"] * columns, start).reshape(-1, columns)

    primitive = described["meshes"][0]["primitives"][0]
    array(primitive["attributes"]["POSITION"], 3)[:] *= 100.0
    inverse = array(described["skins"][0]["inverseBindMatrices"], 16).reshape(-1, 4, 4)
    inverse[:, :3, :3] *= 0.01
    described["buffers"] = [{"byteLength": len(binary), "uri": "hand%20of%20cm.bin"}]
    (tmp_path / "hand of cm.bin").write_bytes(binary)
    (tmp_path / "hand.gltf").write_text(json.dumps(described))
    np.testing.assert_allclose(
        qr.read_hand(tmp_path / "hand.gltf").surface.vertices, made.surface.vertices, atol=1e-7
    )
    # The same in metres once more: the skeleton hangs on a node that is a hundredth.
    inverse[:, :3, :3] *= 1e4
    inverse[:, 3, :3] *= 1e4
    array(primitive["attributes"]["POSITION"], 3)[:] *= 0.01
    inverse[:, 3, :3] *= 1e-2
    root = described["skins"][0]["joints"][0]
    described["nodes"].append({"scale": [0.01, 0.01, 0.01], "children": [root]})
    described["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(binary).decode()
    (tmp_path / "hand.gltf").write_text(json.dumps(described))
    np.testing.assert_allclose(
        qr.read_hand(tmp_path / "hand.gltf").surface.vertices, made.surface.vertices, atol=1e-7
    )


@pytest.mark.parametrize(
    "node",
    [
        {"scale": [-1, 1, 1]},
        {"scale": [1, 1, 3]},
        {"scale": [0, 0, 0]},
        {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]},
        {"matrix": [0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]},
    ],
)
def test_an_uneven_or_mirrored_scale_is_refused_by_its_node(tmp_path: Path, node: dict[str, Any]) -> None:
    with pytest.raises(qr.HandError, match=r"node 27 \('Holder'\) has an uneven or mirrored scale: apply it"):
        qr.read_hand(glb_on(node, tmp_path))


@pytest.mark.parametrize(
    "node", [{"scale": [2, 2, 2]}, {"matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 0, 0, 1]}]
)
def test_an_even_scale_counts(tmp_path: Path, node: dict[str, Any]) -> None:
    length = qr.read_hand(hand_file(GLB[1], ".glb")).length
    assert qr.read_hand(glb_on(node, tmp_path)).length == pytest.approx(2.0 * length)


def glb_on(node: dict[str, Any], folder: Path) -> Path:
    """Write the published hand, all of it on one more node."""

    def hang(description: dict[str, Any]) -> None:
        held = description["scenes"][0]["nodes"]
        description["nodes"].append({"name": "Holder", "children": held, **node})

    return glb_with(hang, folder)
