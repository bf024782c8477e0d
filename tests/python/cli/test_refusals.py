"""Bad input is one line and status 2; what is wrong is named by its option."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")
pytest.importorskip("matplotlib")

from command_words import press_arguments, sweep_arguments
from quasirigid.cli import run

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "give one of --depths and --forces"),
        (["--depths", "1mm", "--forces", "1N"], "give one of --depths and --forces"),
        (["--depths", "1:2mm"], "not of the form first:last:count"),
        (["--depths", "1:2:1mm"], "not of the form first:last:count"),
        (
            ["--depths", "1:2:3"],
            "'1:2:3' has no unit, expected m, cm, mm, um or inch after it, as in 1:5:9mm",
        ),
        (["--depths", "-1:2:3mm"], "--depths: '-1:2:3mm' holds a depth below 0"),
        (
            ["--forces", "1:2:3 mm"],
            "'1:2:3 mm' has the unit 'mm', expected N, kN or mN after it, as in 1:5:9N",
        ),
        (["--forces", "0:2:3N"], "--forces: '0:2:3N' holds a force that is not above 0"),
    ],
)
def test_a_sweep_names_what_is_wrong(
    words: list[str], message: str, in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(sweep_arguments(*words)) == 2
    assert message in capsys.readouterr().err


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
    "more nodes than can be counted": (
        {"max_nodes": "9" * 20},
        f"max_nodes is {'9' * 20}, expected an integer of at most {sys.maxsize}\n",
    ),
    "axes without a point": ({"tilt_axes": "0,1,0"}, "--tilt-axes: '0,1,0' needs --tilt-point"),
    "half an axis": (
        {"tilt_point": "0,0,0mm", "tilt_axes": "0,1"},
        "--tilt-axes: '0,1' has 2 values, expected 3 values parted by commas",
    ),
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
