"""`quasirigid grasp`: a hand on a product."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.cli import run
from quasirigid.io.grasps import GRASP_FILES


@pytest.mark.filterwarnings("always::quasirigid.QuasirigidWarning")
def test_a_digit_that_stays_inside_the_product_is_named(
    saved: Path, bottle: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["grasp", str(saved), str(bottle), "--product-unit", "mm", "--target-error", "none"]
    assert run([*words, "--overlap", "index=2mm"]) == 0
    told = capsys.readouterr().err
    (line,) = (line for line in told.splitlines() if "not asked for" in line)
    assert re.match(r"warning: thumb was not asked for and stands 1\d\.\d mm inside the product", line)
    assert run([*words, "--overlap", "2mm"]) in (0, 1)
    assert "not asked for" not in capsys.readouterr().err


def test_a_product_inside_the_hand_is_one_line(
    saved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    hand = qr.read_hand(saved)
    triangles = qr.models.bottle(edge_length=3e-3).triangles()
    assert triangles is not None
    vertices, faces = triangles
    joints = [hand.frame_of(name)[:3, 3] for name in ("wrist", "middle-finger-phalanx-proximal")]
    path = tmp_path / "bottle.stl"
    qr.io.write_mesh(
        0.04 * (vertices - vertices.mean(axis=0)) + np.mean(joints, axis=0), faces, path, unit="m"
    )
    words = ["grasp", str(saved), str(path), "--product-unit", "m", "--force", "5N", "--as-placed"]
    assert run(words) == 2
    assert "the product stands inside the hand" in capsys.readouterr().err.splitlines()[-1]


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_hand_grasps_with_the_force_asked_for(
    saved: Path, bottle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["grasp", str(saved), str(bottle), "--product-unit", "mm", "--target-error", "none"]
    out = tmp_path / "out"
    assert run([*words, "--force", "index=2N,ring=1N", "--out", str(out), "--no-pictures", "--json"]) == 0
    printed = capsys.readouterr()
    # What took long to read is said before.
    told = [line for line in printed.err.splitlines() if not line.startswith("reading ")]
    assert told[:3] == ["approach", "closing", "closing: 100%"]
    record = json.loads(printed.out)
    for digit, force in (("index", 2.0), ("ring", 1.0)):
        assert np.linalg.norm(record["digits"][digit]["force"]["value"]) == pytest.approx(force, rel=1e-2)
    assert record["missed"] == {}
    inputs = json.loads((out / "grasp.json").read_text())["inputs"]
    assert inputs["force"] == {"value": {"index": 2.0, "ring": 1.0}, "unit": "N"}
    assert (inputs["unit"], inputs["product_unit"], inputs["as_placed"]) == ("m", "mm", False)
    assert inputs["shift"] == {"value": [0.0, 0.0, 0.0], "unit": "m"}
    assert "contact.json" in {file.name for file in out.iterdir()} <= {*GRASP_FILES}
    # Far above the palm nothing is met: status 1, and the table says why.
    far = [*words, "--force", "5N", "--shift", "0,0,300mm"]
    assert run(far) == 1
    assert "does not meet the product" in capsys.readouterr().out
    assert run([*far, "--quiet", "--json"]) == 1
    told = capsys.readouterr()
    missed = json.loads(told.out)["missed"]
    assert told.err.startswith("error: ")
    assert all(f"{digit} {why}" in told.err for digit, why in missed.items())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "give one of --force and --overlap; given: neither"),
        (["--force", "5N", "--overlap", "1mm"], "given: both"),
        (["--force", "5"], "has no unit"),
        (["--force", "5N", "--shift", "0,0,3mm", "--as-placed"], "leave out --as-placed"),
        (
            ["--force", "pinky=5N"],
            "--force: the digit 'pinky' is not known; the nearest is 'little', of thumb, index, middle, ring,"
            " little",
        ),
        (["--force", "index=5N,index=6N"], "'index' stands there twice"),
        (["--force", "5N", "--start", "fits"], "the nearest is 'fist'"),
        (["--force", "5N", "--product-mass", "3"], "has no unit, expected kg or g after it, as in 0.3kg"),
        (["--force", "5N", "--product-mass", "-0.4kg"], "--product-mass: '-0.4kg' is not above 0"),
        (["--force", "-20N"], "--force: '-20N' is not above 0"),
        (["--overlap", "index=0mm"], "--overlap: '0mm' is not above 0"),
    ],
)
def test_a_grasp_that_makes_no_sense_is_one_line(
    saved: Path, bottle: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    assert run(["grasp", str(saved), str(bottle), "--product-unit", "mm", *words]) == 2
    assert message in capsys.readouterr().err.splitlines()[-1]


def test_digits_are_checked_before_a_file_is_read(
    saved: Path, bottle: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object, **__: object) -> qr.Hand:
        raise AssertionError("the work has begun")

    monkeypatch.setattr(qr, "read_hand", never)
    assert run(["grasp", str(saved), str(bottle), "--force", "thumb=8N,pinky=4N"]) == 2
    assert "--force: the digit 'pinky' is not known" in capsys.readouterr().err


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_grasp_that_did_not_end_solved_is_written_and_no_bad_input(
    saved: Path, bottle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib")
    words = ["--product-unit", "mm", "--start", "opposed", "--target-error", "none"]
    # The paper's constants have no solution there.
    words += ["--force", "thumb=4N,index=2N", "--response", "gaussian:height=0.8mm/N,width=5mm,cutoff=15mm"]
    assert run(["grasp", str(saved), str(bottle), *words, "--out", str(tmp_path)]) == 1
    assert capsys.readouterr().err.splitlines()[-1].startswith("error: the contact did not end solved: ray: ")
    assert (tmp_path / "grasp.png").exists()
