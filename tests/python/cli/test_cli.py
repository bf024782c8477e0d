"""The command line: its examples run, its files are there, and bad input is one line and status 2."""

from __future__ import annotations

import errno
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")
pytest.importorskip("matplotlib")

import quasirigid as qr
from quasirigid.cli import run
from quasirigid.cli.arguments import parse_response, rotation
from quasirigid.cli.console import refuse, show_warning
from quasirigid.evaluation.extremes.run import run_cases
from quasirigid.io import patch_table

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")

COMMANDS = [
    [],
    *(
        [name]
        for name in (
            "demo",
            "press",
            "sweep",
            "info",
            "repair",
            "hand",
            "grasp",
            "accuracy",
            "stress",
            "completion",
        )
    ),
]


DEMO = ["demo", "--quick", "--out", "demo-output"]


@pytest.fixture(scope="module")
def demo_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the demo has run."""
    folder = tmp_path_factory.mktemp("demo")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert run(DEMO) == 0
    return folder


@pytest.fixture
def in_demo_folder(demo_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(demo_folder)
    return demo_folder


def press_arguments(**changes: str | None) -> list[str]:
    """A press that works in the demo's folder, with options changed or (None) left out."""
    options: dict[str, str | None] = {
        "unit": "m",
        "product-unit": "mm",
        "translate": "0,19.2,-40mm",
        "rotate": "0,90,0deg",
        "direction": "0,0,1",
        "depth": "1.12mm",
        "shear-modulus": "60kPa",
        "poisson-ratio": "0.5",
        "out": "out",
    }
    options |= {name.replace("_", "-"): value for name, value in changes.items()}
    words = [word for name, value in options.items() if value is not None for word in (f"--{name}", value)]
    return ["press", "demo-output/fingertip.ply", "demo-output/handle.stl", *words, "--no-pictures"]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda words: " ".join(words) or "quasirigid")
def test_every_help_ends_with_an_example_that_works(
    command: list[str],
    in_demo_folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # What these two measure is looked at by test_evaluation.
    for name in ("accuracy", "stress"):
        monkeypatch.setattr(qr, name, lambda **_: run_cases([]), raising=False)
    assert run([*command, "--help"]) == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines() if line.strip()]
    assert lines[-2].startswith("Example")
    program, *arguments = shlex.split(lines[-1])
    assert program == "quasirigid"
    # The demo has just run for this folder.
    assert arguments == DEMO or run(arguments) == 0


def test_no_words_at_all_print_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([]) == 0
    assert "press" in capsys.readouterr().out


def test_the_demo_writes_pictures_files_and_meshes(demo_folder: Path) -> None:
    for name in ("handle", "phone"):
        names = {path.name for path in (demo_folder / "demo-output" / name).iterdir()}
        assert names == {
            "contact.json",
            "contact.npz",
            "deformed.ply",
            "deformed.vtp",
            "footprint.png",
            "product.ply",
            "responses.png",
            "skin.png",
        }
        document = json.loads((demo_folder / "demo-output" / name / "contact.json").read_text())
        assert document["status"] == "solved"
        # A fingertip of G = 60 kPa, 1.12 mm deep: about 1 N.
        assert 0.5 < document["force"]["value"][2] < 2.0
        assert document["inputs"]["response"] == "body"
    bone = qr.read_surface(demo_folder / "demo-output" / "bone.ply", unit="m")
    assert bone.is_closed


