"""A mesh with its rig beside it: what does not fit is named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shared_meshes import hand_file


def test_a_rig_that_does_not_fit_is_named(tmp_path: Path) -> None:
    mesh = hand_file("webxr_right_middle_1500")
    with pytest.raises(
        qr.HandError, match=r"0 sets of weights fit a mesh of 1492 vertices; it holds 13k \(13004"
    ):
        qr.read_hand(mesh)
    other = tmp_path / mesh.name
    other.write_bytes(mesh.read_bytes())
    with pytest.raises(qr.HandError, match="no rig beside it"):
        qr.read_hand(other)


@pytest.mark.parametrize("damage", ["in the head", "in what is compressed", "in the version"])
def test_a_damaged_rig_is_named(tmp_path: Path, damage: str) -> None:
    tetrahedron = tmp_path / "hand.obj"
    tetrahedron.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    rig = tmp_path / "broken_rig.npz"
    np.savez_compressed(rig, rest=np.random.default_rng(3).random((26, 4, 4)))
    data = bytearray(rig.read_bytes())
    if damage == "in the head":
        data[2:] = b"\x03\x04 not a file of arrays"
    elif damage == "in what is compressed":
        data[60:200] = b"\xff" * 140
    else:
        data[data.rindex(b"PK\x01\x02") + 6] = 200  # of the program that would be needed
    rig.write_bytes(data)
    with pytest.raises(qr.HandError, match=r"broken_rig.npz: no file of arrays"):
        qr.read_hand(tetrahedron, rig=rig)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"13k_weight": np.full((13013, 8), "a")}, "`weights` has dtype <U1, expected real numbers"),
        ({"13k_weight": np.full((13013, 8), 0.0625)}, r"weights\[0\] sums to 0\.5"),
        ({"13k_joint": np.zeros((13013, 8))}, "`joints` has dtype float64, expected integers"),
        ({"rest": np.array(["a"] * 26)}, "could not convert string to float"),
        ({"side": "both"}, "side is 'both'"),
        ({"13k_joint": np.array(5)}, "0 sets of weights fit a mesh of 13013 vertices"),
    ],
)
def test_a_rig_of_other_things_is_named(tmp_path: Path, change: dict[str, Any], message: str) -> None:
    mesh = hand_file("makehuman_male_right_13k")
    rig = tmp_path / "rig.npz"
    known = dict(np.load(hand_file("makehuman_male_right_rig", ".npz")))
    np.savez(rig, **(known | change))
    with pytest.raises(qr.HandError, match=message):
        qr.read_hand(mesh, rig=rig)
