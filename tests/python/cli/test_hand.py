"""`quasirigid hand` and `grasp`: what a hand holds, the hand in a pose, and on a product."""

from __future__ import annotations

import io
import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.cli import run
from quasirigid.io.grasps import GRASP_FILES


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("hand") / "hand.glb"
    qr.models.hand(edge_length=4e-3).save(path)
    return path


def test_a_hand_is_told_and_written_in_a_pose(
    saved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pose = tmp_path / "pose.json"
    pose.write_text('{"unit": "deg", "index-finger-phalanx-proximal": {"flexion": 40}}', encoding="utf-8")
    out = tmp_path / "out"
    assert run(["hand", str(saved), "--pose", str(pose), "--out", str(out), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    hand = qr.read_hand(saved)
    assert record["side"] == "right"
    assert record["joint_names"] == list(hand.joint_names)
    assert len(record["joint_names"]) == record["joints"]
    assert set(record["region_names"]) == set(hand.labels)
    assert len(record["region_names"]) == record["regions"]
    assert record["vertices"] == len(hand.surface.vertices)
    assert record["wrist_to_middle_tip_joint"] == {"value": pytest.approx(hand.length), "unit": "m"}
    vertices, faces = qr.read_mesh(out / "posed.ply", unit="m")
    posed = hand.posed({"index-finger-phalanx-proximal": math.radians(40)})
    np.testing.assert_allclose(vertices, posed.surface.vertices, atol=1e-12)
    np.testing.assert_array_equal(faces, hand.surface.faces)
    assert (out / "hand.png").read_bytes()[:4] == b"\x89PNG"
    assert qr.read_hand(out / "hand.glb").side == "right"


def test_a_picture_that_fails_leaves_the_old_one(
    saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figure = pytest.importorskip("matplotlib.figure")

    def write_half(_: object, file: object, **__: object) -> None:
        with open(file, "wb") if isinstance(file, (str, Path)) else io.BytesIO() as stream:
            stream.write(b"half")
        raise OSError("no space left")

    monkeypatch.setattr(figure.Figure, "savefig", write_half)
    (tmp_path / "hand.png").write_bytes(b"old")
    assert run(["hand", str(saved), "--out", str(tmp_path)]) == 2
    assert (tmp_path / "hand.png").read_bytes() == b"old"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "no JSON"),
        ("[1]", "expected an object of joints"),
        ('{"wrist": 3}', 'its "unit" is None'),
        ('{"unit": ["deg"]}', "its \"unit\" is ['deg']"),
        ("[" * 100_000, "no JSON"),
        ('{"unit": "deg", "wrist": {"flexion": "much"}}', "flexion of wrist is 'much', expected a finite"),
        ('{"unit": "deg", "wrist": {"bend": 3}}', "the angle of wrist 'bend' is not known"),
        ('{"unit": "deg", "wrist": NaN}', "flexion of wrist is nan, expected a finite number"),
        ('{"unit": "rad", "wrist": ' + "9" * 400 + "}", "expected a finite number"),
    ],
)
def test_a_faulty_pose_file_is_one_line(
    saved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, message: str
) -> None:
    pose = tmp_path / "pose.json"
    pose.write_text(text, encoding="utf-8")
    assert run(["hand", str(saved), "--pose", str(pose)]) == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith(f"error: {pose}: ")
    assert message in error


@pytest.mark.parametrize("command", ["hand", "grasp"])
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: b"", "does not begin as a GLB"),
        (lambda data: data[:-100], "it ends after"),
        (lambda data: data.replace(b'"skins"', b'"other"'), "it has 0 skins"),
        (lambda data: data.replace(b'"wrist"', b'"waist"'), "it has no joint 'wrist'"),
    ],
)
def test_a_faulty_hand_file_is_one_line(
    saved: Path,
    bottle: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    command: str,
    change: Callable[[bytes], bytes],
    message: str,
) -> None:
    file = tmp_path / "hand.glb"
    file.write_bytes(change(saved.read_bytes()))
    words = [] if command == "hand" else [str(bottle), "--product-unit", "mm", "--force", "5N"]
    assert run([command, str(file), *words]) == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith(f"error: {file}: ")
    assert message in error


