"""Files of prepared skins: equal to the bit, refused when damaged, nothing unpickled."""

from __future__ import annotations

import contextlib
import io
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from prepared_skins import RESPONSES, skin_of
from quasirigid.skin import core as core_skins
from shapes import PLATE

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")


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


def test_a_folder_that_is_missing_is_named(surface: qr.Surface, tmp_path: Path) -> None:
    prepared = skin_of(qr.HalfSpace()).prepared(surface, [0])
    with pytest.raises(FileNotFoundError, match=r"its folder does not exist: .*missing/skin.npz'$"):
        prepared.save(tmp_path / "missing" / "skin.npz")


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
    with pytest.raises(qr.ResponseError, match=r"missing\.npz cannot be read .*: .*No such file"):
        qr.load_prepared(tmp_path / "missing.npz")


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
    for count in (3, 10_000_000):
        np.savez_compressed(path, header=np.zeros(count))
        with pytest.raises(qr.ResponseError, match="its parts are compressed"):
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


def test_an_error_of_our_own_is_none_of_the_file(
    surface: qr.Surface, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = saved(tmp_path, surface, "body")
    monkeypatch.setattr(core_skins._core, "restore_body", lambda: None)
    with pytest.raises(TypeError, match="<lambda>"):
        qr.load_prepared(path)


@pytest.mark.parametrize(
    "changed",
    [
        {"nodes": np.array([-1])},
        {"nodes": np.array([10**6])},
        {"nodes": np.array([0.5])},
        {"matrix": np.zeros((2, 3))},
        {"matrix": np.array([["x"]])},
        {"vertices": np.zeros((642, 3), dtype=np.float32)},
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
