"""Matrices that somebody else computed: used as they stand, among their nodes, checked."""

from __future__ import annotations

import itertools
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import quasirigid as qr
from prepared_skins import core, skin_of
from shapes import AS_GIVEN, PLATE

if TYPE_CHECKING:
    from collections.abc import Callable

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")


def given(nodes: np.ndarray, compliance: np.ndarray) -> qr.Skin:
    return skin_of(qr.GivenMatrix(nodes=nodes, compliance=compliance))


def test_a_given_matrix_is_used_as_it_stands(surface: qr.Surface) -> None:
    low = np.flatnonzero(surface.vertices[:, 2] < 1e-3)
    matrix = qr.response_matrix(surface, skin_of(qr.HalfSpace()), low)
    one = qr.press(surface, PLATE, given(low, matrix), [0, 0, 1], depth=0.3e-3)
    two = qr.press(surface, PLATE, skin_of(qr.HalfSpace()), [0, 0, 1], depth=0.3e-3, options=AS_GIVEN)
    np.testing.assert_allclose(one.force, two.force, rtol=1e-5, atol=1e-9)
    blocks = np.einsum("ij,ab->iajb", matrix, np.eye(3))
    three = qr.press(surface, PLATE, given(low, blocks), [0, 0, 1], depth=0.3e-3)
    np.testing.assert_allclose(three.force, one.force, rtol=1e-9, atol=1e-12)
    with pytest.raises(qr.ResponseError, match="the matrix is 3 x 3, expected"):
        qr.press(surface, PLATE, given(low, np.eye(3)), [0, 0, 1], depth=0.3e-3)
    with pytest.raises(qr.ResponseError, match="compliance has shape"):
        given(low, np.zeros((2, 3, 2, 3))).prepared(surface)


ORDERS = {
    "as the nodes": (None, lambda matrix, order: matrix),
    "transposed": (None, lambda matrix, order: matrix.T),
    "another": ("does not fit its nodes", lambda matrix, order: matrix[np.ix_(order, order)]),
    "of rows alone": ("is not the same both ways", lambda matrix, order: matrix[order]),
    "of columns alone": ("is not the same both ways", lambda matrix, order: matrix[:, order]),
    "one half alone": ("is not the same both ways", lambda matrix, order: np.triu(matrix)),
    "springs": (None, lambda matrix, order: np.diag(np.diag(matrix))),
    "rigid": (None, lambda matrix, order: np.full_like(matrix, matrix.max())),
}


@pytest.mark.parametrize(("words", "reorder"), ORDERS.values(), ids=ORDERS.keys())
def test_a_matrix_that_cannot_belong_to_its_nodes_is_told(
    words: str | None, reorder: Callable[[np.ndarray, np.ndarray], np.ndarray], surface: qr.Surface
) -> None:
    nodes = np.arange(len(surface.vertices))
    matrix = qr.response_matrix(surface, skin_of(qr.HalfSpace()), nodes)
    matrix = reorder(matrix, np.random.default_rng(1).permutation(len(nodes)))
    plate = PLATE.with_material(shear_modulus=60e3, poisson_ratio=0.5)
    mesh = qr.Obstacle.mesh(surface.vertices - [0, 0, 20e-3], surface.faces)
    skins = [given(nodes, matrix), given(nodes, np.einsum("ij,ab->iajb", matrix, np.eye(3)))]
    product = mesh.with_material(shear_modulus=60e3, poisson_ratio=0.5, response=skins[0].response)
    for skin, obstacle, side in [
        (skins[0], plate, "skin"),
        (skins[1], plate, "skin"),
        (skin_of(qr.HalfSpace()), product, "product"),
    ]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            contact = qr.press(
                surface, obstacle, skin, [0, 0, 1], depth=0.3e-3, options=AS_GIVEN, throw=False
            )
        told = [one.message for one in contact.warnings if one.category is qr.ResponseRangeWarning]
        assert len(told) == (words is not None)
        assert all(f"the compliance given for the {side} {words}" in message for message in told)


def body_blocks(surface: qr.Surface, nodes: np.ndarray) -> np.ndarray:
    """Blocks of a ball with a core (k, 3, k, 3), as far as they are the same with their axes exchanged."""
    prepared = skin_of(qr.Body(bone=core())).prepared(surface, nodes)

    def along(axis: np.ndarray) -> np.ndarray:
        directions = np.tile(axis / np.linalg.norm(axis), (len(nodes), 1))
        return qr.response_matrix(surface, prepared, nodes, directions=directions)

    own = [along(axis) for axis in np.eye(3)]
    blocks = np.empty((len(nodes), 3, len(nodes), 3))
    for a, b in np.ndindex(3, 3):
        between = own[a] if a == b else along(np.eye(3)[a] + np.eye(3)[b]) - 0.5 * (own[a] + own[b])
        blocks[:, a, :, b] = between
    return blocks