@pytest.mark.parametrize(
    ("words", "argument"),
    [
        (["hand", "no.glb"], "HAND"),
        (["hand", "built-in", "--pose", "no.json"], "--pose"),
        (["grasp", "no.glb", "bottle.stl"], "HAND"),
        (["grasp", "built-in", "no.stl"], "PRODUCT"),
        (["grasp", "hand.glb", "bottle.stl", "--rig", "no.npz"], "--rig"),
        (["grasp", "hand.glb", "bottle.stl", "--end", "no.json"], "--end"),
    ],
)
def test_a_missing_file_is_told_by_its_argument(
    saved: Path, bottle: Path, capsys: pytest.CaptureFixture[str], words: list[str], argument: str
) -> None:
    files = {"hand.glb": str(saved), "bottle.stl": str(bottle)}
    assert run([files.get(word, word) for word in words]) == 2
    (missing,) = (word for word in words if word.startswith("no."))
    assert capsys.readouterr().err == f"error: {argument}: there is no file {missing}\n"


@pytest.mark.parametrize(
    "words",
    [
        ["hand", "out/hand.glb", "--pose", "fist"],
        ["grasp", "out/hand.glb", "bottle.stl", "--force", "5N"],
        ["grasp", "built-in", "out/product.ply", "--force", "5N"],
        ["grasp", "built-in", "out/deformed.ply", "--force", "5N"],
    ],
)
def test_a_hand_or_product_is_not_replaced_by_a_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("out").mkdir()
    Path("bottle.stl").write_bytes(b"mine")
    (file,) = (word for word in words if word.startswith("out/"))
    Path(file).write_bytes(b"mine")
    assert run([*words, "--out", "out"]) == 2
    argument = "PRODUCT" if words[1] == "built-in" else "HAND"
    told = f"error: --out: {file} is read as {argument} and would be replaced: name another folder\n"
    assert capsys.readouterr().err == told
    assert Path(file).read_bytes() == b"mine"


@pytest.mark.parametrize("command", ["hand", "grasp"])
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--rig", "rig.npz"], "--rig: 'rig.npz' belongs to a mesh, the built-in hand has its own"),
        (["--unit", "furlong"], "--unit: 'furlong' is not known, expected m, cm, mm or inch"),
    ],
)
def test_options_of_a_mesh_are_checked_for_the_built_in_hand_too(
    bottle: Path, capsys: pytest.CaptureFixture[str], command: str, words: list[str], message: str
) -> None:
    more = [] if command == "hand" else [str(bottle), "--product-unit", "mm", "--force", "5N"]
    assert run([command, "built-in", *more, *words]) == 2
    assert capsys.readouterr().err.splitlines()[-1] == f"error: {message}"


@pytest.mark.parametrize("file", ["built-in", "hand.glb"])
def test_a_unit_of_what_is_in_metres_is_refused(
    saved: Path, capsys: pytest.CaptureFixture[str], file: str
) -> None:
    word = str(saved) if file == "hand.glb" else file
    assert run(["hand", word, "--unit", "mm"]) == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert error == f"error: --unit: 'mm' is of a mesh, but {word} is in m: leave it out"
    assert run(["hand", word, "--unit", "m", "--quiet"]) == 0


def test_a_word_that_is_no_hand_is_offered_the_built_in_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["hand", "builtin"]) == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert (
        error == "error: there is no hand 'builtin', expected built-in, a .glb file, or a mesh with its rig"
    )


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


