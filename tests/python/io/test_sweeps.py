"""Tables and files of sweeps."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, SKIN, ball

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")

UP = [0.0, 0.0, 1.0]
PLATE = qr.Obstacle.half_space([0.0, 0.0, -0.05], UP)


@pytest.fixture(scope="module")
def surface() -> qr.Surface:
    return qr.Surface(*ball(8e-3, 2))


def test_a_sweep_is_saved_as_its_columns_with_the_inputs(by_depth: qr.Sweep, tmp_path: Path) -> None:
    files = by_depth.save(tmp_path / "made", inputs={"skin": "a ball"})
    assert [file.name for file in files] == ["sweep.csv", "sweep.json"]
    header, *rows = csv.reader(files[0].read_text().splitlines())
    record = json.loads(files[1].read_text())
    assert record["inputs"] == {"skin": "a ball"}
    assert list(record["columns"]) == header
    np.testing.assert_array_equal([float(row[1]) for row in rows], by_depth.normal_force)
    assert record["columns"]["normal_force (N)"] == by_depth.normal_force.tolist()
    assert record["columns"]["force_error"][1] is None


def test_a_file_in_the_place_of_the_folder_of_a_sweep_is_refused(by_depth: qr.Sweep, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(NotADirectoryError, match="out is a file, expected a folder to write to"):
        by_depth.save(tmp_path / "out")
    assert (tmp_path / "out").read_text() == "a file"


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_the_summary_of_a_sweep_is_its_table_and_what_it_warned_of(surface: qr.Surface) -> None:
    small = qr.Obstacle.sphere([0.0, 0.0, -0.05], 1e-3)
    curve = qr.sweep(surface, small, SKIN, UP, forces=[0.1, 1e3], options=AS_GIVEN)
    text = curve.summary()
    assert text.startswith(qr.io.sweep_table(curve) + "\n")
    for step, warned in enumerate(curve.warnings):
        for warning in warned:
            assert f"step {step}: warning: {warning}" in text.splitlines()
    assert text.splitlines()[-1] == f"step 1: not_reached: {curve.messages[1]}"
    header, first, second = (line.split() for line in text.splitlines()[:3])
    assert header[:3] == ["step", "asked", "(N)"]
    assert (first[:2], first[-1]) == (["0", "0.1"], "solved")
    assert (second[:2], second[-1]) == (["1", "1000"], "not_reached")


def test_the_table_of_a_sweep_counts_its_steps(by_depth: qr.Sweep) -> None:
    header, *rows = (line.split() for line in qr.io.sweep_table(by_depth).splitlines())
    assert header[:3] == ["step", "depth", "(mm)"]
    assert [row[:2] for row in rows] == [
        [str(step), f"{1e3 * depth:.4g}"] for step, depth in enumerate(by_depth.asked)
    ]


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_peak_at_a_cut_is_infinite_in_table_and_files(surface: qr.Surface, tmp_path: Path) -> None:
    cut = surface.with_skin_mask(surface.vertices[:, 0] > 0.0)
    curve = qr.sweep(cut, PLATE, SKIN, UP, depths=[0.0, 0.6e-3])
    contact = curve[1]
    assert contact.accuracy.max_pressure_error == np.inf == curve.max_pressure_error[1]
    assert "kPa, infinite at an edge or a cut" in contact.summary()
    *lines, note = qr.io.sweep_table(curve).splitlines()
    assert note == "peak with an error of inf %: infinite at an edge or a cut"
    assert ["inf %" in line for line in lines] == [False, False, True]
    assert "infinite" not in qr.io.sweep_table(qr.sweep(surface, PLATE, SKIN, UP, depths=[1e-3]))
    record = json.loads(curve.save(tmp_path)[1].read_text())
    assert record["columns"]["max_pressure_error"] == [None, "Infinity"]
    assert record["warnings"] == [
        [{"category": one.__name__, "message": message} for one, message in step] for step in curve.warnings
    ]
    assert "CutWarning" in [one["category"] for one in record["warnings"][1]]


def test_a_record_of_an_earlier_sweep_does_not_outlast_its_table(
    by_depth: qr.Sweep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    by_depth.save(tmp_path)

    def full(path: Path) -> None:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("quasirigid.io.atomic.atomic_write", full)
    with pytest.raises(OSError, match="No space left"):
        by_depth.save(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.csv"]