def test_blocks_with_their_axes_in_another_order_are_told(surface: qr.Surface) -> None:
    nodes = np.flatnonzero(surface.vertices[:, 2] < 3e-3)
    blocks = body_blocks(surface, nodes)
    for axes in itertools.permutations(range(3)):
        of_rows = blocks[:, axes]
        for compliance in (of_rows, of_rows[..., axes]):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                skin = given(nodes, compliance)
                contact = qr.press(surface, PLATE, skin, [0, 0, 1], depth=0.3e-3, throw=False)
            told = [one.message for one in contact.warnings if one.category is qr.ResponseRangeWarning]
            assert len(told) == (axes != (0, 1, 2))


def test_skin_that_bulges_beside_the_nodes_is_told() -> None:
    tip = qr.models.fingertip(edge_length=1e-3)
    tip = tip.with_skin_mask(qr.skin_without_caps(tip))
    layer = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.Layer(thickness=2e-3))
    height = tip.vertices[:, 2]

    def pressed(beyond: float) -> tuple[float, list[str]]:
        nodes = np.flatnonzero(tip.skin_mask & (height < height.min() + 1e-3 + beyond))
        skin = given(nodes, qr.response_matrix(tip, layer, nodes))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            contact = qr.press(tip, PLATE, skin, [0, 0, 1], depth=1e-3)
        return float(contact.force[2]), [text for one, text in contact.warnings if one is qr.CutWarning]

    # What bulges beside the skin that stood in the plate takes part of its force, more than the 2 % that
    # contacts aim for.
    lacks, told = pressed(0.0)
    assert "rim of the nodes that a given matrix knows" in told[0]
    whole, told = pressed(2e-3)
    assert told == []
    assert lacks < 0.98 * whole


def test_given_blocks_are_kept_among_their_nodes_alone(surface: qr.Surface, tmp_path: Path) -> None:
    nodes = [5, 3, 40]
    blocks = np.random.default_rng(1).normal(size=(3, 3, 3, 3)) * 1e-3
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    given(nodes, blocks).prepared(surface).moved(turn).save(tmp_path / "blocks.npz")
    with np.load(tmp_path / "blocks.npz") as stored:
        assert stored["displacement"].shape == (9, 9)
    again = qr.load_prepared(tmp_path / "blocks.npz")
    along = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.6, 0.0]])
    found = qr.response_matrix(surface.moved(turn), again, nodes, directions=along)
    expected = np.einsum("ia,iajb,jb->ij", along @ turn, blocks, along @ turn)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("compliance", [[[1e-3]], np.full((1, 3, 1, 3), 1e-3)], ids=["matrix", "blocks"])
def test_nodes_of_a_given_matrix_are_checked(compliance: np.ndarray, surface: qr.Surface) -> None:
    for node in (642, -1):
        with pytest.raises(qr.ResponseError, match=rf"`nodes\[0\]` is {node}, but there are 642 vertices"):
            given([node], compliance).prepared(surface)
    with pytest.raises(qr.ResponseError, match=r"`nodes` has shape"):
        given([[0]], compliance).prepared(surface)
    with pytest.raises(TypeError, match=r"`nodes` has dtype float64, expected integers"):
        given([0.0], compliance).prepared(surface)


def test_a_given_matrix_has_its_own_nodes(surface: qr.Surface) -> None:
    skin = given([3, 1], np.eye(2) * 1e-3)
    assert skin.prepared(surface, [1, 3]).nodes.tolist() == [3, 1]
    with pytest.raises(qr.ResponseError, match="a GivenMatrix has its own 2 nodes: leave out `nodes`"):
        skin.prepared(surface, [1])


def test_nodes_out_of_range_and_what_is_no_matrix_are_refused(surface: qr.Surface) -> None:
    skin, above = skin_of(qr.HalfSpace()), r"`nodes\[1\]` is 642, but there are 642 vertices"
    with pytest.raises(qr.ResponseError, match=above):
        skin.prepared(surface, [0, 642])
    with pytest.raises(qr.ResponseError, match=above):
        qr.response_matrix(surface, skin, [0, 642])
    with pytest.raises(qr.ResponseError, match=above):
        qr.initial_gaps(surface, skin, [0, 642], PLATE)
    for matrix, message in (
        (np.ones((2, 3)), r"shape \(2, 3\), expected \(k, k\)"),
        ([[np.nan]], "not finite"),
        ([1.0], r"shape \(1,\)"),
    ):
        with pytest.raises(qr.ResponseError, match=message):
            qr.definiteness(matrix)