@pytest.mark.parametrize("command", ["hand --pose", "grasp --start", "grasp --end"])
@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ("index", "the joint 'index' is not known; the nearest is 'index-finger-metacarpal'"),
        ("little", "the joint 'little' is not known; the nearest is 'pinky-finger-metacarpal'"),
        # Names of tip joints are nearer, but they move no skin.
        ("index-finger", "the joint 'index-finger' is not known; the nearest is 'index-finger-metacarpal'"),
        ("thumb-ip", "the joint 'thumb-ip' is not known; the nearest is 'thumb-"),
    ],
)
def test_a_joint_that_no_hand_has_is_told_by_its_file(
    saved: Path,
    bottle: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    command: str,
    joint: str,
    message: str,
) -> None:
    pose = tmp_path / "pose.json"
    pose.write_text(f'{{"unit": "deg", "{joint}": 10}}', encoding="utf-8")
    name, option = command.split()
    words = [] if name == "hand" else [str(bottle), "--product-unit", "mm", "--force", "5N"]
    assert run([name, str(saved), *words, option, str(pose)]) == 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith(f"error: {pose}: {message}")
    assert not told.endswith("-tip'")


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


def test_an_unknown_preset_offers_the_nearest(saved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["hand", str(saved), "--pose", "cilinder"]) == 2
    assert "the nearest is 'cylinder'" in capsys.readouterr().err


@pytest.fixture(scope="module")
def bottle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("product") / "bottle.stl"
    triangles = qr.models.bottle(edge_length=2e-3).triangles()
    assert triangles is not None
    qr.io.write_mesh(*triangles, path, unit="mm")
    return path


@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")
def test_a_hand_grasps_with_the_force_asked_for(
    saved: Path, bottle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["grasp", str(saved), str(bottle), "--product-unit", "mm", "--target-error", "none"]
    out = tmp_path / "out"
    assert run([*words, "--force", "index=2N,ring=1N", "--out", str(out), "--no-pictures", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
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
        (["--force", "5N", "--product-shear-modulus", "1MPa"], "needs --product-poisson-ratio too"),
        (["--force", "-20N"], "--force: '-20N' is not above 0"),
        (["--overlap", "index=0mm"], "--overlap: '0mm' is not above 0"),
    ],
)
def test_a_grasp_that_makes_no_sense_is_one_line(
    saved: Path, bottle: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    assert run(["grasp", str(saved), str(bottle), "--product-unit", "mm", *words]) == 2
    assert message in capsys.readouterr().err.splitlines()[-1]


def test_info_of_a_hand_file_names_the_command_for_hands(
    saved: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["info", str(saved), "--unit", "m"]) == 2
    assert f"`quasirigid hand {saved}` shows a hand" in capsys.readouterr().err


def test_a_press_of_a_hand_names_the_commands_for_hands(
    saved: Path, bottle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    press = "--unit m --product-unit mm --direction 0,0,-1 --depth 1mm --shear-modulus 60kPa"
    words = [str(bottle), *press.split(), "--poisson-ratio", "0.5"]
    assert run(["press", str(saved), *words]) == 2
    assert (
        "`quasirigid hand FILE --out FOLDER`, which writes posed.ply, reads hands" in capsys.readouterr().err
    )
    hand = qr.read_hand(saved).surface
    qr.io.write_mesh(hand.vertices, hand.faces, tmp_path / "hand.ply", unit="m")
    assert run(["press", str(tmp_path / "hand.ply"), *words, "--response", "body"]) == 2
    told = capsys.readouterr().err
    assert "--bone auto: the bone sticks" in told
    assert "give --bone FILE or none, or take `quasirigid grasp` for a whole hand" in told
    assert "of Python" not in told


@pytest.mark.filterwarnings("always::quasirigid.QuasirigidWarning")
def test_an_angle_out_of_reach_is_told_with_both_units(
    saved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pose = tmp_path / "pose.json"
    pose.write_text('{"unit": "deg", "index-finger-phalanx-distal": 170}', encoding="utf-8")
    assert run(["hand", str(saved), "--pose", str(pose)]) == 0
    told = capsys.readouterr().err
    assert "is 170 degrees, taken as" in told
    assert told.endswith("angles are in rad, of a file in its unit\n")


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
