"""Responses computed once: stored, moved, given."""

from __future__ import annotations

import contextlib
import copy
import io
import pickle
import zipfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.skin import skins
from quasirigid.skin.core import build_prepared
from shapes import AS_GIVEN, ball

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")

SHEAR_MODULUS = 60e3
PLATE = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
TURN = np.array([[0.0, -1, 0], [0.6, 0, -0.8], [0.8, 0, 0.6]])


def skin_of(response: qr.Response) -> qr.Skin:
    return qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.45, response=response)


def given(nodes: np.ndarray, compliance: np.ndarray) -> qr.Skin:
    return skin_of(qr.GivenMatrix(nodes=nodes, compliance=compliance))


@pytest.fixture(scope="module")
def surface() -> qr.Surface:
    return qr.Surface(*ball(8e-3, 3))


def core() -> qr.Surface:
    vertices, faces = ball(3e-3, 2)
    return qr.Surface(vertices + np.array([0, 0, 5e-3]), faces)


RESPONSES = {
    "half_space": qr.HalfSpace(),
    "layer": qr.Layer(thickness=20e-3),
    "field": qr.Layer(thickness=np.full(642, 20e-3)),
    "body": qr.Body(bone=core()),
    "averaged_body": qr.Body(bone=core(), discretization="galerkin"),
}


def test_threads_share_a_prepared_skin(surface: qr.Surface) -> None:
    prepared = skin_of(RESPONSES["body"]).prepared(surface)
    depths = np.linspace(0.2e-3, 1.0e-3, 6)

    def force(depth: float) -> float:
        options = qr.ContactOptions(target_error=0.1)
        return float(qr.press(surface, PLATE, prepared, [0, 0, 1], depth=depth, options=options).force[2])

    alone = [force(depth) for depth in depths]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(force, [*depths, *depths], timeout=120.0))
    np.testing.assert_allclose(together, [*alone, *alone], rtol=1e-6)