def test_a_press_prints_and_writes_the_same_figures_as_the_library(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(press_arguments(out="press-out")) == 0
    printed = capsys.readouterr()
    document = json.loads((in_demo_folder / "press-out" / "contact.json").read_text())

    surface = qr.read_surface("demo-output/fingertip.ply", unit="m")
    surface = surface.with_skin_mask(qr.skin_without_caps(surface))
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    handle = qr.read_obstacle("demo-output/handle.stl", unit="mm").moved(turn, [0.0, 19.2e-3, -40e-3])
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    contact = qr.press(surface, handle, skin, [0.0, 0.0, 1.0], depth=1.12e-3)
    # The command line's turn by 90 degrees has a cosine of 6e-17, not 0.
    assert document["force"]["value"] == pytest.approx(contact.force, rel=1e-9, abs=1e-9)
    assert f"{np.linalg.norm(contact.force):.4g} N ± " in printed.out
    assert f"{1e6 * contact.contact_area:.4g} mm² ± " in printed.out
    rows = [line.split() for line in printed.out.splitlines()]
    for area, unit in ((1e-4, "cm²"), (1e-6, "mm²")):
        mean = f"{1e-3 * contact.mean_pressure(area):.4g}"
        assert ["mean", "pressure", "over", "1", unit, mean, "kPa"] in rows
    assert patch_table(contact) in printed.out
    for written, patch in zip(document["patches"], contact.patches, strict=True):
        assert written["force"]["value"] == pytest.approx(patch.force, rel=1e-9, abs=1e-9)
        assert written["mean_pressure"] == {"value": pytest.approx(patch.mean_pressure), "unit": "Pa"}
    assert document["accuracy"]["force_error"]["value"] == pytest.approx(
        contact.accuracy.force_error, rel=1e-6
    )
    assert document["inputs"]["depth"] == {"value": pytest.approx(1.12e-3), "unit": "m"}
    assert printed.err == "" or printed.err.endswith("...\n")


def test_a_press_takes_a_force_or_an_overlap_in_place_of_a_depth(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(press_arguments(depth=None, force="2N", out="by-force")) == 0
    document = json.loads((in_demo_folder / "by-force" / "contact.json").read_text())
    assert document["force"]["value"][2] == pytest.approx(2.0, rel=1e-6)
    assert document["depth"]["value"] > 0.0
    assert document["inputs"]["force"] == {"value": 2.0, "unit": "N"}
    assert run(press_arguments(depth=None, overlap="1.12mm", out="by-overlap")) == 0
    document = json.loads((in_demo_folder / "by-overlap" / "contact.json").read_text())
    assert document["max_penetration_before"]["value"] == pytest.approx(1.12e-3, rel=1e-6)
    capsys.readouterr()
    for goals in ({}, {"depth": "1mm", "force": "2N"}):
        assert run(press_arguments(**{"depth": None, **goals})) == 2
        assert "give one of --depth, --force and --overlap" in capsys.readouterr().err


def test_results_are_told_though_no_file_can_be_written(
    in_demo_folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device", "out")

    monkeypatch.setattr("quasirigid.io.write.write_files", full)
    asked = press_arguments(response="half-space", bone=None, fixed=None, out="full")
    assert run([*asked, "--json"]) == 2
    printed = capsys.readouterr()
    assert json.loads(printed.out)["status"] == "solved"
    assert "No space left on device" in printed.err


def test_an_empty_word_is_no_folder(in_demo_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(press_arguments(out="")) == 2
    assert "empty" in capsys.readouterr().err
    assert not (in_demo_folder / "contact.json").exists()


def sweep_arguments(*words: str) -> list[str]:
    """A sweep of the scene of `press_arguments`, whose goal and folder are in `words`."""
    arguments = press_arguments(depth=None, out=None)
    return ["sweep", *arguments[1:-1], *words]


def test_a_sweep_prints_and_writes_a_row_for_each_step(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(sweep_arguments("--depths", "0.4:1.2:3mm", "--out", "sweep-out")) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[0].split()[:2] == ["depth", "(mm)"]
    assert [line.split()[0] for line in printed[1:4]] == ["0.4", "0.8", "1.2"]
    header, *rows = (in_demo_folder / "sweep-out" / "sweep.csv").read_text().splitlines()
    assert header.startswith("depth (m),normal_force (N),force_x (N),")
    assert [float(row.split(",")[0]) for row in rows] == pytest.approx([0.4e-3, 0.8e-3, 1.2e-3])
    document = json.loads((in_demo_folder / "sweep-out" / "sweep.json").read_text())
    forces = document["columns"]["normal_force (N)"]
    assert forces == [float(row.split(",")[1]) for row in rows]
    assert 0.0 < forces[0] < forces[1] < forces[2]
    assert document["inputs"]["depths"]["unit"] == "m"
    assert run(sweep_arguments("--forces", "0.5,1N")) == 0
    assert [line.split()[1] for line in capsys.readouterr().out.splitlines()[1:]] == ["0.5", "1"]


def test_a_sweep_is_written_before_a_full_stdout_is_met(in_demo_folder: Path) -> None:
    words = sweep_arguments("--depths", "0.4mm", "--out", "sweep-full", "--target-error", "none")
    with open("/dev/full", "w") as full:
        program = [sys.executable, "-m", "quasirigid"]
        done = subprocess.run([*program, *words], stdout=full, stderr=subprocess.PIPE)
    assert done.returncode != 0
    assert b"error: standard output cannot be written to: No space left" in done.stderr
    assert (in_demo_folder / "sweep-full" / "sweep.csv").is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="its shell closes no stdout")
def test_results_that_a_closed_stdout_loses_are_an_error(in_demo_folder: Path) -> None:
    words = press_arguments(target_error="none", out="closed-stdout")
    program = shlex.join([sys.executable, "-m", "quasirigid", *words])
    done = subprocess.run(f"{program} >&-", shell=True, stderr=subprocess.PIPE)
    assert done.returncode == 2
    assert b"error: standard output is closed, so no results are printed" in done.stderr
    assert (in_demo_folder / "closed-stdout" / "contact.json").is_file()


@pytest.mark.parametrize("encoding", ["cp932", "ascii"])
def test_a_terminal_without_our_letters_gets_a_question_mark(encoding: str, in_demo_folder: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "quasirigid", *press_arguments(target_error="none", out="out")],
        capture_output=True,
        env=os.environ | {"PYTHONIOENCODING": encoding},
    )
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False)
    assert b"contact area" in done.stdout
    assert b" mm?" in done.stdout


def close(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Make a folder that takes no file, as for root no permission does."""
    made = tempfile.TemporaryFile

    def refused(dir: Path) -> Any:
        if dir.resolve() == folder.resolve():
            raise PermissionError(errno.EACCES, "Permission denied", str(dir))
        return made(dir=dir)

    folder.mkdir(exist_ok=True)
    monkeypatch.setattr("tempfile.TemporaryFile", refused)


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ({"out": "taken/out"}, "--out: taken is a file, expected a folder"),
        ({"prepared": "missing/body.npz"}, "--prepared: there is no folder missing"),
        ({"prepared": "demo-output"}, "--prepared: demo-output is a folder, expected a file"),
        ({"prepared": "closed/body.npz"}, "--prepared: closed cannot be written to: name another folder"),
        ({"out": "closed/out"}, "--out: closed cannot be written to: name another folder"),
        pytest.param(
            {"out": "/proc/out"},
            "--out: /proc cannot be written to: name another folder",
            marks=pytest.mark.skipif(sys.platform != "linux", reason="others have no /proc"),
        ),
    ],
)
def test_a_place_that_cannot_be_written_is_refused_before_the_work(
    option: dict[str, str | None],
    message: str,
    in_demo_folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def never(*_: object, **__: object) -> qr.Surface:
        raise AssertionError("the work has begun")

    (in_demo_folder / "taken").write_text("")
    close(in_demo_folder / "closed", monkeypatch)
    monkeypatch.setattr(qr, "read_surface", never)
    assert run(press_arguments(response="body", **option)) == 2
    assert message in capsys.readouterr().err


def test_a_repaired_mesh_is_not_made_for_a_folder_that_takes_no_file(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    close(in_demo_folder / "closed", monkeypatch)
    monkeypatch.setattr(qr, "read_mesh", None)
    words = ["demo-output/fingertip.ply", "--unit", "m", "--out", "closed/mended.ply"]
    assert run(["repair", *words]) == 2
    assert "--out: closed cannot be written to: name another folder" in capsys.readouterr().err


def test_a_missing_folder_is_told_by_the_file_that_was_meant(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["demo-output/fingertip.ply", "--unit", "m", "--out", "missing/mended.ply"]
    assert run(["repair", *words]) == 2
    assert "--out: there is no folder missing" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "give one of --depths and --forces"),
        (["--depths", "1mm", "--forces", "1N"], "give one of --depths and --forces"),
        (["--depths", "1:2mm"], "not of the form first:last:count"),
        (["--depths", "1:2:1mm"], "not of the form first:last:count"),
        (
            ["--depths", "1:2:3"],
            "'1:2:3' has no unit, expected m, cm, mm, um or inch after it, as in 1:2:3mm",
        ),
        (["--depths", "-1:2:3mm"], "--depths: '-1:2:3mm' holds a depth below 0"),
        (
            ["--forces", "1:2:3 mm"],
            "'1:2:3 mm' has the unit 'mm', expected N, kN or mN after it, as in 1:2:3N",
        ),
        (["--forces", "0:2:3N"], "--forces: '0:2:3N' holds a force that is not above 0"),
    ],
)
def test_a_sweep_names_what_is_wrong(
    words: list[str], message: str, in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(sweep_arguments(*words)) == 2
    assert message in capsys.readouterr().err


def test_a_target_error_refines_as_far_as_asked(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rounds = {}
    for target in ("none", "0.05", "0.005"):
        assert run(press_arguments(target_error=target, out="target")) == 0
        lines = capsys.readouterr().out.splitlines()
        document = json.loads((in_demo_folder / "target" / "contact.json").read_text())
        refinements = [one for one in document["refinements"] if one["kind"] == "mesh"]
        rounds[target] = len(refinements)
        asked = None if target == "none" else float(target)
        assert document["inputs"]["target_error"] == {"value": asked, "unit": "1"}
        # The table has a line for each mesh, where there is more than one.
        table = [line.split() for line in lines if line.startswith(("given ", "round "))]
        assert len(table) == (0 if target == "none" else len(refinements))
        if asked is not None:
            assert document["accuracy"]["mesh_error"]["value"] <= asked
            assert document["accuracy"]["area_error"]["value"] <= asked
            numbers = [words[1] if words[0] == "given" else words[2] for words in table]
            assert numbers == [str(one["nodes"]) for one in refinements]
    assert rounds["none"] == 1 < rounds["0.05"] < rounds["0.005"]


def test_a_body_is_pressed_with_a_bone_drawn_read_or_left_out(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    forces = {}
    for bone in ("auto", "demo-output/bone.ply", "none"):
        assert run(press_arguments(response="body", bone=bone, fixed="caps", out="body")) == 0
        printed = capsys.readouterr()
        # What it costs is told before it is paid.
        assert printed.err.startswith("body of ")
        assert "solution: 100%" in printed.err
        document = json.loads((in_demo_folder / "body" / "contact.json").read_text())
        assert (document["inputs"]["bone"], document["inputs"]["fixed"]) == (bone, "caps")
        forces[bone] = document["force"]["value"][2]
    # The demo wrote the bone that is drawn by itself; without it the finger is softer.
    assert forces["demo-output/bone.ply"] == pytest.approx(forces["auto"], rel=1e-4)
    assert forces["none"] < 0.97 * forces["auto"]
    surface = qr.read_surface("demo-output/fingertip.ply", unit="m")
    np.save("fixed.npy", surface.vertices[:, 1] < 3e-3)
    assert run(press_arguments(response="body", fixed="fixed.npy", out="body")) == 0


def test_a_body_out_of_reach_is_not_prepared(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = press_arguments(response="body", depth="0mm", start="current", out="apart")
    assert run(arguments) == 0
    assert "body of" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "response"),
    [
        ("half-space:discretization=galerkin", qr.HalfSpace(discretization="galerkin")),
        ("layer:thickness=5mm,discretization=galerkin", qr.Layer(thickness=5e-3, discretization="galerkin")),
        ("half-space", qr.HalfSpace()),
        ("body:coarse_edge_length=2mm", qr.Body(coarse_edge_length=2e-3)),
        ("body:coarse_edge_length=0mm", qr.Body(coarse_edge_length=0.0)),
        ("half-space:pressure=one_ring", qr.HalfSpace(pressure="one_ring")),
        ("layer:thickness=5mm", qr.Layer(thickness=5e-3)),
        (
            "gaussian:height=0.8mm/N,width=5mm,cutoff=15mm",
            qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3),
        ),
    ],
)
def test_a_response_is_parsed_from_name_and_constants(text: str, response: object) -> None:
    parsed = parse_response(text)
    assert type(parsed) is type(response)
    for name, value in vars(response).items():
        is_number = isinstance(value, float)
        assert getattr(parsed, name) == (pytest.approx(value) if is_number else value)


def test_a_turn_is_about_fixed_axes_x_then_y_then_z() -> None:
    turned = rotation([np.pi / 2, 0.0, np.pi / 2]) @ np.array([0.0, 1.0, 0.0])
    # About x: y to z; about z: z stays.
    assert turned == pytest.approx([0.0, 0.0, 1.0], abs=1e-15)


def test_a_mask_file_decides_what_may_touch(in_demo_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    surface = qr.read_surface("demo-output/fingertip.ply", unit="m")
    np.save("mask.npy", np.zeros(len(surface.vertices), dtype=bool))
    assert run(press_arguments(skin_mask="mask.npy", out="masked")) == 2
    capsys.readouterr()
    np.save("mask.npy", surface.vertices[:, 1] > 5e-3)
    assert run(press_arguments(skin_mask="mask.npy", out="masked")) == 0


BAD_INPUT = {
    "no unit on a length": ({"depth": "1.12"}, "--depth: '1.12' has no unit"),
    "a wrong unit": ({"shear_modulus": "60mm"}, "--shear-modulus: '60mm' is not a number with a unit"),
    "an unknown file unit": ({"unit": "km"}, "--unit: 'km' is not known, expected m, cm, mm or inch"),
    "two numbers for three": ({"direction": "0,1"}, "--direction: '0,1' has 2 values"),
    "a zero direction": ({"direction": "0,0,0"}, "--direction: '0,0,0' has no direction"),
    "a negative depth": ({"depth": "-1mm"}, "--depth: '-1mm' is below 0"),
    "no force": ({"depth": None, "force": "0N"}, "--force: '0N' is not above 0"),
    "a negative overlap": ({"depth": None, "overlap": "-1mm"}, "--overlap: '-1mm' is not above 0"),
    "no stiffness": ({"shear_modulus": "0kPa"}, "--shear-modulus: '0kPa' is not above 0"),
    "a ratio in words": ({"poisson_ratio": "half"}, "--poisson-ratio: 'half' is not a plain number"),
    "an impossible ratio": ({"poisson_ratio": "0.7"}, "--poisson-ratio: 0.7 is not from 0 to 0.5"),
    "an unknown response": (
        {"response": "jelly"},
        "--response: 'jelly' is not known, expected half-space, body, layer or gaussian",
    ),
    "a constant given twice": (
        {"response": "layer:thickness=1mm,thickness=2mm"},
        "--response: 'thickness' is given twice, 1mm and 2mm",
    ),
    "an unknown discretization": (
        {"response": "layer:thickness=5mm,discretization=wide"},
        "--response discretization: 'wide' is not known",
    ),
    "a discretization for a Gaussian": (
        {"response": "gaussian:height=0.8mm/N,width=5mm,cutoff=15mm,discretization=galerkin"},
        "gaussian has no constant 'discretization'",
    ),
    "a bone for a half-space": ({"bone": "auto"}, "--bone: 'auto' is of use to --response body alone"),
    "a hold for a layer": (
        {"response": "layer:thickness=5mm", "fixed": "caps"},
        "--fixed: 'caps' is of use to --response body alone",
    ),
    "a missing constant": ({"response": "gaussian:height=0.8mm/N,width=5mm"}, "gaussian needs cutoff"),
    "an unknown constant": (
        {"response": "half-space:cutoff=1mm"},
        "half-space has no constant 'cutoff', expected pressure, discretization",
    ),
    "a layer of nothing": (
        {"response": "layer:thickness=0mm"},
        "--response thickness: '0mm' is not above 0",
    ),
    "a Gaussian upside down": (
        {"response": "gaussian:height=-1mm/N,width=5mm,cutoff=15mm"},
        "--response height: '-1mm/N' is below 0",
    ),
    "an unknown basis": ({"response": "half-space:pressure=cubic"}, "'cubic' is not known"),
    "a constant for a body": ({"response": "body:thickness=5mm"}, "body has no constant 'thickness'"),
    "a body that nothing holds": (
        {"response": "body", "bone": "none", "fixed": "none"},
        "nothing holds the body",
    ),
    "a missing bone": ({"response": "body", "bone": "nowhere.ply"}, "--bone: there is no file nowhere.ply"),
    "a product for a bone": (
        {"response": "body", "bone": "demo-output/handle.stl"},
        "--bone: demo-output/handle.stl: bone 0 lies outside the skin",
    ),
    "an unknown hold": ({"response": "body", "fixed": "nails"}, "--fixed: 'nails' is not known"),
    "an unknown mask": ({"skin_mask": "nails"}, "--skin-mask: 'nails' is not known"),
    "a missing mask file": ({"skin_mask": "nowhere.npy"}, "--skin-mask: there is no file nowhere.npy"),
    "no target": ({"target_error": "fine"}, "--target-error: 'fine' is not a plain number"),
    "a target of nothing": ({"target_error": "0"}, "--target-error: 0 is not between 0 and 1"),
    "a target beyond all": ({"target_error": "2"}, "--target-error: 2 is not between 0 and 1"),
    "an unknown start": ({"start": "here"}, "--start: 'here' is not known"),
    "a missing option": ({"shear_modulus": None}, "Missing option '--shear-modulus'"),
    "a start in overlap": ({"start": "current", "translate": "0,19.2,-22mm"}, "penetrat"),
    "a product beside the skin": (
        {"translate": "0,500,-40mm"},
        "the skin is demo-output/fingertip.ply, the product demo-output/handle.stl: check their order,",
    ),
}


@pytest.mark.parametrize(("changes", "message"), BAD_INPUT.values(), ids=BAD_INPUT.keys())
def test_bad_input_is_one_line_and_status_2(
    changes: dict[str, str | None], message: str, in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(in_demo_folder.iterdir())
    assert run(press_arguments(**{"out": "refused", **changes})) == 2
    printed = capsys.readouterr()
    assert printed.err.startswith("error: ")
    assert printed.err.count("\n") == 1
    assert message in printed.err
    assert sorted(in_demo_folder.iterdir()) == before


def test_a_folder_that_cannot_be_made_is_named(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(path: Path, *_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))

    monkeypatch.setattr(Path, "mkdir", fail)
    assert run(press_arguments(target_error="none", out="full")) == 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert told == "error: full cannot be read or written: No space left on device"


@pytest.mark.parametrize(
    ("command", "told", "printed"),
    [
        ("press", "refine it (`target_error`, `max_nodes`)", "refine it (--target-error, --max-nodes)"),
        (
            "demo",
            "refine it (`target_error`, `max_nodes`)",
            "refine it (--target-error, `max_nodes` of Python)",
        ),
        ("grasp", "`couple_fingers` joins them", "--couple-fingers joins them"),
        ("sweep", "fix fewer (`Body(fixed=)`)", "fix fewer (--fixed)"),
        ("grasp", "fix fewer (`Body(fixed=)`)", "fix fewer (`Body(fixed=)` of Python)"),
        ("press", "let it touch (`skin_mask=`)", "let it touch (--skin-mask)"),
        ("press", "a smaller `gap_tolerance` will", "a smaller `gap_tolerance` of Python will"),
        ("info", '`unit="mm"` converts a file', "--unit converts a file"),
        ("hand", "give `rig`", "give --rig"),
        ("info", "see `repair`", "see `repair`"),
        (
            "info",
            "call `repair` with weld_tolerance = 8.3e-6 m",
            "call `repair` with --weld-tolerance 0.0083mm",
        ),
        (
            "press",
            "(`repair` with a weld_tolerance if they meet)",
            "(`repair` with a --weld-tolerance if they meet)",
        ),
        # What this command calls so looks for more crossings, not for fewer.
        (
            "info",
            "leave it out (check_crossings = false)",
            "leave it out (`check_crossings=False` of Python)",
        ),
    ],
)
def test_an_argument_of_the_library_is_told_as_an_option_or_as_pythons(
    command: str, told: str, printed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([command, "--help"]) == 0
    capsys.readouterr()
    refuse(told)
    show_warning(told)
    assert capsys.readouterr().err == f"error: {printed}\nwarning: {printed}\n"


@pytest.mark.parametrize("command", ["press", "sweep", "grasp"])
def test_no_message_of_a_contact_names_an_option_that_the_command_has_not(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    sources = sorted(Path(__file__).parents[3].glob("src/contact/**/*.rs"))
    lines = [line.strip() for source in sources for line in source.read_text("utf-8").splitlines()]
    messages = [line for line in lines if "`" in line and not line.startswith("//")]
    assert len(messages) > 5
    assert run([command, "--help"]) == 0
    options = set(re.findall(r"--[a-z][a-z-]+", capsys.readouterr().out))
    for message in messages:
        show_warning(message)
        told = capsys.readouterr().err
        assert {*re.findall(r"--[a-z][a-z-]+", told)} <= options
        named = re.findall(r"`([^`{]+)`( of Python)?", told)
        assert {name for name, of_python in named if not of_python} <= {"press", "repair"}


@pytest.mark.parametrize("changes", [{"skin_mask": "file.npy"}, {"response": "body", "fixed": "file.npy"}])
@pytest.mark.parametrize("content", ["empty", "several arrays", "a damaged header"])
def test_a_mask_file_that_holds_no_array_is_one_line(
    changes: dict[str, str | None], content: str, in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = in_demo_folder / "file.npy"
    with file.open("wb") as stream:
        if content == "several arrays":
            np.savez(stream, mask=np.ones(9, dtype=bool))
        elif content == "a damaged header":
            np.save(stream, np.ones(9, dtype=bool))
    file.write_bytes(file.read_bytes().replace(b", }", b",  "))
    assert run(press_arguments(**{"out": "refused", **changes})) == 2
    printed = capsys.readouterr().err
    assert f"{list(changes)[-1].replace('_', '-')}: file.npy is no NumPy array: " in printed
    assert printed.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["info", "nowhere.ply", "--unit", "m"], "MESH: there is no file nowhere.ply"),
        (["info", "demo-output", "--unit", "m"], "MESH: demo-output is a folder, expected a file"),
        (["info", "demo-output/fingertip.ply"], "Missing option '--unit'"),
        (["levitate"], "No such command 'levitate'"),
        (["demo", "--loud"], "--loud"),
    ],
)
def test_other_refusals_are_one_line_too(
    arguments: list[str], message: str, in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(arguments) == 2
    printed = capsys.readouterr()
    assert printed.err.count("\n") == 1
    assert message in printed.err


def test_a_file_in_the_place_of_the_output_is_refused(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (in_demo_folder / "taken").write_text("mine")
    assert run(press_arguments(out="taken")) == 2
    assert "taken is a file" in capsys.readouterr().err
    assert (in_demo_folder / "taken").read_text() == "mine"


def test_a_force_out_of_reach_writes_the_nearest_contact_and_status_1(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([*press_arguments(depth=None, force="1000kN", out="far"), "--json"]) == 1
    printed = capsys.readouterr()
    assert "largest" in printed.err.splitlines()[-1]
    document = json.loads((in_demo_folder / "far" / "contact.json").read_text())
    for record in (document, json.loads(printed.out)):
        assert record["status"] == "not_reached"
        assert "largest" in record["advice"]
    assert document["quasirigid"] == qr.__version__
    assert 0.0 < document["force"]["value"][2] < 1e6
    assert run(press_arguments(depth=None, force="1000kN", out="far")) == 1
    assert "status not_reached" in " ".join(capsys.readouterr().out.split())


@pytest.mark.filterwarnings("default::quasirigid.QuasirigidWarning")
def test_an_ending_without_result_is_written_and_status_1(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    gaussian = "gaussian:height=0.8mm/N,width=5mm,cutoff=15mm"
    assert run(press_arguments(response=gaussian, depth="2mm", out="ray")) == 1
    printed = capsys.readouterr()
    assert printed.err.startswith("warning: the Gaussian-corrected kernel")
    assert printed.err.splitlines()[-1].startswith("error: the contact did not end solved: ray: ")
    assert json.loads((in_demo_folder / "ray" / "contact.json").read_text())["status"] != "solved"


def test_info_names_the_defect_of_an_open_product(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (in_demo_folder / "open.obj").write_text("v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n")
    assert run(["info", "open.obj", "--unit", "mm"]) == 0
    printed = capsys.readouterr().out
    assert "size (mm)" in printed
    assert "9 x 9 x 0" in printed
    with pytest.raises(qr.ObstacleError) as refusal:
        qr.Obstacle.mesh(*qr.read_mesh("open.obj", unit="mm"))
    rows = dict(re.split("  +", line) for line in printed.splitlines()[1:])
    assert (rows["as skin"], rows["as product"]) == ("yes", "no")
    assert rows["why no product"] == str(refusal.value)
    assert all(line == line.rstrip() for line in printed.splitlines())


def test_info_as_json_is_in_si_with_units(in_demo_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (in_demo_folder / "sheet.obj").write_text("v 0 0 0\nv 9 0 0\nv 0 8 0\nf 1 2 3\n")
    assert run(["info", "sheet.obj", "--unit", "mm", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["size"] == {"value": pytest.approx([9e-3, 8e-3, 0.0]), "unit": "m"}
    assert record["area"] == {"value": pytest.approx(36e-6), "unit": "m^2"}
    assert record["volume"] == {"value": None, "unit": "m^3"}
    assert (record["closed"], record["as_skin"], record["as_product"]) == (False, True, False)
    assert record["why_no_skin"] is None
    assert "open" in record["why_no_product"]


@pytest.mark.parametrize("library", ["typer", "rich"])
def test_a_missing_extra_is_one_line_with_its_remedy(library: str) -> None:
    code = f"import sys; sys.modules['{library}'] = None; from quasirigid.__main__ import main; main()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "error: the command line needs typer and rich: pip install 'quasirigid[cli]'\n"


def test_pictures_without_matplotlib_are_one_line_with_its_remedy(
    in_demo_folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = press_arguments(out="refused")[:-1]
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for words in (arguments, ["demo", "--out", "refused"]):
        assert run(words) == 2
        assert capsys.readouterr().err == "error: pictures need matplotlib: pip install 'quasirigid[plot]'\n"
    assert not (in_demo_folder / "refused").exists()


def test_files_in_inches_and_centimetres_are_read(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for unit in ("inch", "cm"):
        tip = qr.models.fingertip(edge_length=3e-3)
        qr.io.write_mesh(tip.vertices, tip.faces, "tip.stl", unit=unit)
        assert run(["info", "tip.stl", "--unit", unit]) == 0
        assert "x 30 x" in capsys.readouterr().out


def test_the_package_itself_imports_no_extra() -> None:
    extras = ("matplotlib", "typer", "rich", "trimesh", "pandas", "pyvista")
    code = f"import sys, quasirigid; print([name for name in {extras} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.filterwarnings("always::quasirigid.QuasirigidWarning")
def test_the_size_of_a_mesh_in_another_unit_is_told(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["info", "demo-output/handle.stl", "--unit", "mm"]) == 0
    assert capsys.readouterr().err == ""
    assert run(["info", "demo-output/handle.stl", "--unit", "m"]) == 0
    assert "the mesh is 110 m long, outside the 0.001 to 3 m of products" in capsys.readouterr().err
