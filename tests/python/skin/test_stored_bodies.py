"""Stored bodies with damaged numbers: each part is refused by name, where it is loaded."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import ball

SURFACE = qr.Surface(*ball(8e-3, 3))
BONE = qr.Surface(*ball(3e-3, 1))
LOW = np.flatnonzero(SURFACE.vertices[:, 2] < 2e-3)

Parts = dict[str, np.ndarray]


def prepared(**body: Any) -> qr.PreparedSkin:
    core = BONE.moved(np.eye(3), [0, 0, 5e-3])
    response = qr.Body(bone=core, bone_pressure=True, **body)
    return qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=response).prepared(SURFACE, LOW)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Parts]:
    """Return the parts of a file on one level, and of one on two."""
    parts = {}
    for name, skin in (("one", prepared(coarse_edge_length=0)), ("two", prepared())):
        path = tmp_path_factory.mktemp("skins") / "skin.npz"
        skin.save(path)
        with np.load(path) as stored:
            parts[name] = dict(stored)
    return parts


def test_a_numpy_length_is_stored_as_any_other(tmp_path: Path) -> None:
    length = np.float32(2.5e-3)
    prepared(coarse_edge_length=length).save(tmp_path / "skin.npz")
    response = qr.load_prepared(tmp_path / "skin.npz").skin.response
    assert isinstance(response, qr.Body)
    assert response.coarse_edge_length == float(length)


def without(columns: slice, nodes: str) -> Callable[[Parts], Parts]:
    """Return the change that drops some nodes with their columns."""

    def change(parts: Parts) -> Parts:
        kept = np.delete(np.arange(len(parts[nodes])), columns)
        blocks = (3 * kept[:, None] + np.arange(3)).ravel()
        changed = {name: parts[name][:, blocks] for name in ("displacement", "bone_pressure")}
        return {nodes: parts[nodes][kept], **changed}

    return change


def entry(name: str, place: Any, value: float) -> Callable[[Parts], Parts]:
    """Return the change of some entries of a part."""

    def change(parts: Parts) -> Parts:
        array = parts[name].copy()
        array[place] = value
        return {name: array}

    return change


def rows(names: list[str], kept: slice) -> Callable[[Parts], Parts]:
    """Return the change that keeps some rows of parts."""
    return lambda parts: {name: parts[name][kept] for name in names}


OVER_SKIN = ["coarse_corners", "coarse_weights", "coarse_edges", "held", "tissue_thickness"]

DAMAGED: list[tuple[str, Callable[[Parts], Parts], str]] = [
    ("one", without(slice(None), "nodes"), "no node to load"),
    ("two", without(slice(None), "coarse_nodes"), "no node to load"),
    ("two", without(slice(0, 1), "coarse_nodes"), r"no column for vertex \d+ of the coarse skin beside it"),
    (
        "two",
        rows(["coarse_nodes"], slice(None, None, -1)),
        r"node 0 is vertex \d+, expected vertex \d+",
    ),
    (
        "two",
        lambda parts: {"coarse_nodes": np.full(len(parts["coarse_nodes"]), 7)},
        "7 occurs twice",
    ),
    ("two", rows(["coarse_corners"], slice(None, None, -1)), "no column for vertex"),
    ("one", entry("displacement", (9, 4), np.nan), "row 9 of the stored displacement holds NaN"),
    ("two", entry("displacement", (9, 4), np.inf), "row 9 of the stored displacement holds inf"),
    ("one", entry("bone_pressure", (5, 4), np.nan), "row 5 of the stored bone pressure holds NaN"),
    ("one", entry("rotation", (0, 0), np.nan), "rotation"),
    ("two", entry("coarse_weights", (5, 1), np.nan), "row 5 of the stored coarse weights holds NaN"),
    ("two", entry("coarse_weights", (5, 1), -1.0), "row 5 of the stored coarse weights holds -1"),
    (
        "two",
        entry("coarse_weights", 5, 0.0),
        "the stored sums of coarse weights holds 0, expected 1",
    ),
    ("two", entry("coarse_edges", 5, 0.0), "row 5 of the stored coarse edges holds 0, expected finite"),
    ("two", entry("tissue_thickness", 5, np.nan), "thickness is NaN"),
    ("one", entry("tissue_thickness", 5, -1.0), "row 5 of the stored thickness holds -1, expected finite"),
    ("one", rows(["tissue_thickness"], slice(0, 0)), "stored thickness has 0 entries, expected 642"),
    ("two", rows(["coarse_corners"], slice(1, None)), "stored coarse weights has 642 entries, expected 641"),
    ("two", rows(["held"], slice(1, None)), "stored fixed has 641 entries, expected 642"),
    ("two", rows(OVER_SKIN, slice(1, None)), "stored skin vertices has 641 entries, expected 642"),
    ("one", rows(["displacement"], slice(3, None)), "stored skin vertices has 641 entries, expected 642"),
    ("one", rows(["displacement"], slice(1, None)), "displacement rows has 1925 entries, expected 1923"),
    ("two", rows(["bone_pressure"], slice(1, None)), "stored bone pressure has 41 rows, expected 42"),
]


@pytest.mark.parametrize(("name", "change", "message"), DAMAGED)
def test_a_damaged_part_of_a_body_is_named_where_it_is_loaded(
    name: str, change: Callable[[Parts], Parts], message: str, files: dict[str, Parts], tmp_path: Path
) -> None:
    path = tmp_path / "damaged.npz"
    np.savez(path, **(files[name] | change(files[name])))
    with pytest.raises(qr.ResponseError, match=rf"damaged\.npz holds no sound prepared skin: .*{message}"):
        qr.load_prepared(path)


def test_a_body_on_a_bone_lacks_its_thickness(files: dict[str, Parts], tmp_path: Path) -> None:
    path = tmp_path / "damaged.npz"
    np.savez(path, **{name: part for name, part in files["two"].items() if name != "tissue_thickness"})
    with pytest.raises(qr.ResponseError, match=r"lacks or misnames a part .*'tissue_thickness'"):
        qr.load_prepared(path)


def test_blocks_that_are_not_finite_are_named(tmp_path: Path) -> None:
    blocks = np.einsum("ij,ab->iajb", 1e-3 * np.eye(2), np.eye(3))
    material = {"shear_modulus": 60e3, "poisson_ratio": 0.5}
    sound = qr.Skin(**material, response=qr.GivenMatrix(nodes=[3, 1], compliance=blocks)).prepared(SURFACE)
    sound.save(tmp_path / "blocks.npz")
    with np.load(tmp_path / "blocks.npz") as stored:
        damaged = dict(stored)
    damaged["displacement"][3 * 1 + 2, 4] = np.nan
    np.savez(tmp_path / "blocks.npz", **damaged)
    with pytest.raises(qr.ResponseError, match="row 5 of the stored displacement holds NaN"):
        qr.load_prepared(tmp_path / "blocks.npz")

    blocks[1, 2, 0, 1] = np.inf
    given = qr.Skin(**material, response=qr.GivenMatrix(nodes=[3, 1], compliance=blocks))
    with pytest.raises(qr.ResponseError, match=r"compliance\[1, 2, 0, 1\] is inf, expected a finite number"):
        given.prepared(SURFACE)


def test_what_is_whole_is_taken(files: dict[str, Parts], tmp_path: Path) -> None:
    for name, parts in files.items():
        np.savez(tmp_path / f"{name}.npz", **parts)
        loaded = qr.load_prepared(tmp_path / f"{name}.npz")
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(loaded)).nodes, LOW)
