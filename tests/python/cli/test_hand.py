"""`quasirigid hand`: what a hand holds, and the hand in a pose; what `hand` and `grasp` share."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.cli import run


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


def test_an_unknown_preset_offers_the_nearest(saved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["hand", str(saved), "--pose", "cilinder"]) == 2
    assert "the nearest is 'cylinder'" in capsys.readouterr().err


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
