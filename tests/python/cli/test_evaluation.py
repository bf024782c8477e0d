"""The commands `accuracy` and `stress`: exit status, and files where they are asked for."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")

import quasirigid as qr
from quasirigid.cli import run
from quasirigid.evaluation.extremes.case import Case, near
from quasirigid.evaluation.extremes.run import run_cases


def table(*, error: float) -> qr.Table:
    """The table of one case that is to be exact to 1e-3."""
    return run_cases([Case(group="test", name="one", judge=lambda: near("exact", error, 1e-3))])


@pytest.mark.parametrize("command", ["accuracy", "stress"])
def test_a_row_that_is_off_is_status_1_and_said(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(qr, command, lambda **_: table(error=0.5), raising=False)
    assert run([command, "--out", str(tmp_path / "new")]) == 1
    printed = capsys.readouterr()
    assert printed.err == "error: 1 of 1 rows are off\n"
    assert "test: one" in printed.out
    # What was measured is kept all the same.
    assert json.loads((tmp_path / "new" / "stress.json").read_text())["ok"] is False


@pytest.mark.parametrize("command", ["accuracy", "stress"])
def test_all_rows_in_order_are_status_0(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = []

    def measured(*, quick: bool, progress: object) -> qr.Table:
        asked.append(quick)
        return table(error=0.0)

    monkeypatch.setattr(qr, command, measured, raising=False)
    assert run([command]) == 0
    assert run([command, "--quick"]) == 0
    assert asked == [False, True]
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("command", ["accuracy", "stress"])
def test_the_rows_are_printed_as_json(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = []

    def measured(*, quick: bool, progress: object) -> qr.Table:
        asked.append(progress)
        return table(error=0.0)

    monkeypatch.setattr(qr, command, measured, raising=False)
    assert run([command, "--json", "--quiet", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr()
    assert (asked, printed.err) == ([False], "")
    assert json.loads(printed.out) == json.loads((tmp_path / "stress.json").read_text())


@pytest.mark.parametrize("command", ["accuracy", "stress"])
def test_a_folder_that_is_a_file_is_refused_before_the_work(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def never(**_: object) -> qr.Table:
        raise AssertionError("the work has begun")

    monkeypatch.setattr(qr, command, never, raising=False)
    (tmp_path / "taken").write_text("")
    for out in ("taken", "taken/below"):
        assert run([command, "--out", str(tmp_path / out)]) == 2
        assert "taken is a file, expected a folder" in capsys.readouterr().err