@pytest.mark.parametrize("name", ["half_space", "layer", "field"])
def test_a_prepared_kernel_gives_the_contact_of_the_kernel(name: str, surface: qr.Surface) -> None:
    skin = skin_of(RESPONSES[name])
    direct = qr.press(surface, PLATE, skin, [0, 0, 1], depth=0.5e-3)
    prepared = qr.press(surface, PLATE, skin.prepared(surface), [0, 0, 1], depth=0.5e-3)
    # Entries of the matrix hold to 1e-6, whichever nodes it is assembled over.
    np.testing.assert_allclose(prepared.force, direct.force, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("name", RESPONSES)
def test_saved_and_loaded_it_is_equal_to_the_bit(name: str, surface: qr.Surface, tmp_path: Path) -> None:
    low = np.flatnonzero(surface.vertices[:, 2] < 2e-3)
    prepared = skin_of(RESPONSES[name]).prepared(surface, low)
    prepared.save(tmp_path / "skin.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["skin.npz"]
    loaded = qr.load_prepared(tmp_path / "skin.npz")
    np.testing.assert_array_equal(loaded.nodes, low)
    one, two = (qr.press(surface, PLATE, skin, [0, 0, 1], depth=0.4e-3) for skin in (prepared, loaded))
    np.testing.assert_array_equal(one.node_force, two.node_force)
    np.testing.assert_array_equal(one.displacement, two.displacement)


@pytest.mark.parametrize(
    "response",
    [
        qr.HalfSpace(),
        qr.GaussianCorrected(height=1e-4, width=np.float32(8e-3), cutoff=15e-3),  # type: ignore[arg-type]
        qr.Layer(thickness=np.float32(20e-3)),  # type: ignore[arg-type]
        qr.Layer(thickness=np.array(20e-3)),
    ],
    ids=["half_space", "gaussian", "layer", "layer of an array"],
)
def test_numbers_of_numpy_are_saved_as_numbers(
    response: qr.Response, surface: qr.Surface, tmp_path: Path
) -> None:
    skin = qr.Skin(shear_modulus=np.int64(60_000), poisson_ratio=np.float32(0.45), response=response)  # type: ignore[arg-type]
    prepared = skin.prepared(surface, np.arange(10))
    prepared.save(tmp_path / "skin.npz")
    loaded = qr.load_prepared(tmp_path / "skin.npz")
    assert loaded.skin.shear_modulus == 60e3
    assert loaded.skin.poisson_ratio == float(np.float32(0.45))
    assert vars(loaded.skin.response) == vars(response)
    np.testing.assert_array_equal(
        qr.response_matrix(surface, loaded, np.arange(10)),
        qr.response_matrix(surface, prepared, np.arange(10)),
    )


HELD = ball(8e-3, 3)[0][:, 2] > 12e-3
LAST = np.arange(630, 642)
ARRAYS: dict[str, tuple[type[Any], dict[str, Any]]] = {
    "layer": (qr.Layer, {"thickness": np.full(642, 20e-3)}),
    "list": (qr.Layer, {"thickness": [20e-3] * 642}),
    "number": (qr.Layer, {"thickness": np.array(20e-3)}),
    "body": (qr.Body, {"fixed": HELD}),
    "given": (qr.GivenMatrix, {"nodes": LAST, "compliance": 1e-3 * np.eye(12)}),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_a_response_is_what_it_was_made_of_whatever_becomes_of_the_arrays(
    name: str, surface: qr.Surface, tmp_path: Path
) -> None:
    kind, made_of = ARRAYS[name]
    mine = copy.deepcopy(made_of)
    response = kind(**mine)
    prepared = skin_of(response).prepared(surface, LAST if kind is qr.Layer else None)
    for values in mine.values():
        if isinstance(values, list):
            values[:] = [0.0] * len(values)
        else:
            values[...] = 0
    prepared.save(tmp_path / "skin.npz")
    loaded = qr.load_prepared(tmp_path / "skin.npz").skin.response
    for one in (response, loaded, pickle.loads(pickle.dumps(response)), copy.deepcopy(response)):
        for field, values in made_of.items():
            kept = getattr(one, field)
            np.testing.assert_array_equal(kept, values)
            # A number is loaded as one.
            if np.ndim(values) > 0 or one is not loaded:
                with pytest.raises(ValueError, match="read-only"):
                    kept[...] = 0
    assert repr(response) == repr(kind(**made_of))


def test_a_folder_that_is_missing_is_named(surface: qr.Surface, tmp_path: Path) -> None:
    prepared = skin_of(qr.HalfSpace()).prepared(surface, [0])
    with pytest.raises(FileNotFoundError, match=r"its folder does not exist: .*missing/skin.npz'$"):
        prepared.save(tmp_path / "missing" / "skin.npz")


def test_a_body_is_prepared_by_the_threads_of_what_asks_and_once_for_a_sweep(
    surface: qr.Surface, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def build(*words: Any, **options: Any) -> Any:
        asked.append(options["num_threads"])
        return build_prepared(*words, **options)

    monkeypatch.setattr(skins, "build_prepared", build)
    skin, one = skin_of(RESPONSES["body"]), replace(AS_GIVEN, num_threads=1)
    pressed = qr.press(surface, PLATE, skin, [0, 0, 1], depth=0.4e-3, options=one)
    curve = qr.sweep(surface, PLATE, skin, [0, 0, 1], depths=[0.4e-3, 0.5e-3], options=one)
    np.testing.assert_array_equal(curve.force[0], pressed.force)
    qr.response_matrix(surface, skin, [0], num_threads=2)
    assert asked == [1, 1, 2]
    with pytest.raises(qr.ResponseError, match="at least 1"):
        skin.prepared(surface, num_threads=0)


@pytest.mark.parametrize("name", ["half_space", "body"])
def test_it_moves_with_its_surface(name: str, surface: qr.Surface, tmp_path: Path) -> None:
    low = np.flatnonzero(surface.vertices[:, 2] < 2e-3)
    prepared = skin_of(RESPONSES[name]).prepared(surface, low)
    still = qr.press(surface, PLATE, prepared, [0, 0, 1], depth=0.4e-3)
    shift = [0.1, -0.2, 0.3]
    moved = prepared.moved(TURN, shift)
    there = surface.moved(TURN, shift)
    turned = qr.press(there, PLATE.moved(TURN, shift), moved, TURN @ [0, 0, 1], depth=0.4e-3)
    np.testing.assert_allclose(turned.force, TURN @ still.force, rtol=1e-7, atol=1e-9)
    # Away from the candidates a kernel's displacement holds to 1e-3, and its far field to the axes' choice.
    scale = np.abs(still.displacement).max()
    np.testing.assert_allclose(turned.displacement, still.displacement @ TURN.T, atol=1e-3 * scale)
    moved.save(tmp_path / "moved.npz")
    again = qr.press(
        there,
        PLATE.moved(TURN, shift),
        qr.load_prepared(tmp_path / "moved.npz"),
        TURN @ [0, 0, 1],
        depth=0.4e-3,
    )
    np.testing.assert_array_equal(again.node_force, turned.node_force)


def test_another_surface_is_refused_with_what_differs(surface: qr.Surface) -> None:
    prepared = skin_of(qr.HalfSpace()).prepared(surface, np.arange(20))
    with pytest.raises(qr.ResponseError, match="number of vertices: 162, expected 642"):
        qr.solve_contact(qr.Surface(*ball(8e-3, 2)), PLATE, prepared)
    with pytest.raises(qr.ResponseError, match=r"vertex 0 is 1\.000e-3 m away"):
        qr.solve_contact(surface.moved(np.eye(3), [1e-3, 0, 0]), PLATE, prepared)
    flipped = qr.Surface(surface.vertices, np.roll(surface.faces, 1, axis=1))
    with pytest.raises(qr.ResponseError, match="faces that differ: 1280"):
        qr.solve_contact(flipped, PLATE, prepared)
    kernel_alone = skin_of(qr.HalfSpace()).combined(surface, {})
    with pytest.raises(qr.ResponseError, match="number of vertices: 162, expected 642"):
        qr.press(qr.Surface(*ball(8e-3, 2)), PLATE, kernel_alone, [0, 0, 1], depth=0.4e-3)
    with pytest.raises(qr.ResponseError, match="prepared for 20 other vertices"):
        qr.press(surface, PLATE, prepared, [0, 0, 1], depth=0.5e-3)


def test_a_file_that_is_no_prepared_skin_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.npz"
    np.savez(path, numbers=np.arange(3))
    with pytest.raises(qr.ResponseError, match="cannot be read as a prepared skin"):
        qr.load_prepared(path)
    # As a contact is saved.
    np.savez_compressed(path, gap=np.zeros(1000))
    with pytest.raises(qr.ResponseError, match=r"cannot be read as .*: it holds no prepared skin"):
        qr.load_prepared(path)
    path.write_text("text")
    with pytest.raises(qr.ResponseError, match="cannot be read"):
        qr.load_prepared(path)
    np.save(tmp_path / "array.npy", np.arange(3))
    with pytest.raises(qr.ResponseError, match=r"array\.npy cannot be read .*: it holds a single array"):
        qr.load_prepared(tmp_path / "array.npy")
    with pytest.raises(FileNotFoundError):
        qr.load_prepared(tmp_path / "missing.npz")


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
        (np.ones((2, 3)), r"shape \[2, 3\], expected \(k, k\)"),
        ([[np.nan]], "not finite"),
        ([1.0], r"shape \[1\]"),
    ):
        with pytest.raises(qr.ResponseError, match=message):
            qr.definiteness(matrix)


def test_a_body_on_its_bone_is_right_against_finite_elements(surface: qr.Surface) -> None:
    sphere = qr.reference.plate_on_cored_sphere()[0]
    assert (sphere.radius, sphere.shear_modulus, sphere.poisson_ratio) == (8e-3, SHEAR_MODULUS, 0.5)
    skin = qr.Skin(
        shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=qr.Body(bone=core(), coarse_edge_length=0)
    )
    low = np.flatnonzero(surface.vertices[:, 2] < 4e-3)
    prepared = skin.prepared(surface, low)
    # Uniform edges of 1.1 mm against contact radii of 2 and 3 mm: two and three cells.
    for depth, error in [(0.6e-3, 0.04), (1.12e-3, 0.02)]:
        contact = qr.press(surface, PLATE, prepared, [0, 0, 1], depth=depth, options=AS_GIVEN)
        assert contact.force[2] == pytest.approx(sphere.indentations[depth], rel=error)
        # Incompressible: what is pushed in comes out elsewhere.
        inward = -np.einsum("ij,ij->i", contact.displacement, surface.vertex_normals)
        pushed = np.maximum(inward, 0) @ surface.vertex_areas
        assert abs(contact.volume_change) < 5e-3 * pushed


@pytest.mark.parametrize("length", [0, None])
def test_averaged_gaps_of_a_refined_body_are_right_against_finite_elements(
    length: float | None, surface: qr.Surface
) -> None:
    sphere = qr.reference.plate_on_cored_sphere()[0]
    body = qr.Body(bone=core(), coarse_edge_length=length, discretization="galerkin")
    skin = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=body)
    prepared = skin.prepared(surface, np.flatnonzero(surface.vertices[:, 2] < 5e-3))
    for depth in (0.6e-3, 1.12e-3):
        contact = qr.press(surface, PLATE, prepared, [0, 0, 1], depth=depth)
        assert contact.accuracy.discretization == "galerkin"
        assert contact.force[2] == pytest.approx(sphere.indentations[depth], rel=0.012)


def test_a_body_that_nothing_holds_is_refused(surface: qr.Surface) -> None:
    with pytest.raises(qr.ResponseError, match="bone"):
        skin_of(qr.Body()).prepared(surface)


def saved(tmp_path: Path, surface: qr.Surface, name: str = "half_space") -> Path:
    low = np.flatnonzero(surface.vertices[:, 2] < 1e-3)
    path = tmp_path / f"{name}.npz"
    skin_of(RESPONSES[name]).prepared(surface, low).save(path)
    return path


def rewritten(path: Path, **changed: np.ndarray) -> Path:
    with np.load(path) as stored:
        arrays = {key: stored[key] for key in stored.files}
    np.savez(path, **(arrays | changed))
    return path


def test_a_file_cut_off_anywhere_is_refused_by_name(surface: qr.Surface, tmp_path: Path) -> None:
    path = saved(tmp_path, surface)
    data = path.read_bytes()
    for length in np.linspace(0, len(data) - 1, 60).astype(int):
        path.write_bytes(data[:length])
        with pytest.raises(qr.ResponseError, match=r"half_space\.npz cannot be read as a prepared skin"):
            qr.load_prepared(path)


@pytest.mark.parametrize("name", ["half_space", "body"])
def test_a_file_with_flipped_bits_is_read_or_refused(name: str, surface: qr.Surface, tmp_path: Path) -> None:
    path = saved(tmp_path, surface, name)
    data = np.frombuffer(path.read_bytes(), np.uint8)
    sound = qr.load_prepared(path)
    matrix = qr.response_matrix(surface, sound, sound.nodes)
    random = np.random.default_rng(1)
    read = 0
    # Many anywhere are always found out; one in the directory at the end, as in a date, may do no harm.
    for count, last in [(3, len(data))] * 60 + [(1, 900)] * 60:
        damaged = data.copy()
        places = len(data) - random.integers(1, last, count)
        damaged[places] ^= random.integers(1, 256, count).astype(np.uint8)
        path.write_bytes(damaged.tobytes())
        with contextlib.suppress(qr.ResponseError):
            again = qr.load_prepared(path)
            read += 1
            assert np.array_equal(qr.response_matrix(surface, again, again.nodes), matrix)
    assert 0 < read < 60


def test_what_is_zipped_or_longer_than_its_file_is_refused_before_memory_is_taken(
    surface: qr.Surface, tmp_path: Path
) -> None:
    path = tmp_path / "bomb.npz"
    np.savez_compressed(path, header=np.zeros(10_000_000))
    with pytest.raises(qr.ResponseError, match="its parts are longer than itself"):
        qr.load_prepared(path)
    np.savez_compressed(path, header=np.zeros(3))
    with pytest.raises(qr.ResponseError, match=r"header\.npy is compressed"):
        qr.load_prepared(path)
    vast = io.BytesIO()
    np.lib.format.write_array_header_1_0(vast, {"descr": "<f8", "fortran_order": False, "shape": (2**40,)})
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("header.npy", vast.getvalue())
    with pytest.raises(qr.ResponseError, match=r"header\.npy promises \(1099511627776,\) entries"):
        qr.load_prepared(path)


def test_nothing_is_unpickled(tmp_path: Path) -> None:
    path = tmp_path / "pickled.npz"
    np.savez(path, header=np.array([Witness()], dtype=object))
    with pytest.raises(qr.ResponseError, match="holds no numbers"):
        qr.load_prepared(path)
    assert not Witness.called


class Witness:
    called = False

    def __reduce__(self) -> tuple[Callable[[], None], tuple[()]]:
        return Witness.call, ()

    @staticmethod
    def call() -> None:
        Witness.called = True


@pytest.mark.parametrize(
    "changed",
    [
        {"nodes": np.array([-1])},
        {"nodes": np.array([10**6])},
        {"nodes": np.array([0.5])},
        {"matrix": np.zeros((2, 3))},
        {"matrix": np.array([["x"]])},
        {"vertices": np.full((642, 3), np.nan)},
        {"vertices": np.zeros((0, 3))},
        {"faces": np.array([[0, 1, 2**40]])},
        {"header": np.array("{")},
        {"header": np.array("[" * 100_000)},
        {"header": np.array(7)},
    ],
)
def test_a_part_that_does_not_fit_is_named_with_the_file(
    changed: dict[str, np.ndarray], surface: qr.Surface, tmp_path: Path
) -> None:
    path = rewritten(saved(tmp_path, surface), **changed)
    with pytest.raises(
        qr.ResponseError, match=r"half_space\.npz (cannot be read|holds no sound|lacks|is no) "
    ):
        qr.load_prepared(path)


@pytest.mark.parametrize("value", ["finger.ply", (1, 2), 5])
def test_what_is_no_surface_is_refused_by_name(value: Any, surface: qr.Surface) -> None:
    with pytest.raises(TypeError, match=r"surface is .*, expected a Surface"):
        skin_of(qr.HalfSpace()).prepared(value)
    with pytest.raises(TypeError, match=r"bone is .*, expected a Surface"):
        skin_of(qr.Body(bone=value)).prepared(surface)


def test_responses_are_equal_by_what_they_hold(surface: qr.Surface, tmp_path: Path) -> None:
    count = len(surface.vertices)
    bone = ball(2e-3, 1)
    made: list[Callable[[float], qr.Response]] = [
        lambda size: qr.Layer(thickness=size * 5e-3),
        lambda size: qr.Layer(thickness=np.full(count, size * 5e-3)),
        lambda size: qr.Body(bone=qr.Surface(size * bone[0], bone[1])),
        lambda size: qr.Body(fixed=np.arange(count) < size),
        lambda size: qr.GivenMatrix(nodes=[0, 1], compliance=size * np.eye(2)),
        lambda size: qr.GaussianCorrected(height=None, width=size * 10e-3, cutoff=15e-3),
    ]
    for make in made:
        one, same, other = make(1), make(1), make(2)
        assert (one == same, one == other, hash(one) == hash(same)) == (True, False, True)
        assert one != qr.HalfSpace()
    assert qr.HalfSpace() == qr.HalfSpace(pressure="linear") != qr.HalfSpace(pressure="one_ring")
    assert qr.Layer(thickness=5e-3) != qr.Layer(thickness=np.full(count, 5e-3))
    prepared = skin_of(qr.Layer(thickness=5e-3)).prepared(surface, [0])
    prepared.save(tmp_path / "layer.npz")
    assert qr.load_prepared(tmp_path / "layer.npz").skin == prepared.skin
