"""Hands as GLB and glTF files: read, written, and refused by what is wrong."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from glb_files import glb_parts, glb_with
from hands import GLB, parts_of
from quasirigid.errors import MeshFileError
from shared_meshes import hand_file


@pytest.fixture(scope="module", params=GLB)
def from_glb(request: pytest.FixtureRequest) -> qr.Hand:
    return qr.read_hand(hand_file(request.param, ".glb"))


def test_a_glb_hand_is_read_with_its_side(from_glb: qr.Hand, request: pytest.FixtureRequest) -> None:
    assert from_glb.side == request.node.callspec.params["from_glb"].rsplit("_", 1)[1]
    assert len(from_glb.surface.vertices) == 1159  # its 1,360 points without texture seams
    assert from_glb.surface.volume == pytest.approx(343.2e-6, rel=1e-3)
    distal = from_glb.frame_of("wrist")[:3, 1]
    fist, flat = from_glb.posed("fist"), from_glb.posed("flat")
    tip = from_glb.joint_names.index("middle-finger-tip")
    assert fist.joints[tip, :3, 3] @ distal < flat.joints[tip, :3, 3] @ distal - 0.05


def test_a_saved_hand_is_read_back(hand: qr.Hand, tmp_path: Path) -> None:
    path = tmp_path / "hand.glb"
    hand.save(path)
    again = qr.read_hand(path)
    assert again.side == hand.side
    order = [again.joint_names.index(name) for name in hand.joint_names]
    np.testing.assert_allclose(again.surface.vertices, hand.surface.vertices, atol=1e-8)
    np.testing.assert_array_equal(again.surface.faces, hand.surface.faces)
    np.testing.assert_allclose(again.rest[order][:, :3, 3], hand.rest[:, :3, 3], atol=1e-7)
    np.testing.assert_allclose(again.rest[order][:, :3, 1], hand.rest[:, :3, 1], atol=1e-5)


def test_a_hand_that_float32_would_collapse_is_not_saved(hand: qr.Hand, tmp_path: Path) -> None:
    far = hand.moved(translation=(1e6, 0.0, 0.0))
    with pytest.raises(MeshFileError, match=r"lose its shape as float32, .* move the hand to the origin"):
        far.save(tmp_path / "hand.glb")
    assert not list(tmp_path.iterdir())


def test_a_joint_of_a_file_that_hangs_on_none_hangs_on_the_root(hand: qr.Hand, tmp_path: Path) -> None:
    def part(description: dict[str, Any]) -> None:
        for node in description["nodes"]:
            if node.get("name") == "forearm":
                del node["children"]

    path = tmp_path / "saved.glb"
    hand.save(path)
    again = qr.read_hand(glb_with(part, tmp_path, path))
    assert {again.joint_names[joint] for joint in np.flatnonzero(again.parents < 0)} == {"wrist"}
    assert again.joint_names[again.parents[again.joint_names.index("forearm")]] == "wrist"


def test_a_joint_between_those_of_webxr_is_read_back_there(tmp_path: Path) -> None:
    made = qr.models.hand(edge_length=5e-3)
    names, parents = [*made.joint_names, "carpus"], [*made.parents, made.joint_names.index("wrist")]
    for joint, name in enumerate(made.joint_names):
        if name.endswith("metacarpal"):
            parents[joint] = names.index("carpus")
    rest = np.concatenate([made.rest, made.rest[made.joint_names.index("wrist")][None]])
    parts = parts_of(made) | {"joint_names": names, "parents": parents, "rest": rest}
    hand = qr.Hand(made.surface.vertices, made.surface.faces, **parts)
    path = tmp_path / "saved.glb"
    hand.save(path)
    again = qr.read_hand(path)
    assert again.joint_names == hand.joint_names
    np.testing.assert_array_equal(again.parents, hand.parents)
    # Joints that hang side by side, as exporters write them, have WebXR's parents.
    flat = glb_with(lambda file: [node.pop("children", None) for node in file["nodes"]], tmp_path, path)
    parents = qr.read_hand(flat).parents
    np.testing.assert_array_equal(parents[:-1], made.parents)
    assert names[parents[-1]] == "wrist"


def test_a_saved_contact_holds_pressure_and_the_pressed_skin(hand: qr.Hand, tmp_path: Path) -> None:
    from quasirigid.hand.files.gltf import Gltf

    palm = hand.posed({}).palm
    ball = qr.Obstacle.sphere(palm[:3, 3] + 0.03 * palm[:3, 2], 0.02)
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.495, response=qr.HalfSpace())
    contact = qr.press(hand.surface, ball, skin, -palm[:3, 2], depth=1e-3)
    path = tmp_path / "pressed.glb"
    hand.save(path, contact)
    file = Gltf(path)
    part = file.entry("meshes", 0, "primitives", 0)
    pressure = file.rows(part["attributes"]["_PRESSURE"]).ravel()
    np.testing.assert_allclose(pressure, contact.pressure, rtol=1e-6)
    places = file.rows(part["attributes"]["POSITION"]) + file.rows(part["targets"][0]["POSITION"])
    np.testing.assert_allclose(places, contact.deformed.vertices, atol=1e-7)
    weights = file.rows(part["attributes"]["WEIGHTS_0"])
    assert len(weights) == len(contact.pressure)


def test_faulty_files_are_named(tmp_path: Path) -> None:
    source = hand_file(GLB[1], ".glb").read_bytes()
    path = tmp_path / "hand.glb"

    def read(data: bytes) -> None:
        path.write_bytes(data)
        qr.read_hand(path)

    length = struct.unpack_from("<I", source, 12)[0]
    text, rest = source[20 : 20 + length], source[20 + length :]

    def with_text(changed: bytes) -> bytes:
        changed = changed + b" " * (-len(changed) % 4)
        head = struct.pack("<4sII", b"glTF", 2, 20 + len(changed) + len(rest))
        return head + struct.pack("<I4s", len(changed), b"JSON") + changed + rest

    with pytest.raises(qr.MeshFileError, match=r"ends after \d+ of \d+ bytes"):
        read(source[:-100])
    with pytest.raises(qr.MeshFileError, match="does not begin as a GLB"):
        read(b"ply\n" + source)
    with pytest.raises(qr.HandError, match="has 0 skins, expected one"):
        read(with_text(text.replace(b'"skins"', b'"other"')))
    with pytest.raises(qr.HandError, match="has no joint 'thumb-tip'"):
        read(with_text(text.replace(b'"thumb-tip"', b'"thumb-end"')))
    with pytest.raises(qr.MeshFileError, match="reads up to byte"):
        read(with_text(text.replace(b'"count":1360', b'"count":9990')))


@pytest.mark.parametrize(
    ("children", "message"),
    [
        (
            {"wrist": ["thumb-tip"]},
            r"node 4 \('thumb-tip'\) hangs on two nodes, node 0 \('wrist'\) and node 26",
        ),
        ({"thumb-tip": ["Armature"]}, r"run in a circle through node 26 \('Armature'\)"),
        ({"Armature": ["Armature"]}, r"run in a circle through node 26 \('Armature'\)"),
        ({"thumb-tip": [10**6]}, "its description has no nodes/1000000"),
        ({"thumb-tip": 3}, "the children of node .* are 3, no list"),
    ],
)
def test_nodes_that_form_no_trees_are_named(tmp_path: Path, children: dict[str, Any], message: str) -> None:
    def hang(description: dict[str, Any]) -> None:
        nodes = description["nodes"]
        number = {node.get("name"): at for at, node in enumerate(nodes)}
        for name, held in children.items():
            nodes[number[name]]["children"] = (
                [number.get(one, one) for one in held] if isinstance(held, list) else held
            )

    with pytest.raises(qr.QuasirigidError, match=message):
        qr.read_hand(glb_with(hang, tmp_path))


def part_of(description: dict[str, Any]) -> dict[str, Any]:
    part: dict[str, Any] = description["meshes"][0]["primitives"][0]
    return part


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda file: file.update(nodes=5), "has 5 as nodes, expected objects"),
        (lambda file: file["nodes"].append(7), "as nodes, expected objects"),
        (lambda file: file.update(skins=7), "has 7 as skins, expected objects"),
        (lambda file: file["skins"][0].update(joints=7), "the joints of its skin are 7, no list"),
        (lambda file: file["meshes"][0].update(primitives=[]), "its mesh has no parts"),
        (lambda file: part_of(file).update(attributes=3), "attributes that are no object"),
        (
            lambda file: part_of(file)["attributes"].update(
                WEIGHTS_0=part_of(file)["attributes"]["POSITION"]
            ),
            r"1360 points, joints \(1360, 4\) and weights \(1360, 3\)",
        ),
        (lambda file: file["skins"][0].update(joints=[0, 1, 2]), r"names joint 23, but there are 3"),
        (lambda file: file["accessors"].insert(0, 3), "as accessors, expected objects"),
    ],
)
def test_a_glb_of_other_things_is_named(
    tmp_path: Path, change: Callable[[dict[str, Any]], None], message: str
) -> None:
    with pytest.raises(qr.QuasirigidError, match=message):
        qr.read_hand(glb_with(change, tmp_path))


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("../hand.bin", r"buffers/0 is '../hand.bin', expected a file beside it or its bytes"),
        ("data:;base64,#", r"buffers/0 is no base64"),
        ("none.bin", r"none.bin: No such file"),
        (None, r"buffers/0 is None"),
    ],
)
def test_a_buffer_that_is_not_there_is_named(tmp_path: Path, uri: str | None, message: str) -> None:
    qr.models.hand(edge_length=5e-3).save(tmp_path / "hand.glb")
    described, _ = glb_parts(tmp_path / "hand.glb")
    described["buffers"][0]["uri"] = uri
    (tmp_path / "hand.gltf").write_text(json.dumps(described))
    with pytest.raises(qr.MeshFileError, match=message):
        qr.read_hand(tmp_path / "hand.gltf")
