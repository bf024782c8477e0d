"""What the commands share: version, JSON, quiet, kept bodies, completion, closed pipes."""

from __future__ import annotations

import csv
import json
import re
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")

import quasirigid as qr
from quasirigid.cli import run
from quasirigid.cli.quantities import LENGTH, parse_quantities
from quasirigid.io.write import CONTACT_FILES

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")


def words(command: str, *more: str) -> list[str]:
    scene = (
        "tip.ply handle.stl --unit m --product-unit mm --translate 0,19.2,-40mm --rotate 0,90,0deg"
        " --direction 0,0,1 --shear-modulus 60kPa --poisson-ratio 0.5 --target-error none"
    )
    return [command, *scene.split(), *more]


def program(arguments: list[str], folder: Path) -> list[str]:
    code = "import sys; from quasirigid.__main__ import main; sys.argv[1:] = " + repr(arguments) + "; main()"
    return [sys.executable, "-c", code]


def test_the_version_and_the_short_help_are_there(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out == f"quasirigid {qr.__version__}\n"
    for command in ([], ["press"]):
        assert run([*command, "-h"]) == 0
        short = capsys.readouterr().out
        assert run([*command, "--help"]) == 0
        assert capsys.readouterr().out == short


def test_json_is_what_the_file_holds_and_nothing_else(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(words("press", "--depth", "1mm", "--json", "--out", "out", "--no-pictures")) == 0
    printed = json.loads(capsys.readouterr().out)
    written = json.loads((folder / "out" / "contact.json").read_text())
    for one in (printed, written):
        one.pop("timings")
        one["refinements"][0].pop("seconds")
        one["product"].pop("file", None)
    assert printed == written
    assert run(words("sweep", "--depths", "0.5,1mm", "--json", "--quiet")) == 0
    columns = json.loads(capsys.readouterr().out)["columns"]
    assert columns["depth (m)"] == pytest.approx([0.5e-3, 1e-3])
    assert run(["info", "tip.ply", "--unit", "m", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["vertices"] == len(
        qr.models.fingertip(edge_length=2e-3).vertices
    )


def test_a_sweep_prints_and_writes_why_a_press_failed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    steps = words("sweep", "--forces", "0.5,1e5N", "--out", "out", "--quiet")
    assert run(steps) == 1
    error = capsys.readouterr().err
    message = json.loads((folder / "out" / "sweep.json").read_text())["columns"]["message"]
    assert message[0] == ""
    assert "the largest force found is" in message[1]
    # On the command line in mm, in files in m.
    begin, depth, end = re.split(r"(?<= at a depth of )(\S+) m(?=;)", message[1])
    assert error == (
        "error: 1 of 2 presses did not end solved; the first is step 1, with 'not_reached': "
        f"{begin}{1e3 * float(depth):.12g} mm{end}\n"
    )
    header, *rows = csv.reader((folder / "out" / "sweep.csv").read_text().splitlines())
    assert header[-2:] == ["status", "message"]
    assert [row[-2:] for row in rows] == [["solved", ""], ["not_reached", message[1]]]


def test_without_a_folder_nothing_is_written(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = sorted(folder.iterdir())
    assert run(words("press", "--depth", "1mm")) == 0
    assert "wrote" not in capsys.readouterr().out
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize(
    ("changes", "argument", "replaced"),
    [
        ({"tip.ply": "out/deformed.ply"}, "SKIN", "out/deformed.ply"),
        ({"handle.stl": "out/product.ply"}, "PRODUCT", "out/product.ply"),
        # By another way to the same file.
        ({"tip.ply": "out/../out/deformed.ply"}, "SKIN", "out/deformed.ply"),
        ({"--bone": "out/product.ply"}, "--bone", "out/product.ply"),
        # Before it is there.
        ({"--prepared": "out/contact.npz"}, "--prepared", "out/contact.npz"),
        ({"--prepared": "tip.ply"}, "SKIN", "tip.ply"),
    ],
)
def test_a_press_does_not_replace_what_it_reads(
    changes: dict[str, str], argument: str, replaced: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "out").mkdir()
    for name in ("deformed.ply", "product.ply"):
        shutil.copy("tip.ply", f"out/{name}")
    before = {file: file.read_bytes() for file in folder.rglob("*.*")}
    given = [changes.get(word, word) for word in words("press", "--depth", "1mm", "--out", "out")]
    options = [word for name in changes if name.startswith("--") for word in (name, changes[name])]
    assert run([*given, "--response", "body", *options]) == 2
    option, kind = ("--prepared", "file") if replaced == "tip.ply" else ("--out", "folder")
    told = f"error: {option}: {replaced} is read as {argument} and would be replaced: name another {kind}\n"
    assert capsys.readouterr().err == told
    assert {file: file.read_bytes() for file in folder.rglob("*.*")} == before


def test_the_files_that_are_looked_after_are_those_that_are_written(folder: Path) -> None:
    pytest.importorskip("matplotlib")
    # Twice: results may replace older ones.
    for _ in range(2):
        assert run(words("press", "--depth", "1mm", "--out", "out")) == 0
    written = {file.name for file in (folder / "out").iterdir()}
    assert written == {*CONTACT_FILES} - {"deformed_product.ply"}


@pytest.mark.parametrize(
    ("changes", "argument"),
    [
        ({"tip.ply": "no.ply"}, "SKIN"),
        ({"handle.stl": "no.stl"}, "PRODUCT"),
        ({"--bone": "no.ply"}, "--bone"),
        ({"--fixed": "no.npy"}, "--fixed"),
        ({"--skin-mask": "no.npy"}, "--skin-mask"),
    ],
)
def test_a_missing_file_is_told_by_its_argument(
    changes: dict[str, str], argument: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = [changes.get(word, word) for word in words("press", "--depth", "1mm")]
    options = [word for name in changes if name.startswith("--") for word in (name, changes[name])]
    assert run([*given, "--response", "body", *options]) == 2
    assert capsys.readouterr().err == f"error: {argument}: there is no file {next(iter(changes.values()))}\n"


@pytest.mark.parametrize("command", ["press", "sweep"])
def test_a_warning_is_printed_once_and_quiet_leaves_it_out(
    command: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    goal = ["--depth", "0.1mm"] if command == "press" else ["--depths", "0.05,0.1mm"]

    def printed(*more: str) -> pytest.CaptureResult[str]:
        with warnings.catch_warnings():
            # As Python shows them by itself.
            warnings.simplefilter("default")
            assert run([*words(command, *goal), *more]) == 0
        return capsys.readouterr()

    loud = printed()
    assert ("1 of 2 presses" in loud.err) == (command == "sweep")
    told = [line for line in loud.err.splitlines() if line.startswith("warning: ")]
    assert len(told) == len({*told}) > 0
    assert any("mesh cells in its radius" in line for line in told)
    assert "warning" not in loud.out
    quiet = printed("--quiet")
    assert quiet.err == ""
    assert quiet.out.splitlines()[0] == loud.out.splitlines()[0]
    assert "warning" not in quiet.out
    # The next command is as loud as ever.
    assert "warning: " in printed().err


def test_what_was_left_out_is_one_line_unless_asked_for(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def left_out(*more: str) -> list[str]:
        assert run(words("press", "--depth", "1mm", *more)) == 0
        return [line for line in capsys.readouterr().out.splitlines() if line.startswith("left out: ")]

    (short,) = left_out()
    long = left_out("--verbose")
    assert len(long) > 1
    assert all("(" in line for line in long)
    names = [line.removeprefix("left out: ").split(" (")[0] for line in long]
    assert short == "left out: " + ", ".join(names)


def test_only_commands_that_show_contacts_take_verbose(capsys: pytest.CaptureFixture[str]) -> None:
    for command in ("demo", "press", "sweep", "info", "repair", "hand", "grasp", "accuracy", "stress"):
        assert run([command, "--help"]) == 0
        told = " ".join(capsys.readouterr().out.split())
        assert ("--verbose" in told) == (command in ("demo", "press", "grasp")), command
        assert "Exit status 0: " in told


def test_lengths_may_be_inches_and_centimetres() -> None:
    assert parse_quantities("2inch", 1, LENGTH, "--depth") == pytest.approx([0.0508])
    assert parse_quantities("0.2cm", 1, LENGTH, "--depth") == pytest.approx([2e-3])


def test_a_kept_body_is_read_again_and_grows_with_what_is_asked(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    body = ("--response", "body", "--prepared", "kept.npz", "--json")

    def pressed(depth: str, *more: str) -> tuple[float, str]:
        assert run(words("press", "--depth", depth, *body, *more)) == 0
        printed = capsys.readouterr()
        return json.loads(printed.out)["force"]["value"][2], printed.err

    first, told = pressed("0.5mm")
    assert "body of" in told
    few = len(qr.load_prepared("kept.npz").nodes)
    again, told = pressed("0.5mm")
    assert "body of" not in told
    assert again == pytest.approx(first, rel=1e-12)
    _, told = pressed("1.5mm")
    assert "body of" in told
    assert len(qr.load_prepared("kept.npz").nodes) > few
    shallow, told = pressed("0.5mm")
    assert "body of" not in told
    assert shallow == pytest.approx(first, rel=1e-6)
    kept = (folder / "kept.npz").read_bytes()
    for other, difference in (
        (("--shear-modulus", "50kPa"), "shear modulus (Pa) 60000.0, not 50000.0"),
        (("--poisson-ratio", "0.4"), "Poisson's ratio 0.5, not 0.4"),
        (("--bone", "none"), "another bone"),
        (("--fixed", "none"), "another fixed part"),
        (("--response", "body:discretization=galerkin"), "discretization collocation, not galerkin"),
    ):
        assert run(words("press", "--depth", "0.5mm", *body, *other)) == 2
        assert f"kept.npz holds a body of {difference}" in capsys.readouterr().err
    assert (folder / "kept.npz").read_bytes() == kept
    assert run(words("press", "--depth", "1mm", "--prepared", "kept.npz")) == 2
    assert "--prepared: 'kept.npz' is of use to --response body alone" in capsys.readouterr().err


def test_a_kept_body_is_read_where_none_can_be_written(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(**_: object) -> None:
        raise PermissionError("read-only")

    body = ("--response", "body", "--prepared", "kept/body.npz")
    (folder / "kept").mkdir()
    assert run(words("press", "--depth", "0.5mm", *body)) == 0
    monkeypatch.setattr("tempfile.TemporaryFile", refused)
    assert run(words("press", "--depth", "0.5mm", *body)) == 0
    capsys.readouterr()
    # More nodes than it holds: refused before they are prepared.
    assert run(words("press", "--depth", "1.5mm", *body)) == 2
    told = capsys.readouterr().err
    assert told == "error: --prepared: kept cannot be written to: name another folder\n"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_completion_script_knows_commands_and_options(
    shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["completion", shell]) == 0
    script = capsys.readouterr().out
    for word in ("press", "repair", "shear-modulus", "check-crossings", "no-pictures"):
        assert word in script
    if shutil.which(shell):
        check = subprocess.run([shell, "-n"], input=script, capture_output=True, text=True, check=False)
        assert (check.returncode, check.stderr) == (0, "")


@pytest.mark.skipif(not shutil.which("bash"), reason="no bash")
def test_bash_completes_what_is_begun(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["completion", "bash"]) == 0
    script = capsys.readouterr().out

    def completed(*line: str) -> list[str]:
        given = " ".join(f"'{word}'" for word in line)
        ask = f"COMP_WORDS=({given}); COMP_CWORD={len(line) - 1}; _quasirigid; echo ${{COMPREPLY[@]}}"
        done = subprocess.run(["bash", "-c", script + ask], capture_output=True, text=True, check=True)
        return done.stdout.split()

    assert completed("quasirigid", "pr") == ["press"]
    assert completed("quasirigid", "press", "--sh") == ["--shear-modulus"]
    assert completed("quasirigid", "press", "tip") == []


def test_another_shell_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["completion", "tcsh"]) == 2
    assert "expected bash, zsh or fish" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [["--help"], words("press", "--depth", "1mm", "--out", "out")])
def test_a_closed_pipe_is_no_failure(arguments: list[str], folder: Path) -> None:
    # The reader is gone before the first line.
    with subprocess.Popen(
        [*program([*arguments, "--no-pictures"] if len(arguments) > 1 else arguments, folder)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
    ) as running:
        assert running.stdout is not None
        assert running.stderr is not None
        running.stdout.close()
        told = running.stderr.read()
        assert running.wait() == 0
    assert "Traceback" not in told
    assert not any(line.startswith("error") for line in told.splitlines())
    if len(arguments) > 1:
        assert (folder / "out" / "contact.json").exists()
