"""Where results go: folders that take no file, a full or closed standard output, letters it has not."""

from __future__ import annotations

import errno
import json
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")
pytest.importorskip("matplotlib")

import quasirigid as qr
from command_words import press_arguments, sweep_arguments
from quasirigid.cli import run

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")


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


def test_a_folder_that_cannot_be_made_is_named(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(path: Path, *_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))

    monkeypatch.setattr(Path, "mkdir", fail)
    assert run(press_arguments(target_error="none", out="full")) == 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert told == "error: full cannot be read or written: No space left on device"


def test_a_file_in_the_place_of_the_output_is_refused(
    in_demo_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (in_demo_folder / "taken").write_text("mine")
    assert run(press_arguments(out="taken")) == 2
    assert "taken is a file" in capsys.readouterr().err
    assert (in_demo_folder / "taken").read_text() == "mine"
