"""The Python of the README and of the pages runs as it stands."""

from __future__ import annotations

import csv
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import quasirigid as qr

ROOT = Path(__file__).parents[2]


def python_of(page: str) -> list[str]:
    """Return the blocks of Python on a page."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(r"^```python\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["README.md", "docs/usage.md"])
def test_the_python_on_a_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = python_of(page)
    assert blocks
    # One after the other in one namespace, as a reader would type them.
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)


# Deep ones reach the cut end, and are no small strains any more.
@pytest.mark.filterwarnings("ignore::quasirigid.CutWarning", "ignore::quasirigid.DepthWarning")
def test_the_finger_with_its_bone_serves_every_depth() -> None:
    (block,) = (block for block in python_of("docs/usage.md") if "qr.Body(" in block)
    names: dict[str, Any] = {"qr": qr}
    exec(compile(block, "docs/usage.md", "exec"), names)
    for depth in (0.3e-3, 1.5e-3, 2e-3, 3e-3):
        contact = qr.press(names["tip"], names["phone"], names["prepared"], [0, 0, 1], depth=depth)
        assert contact.status == "solved"


def run_pipeline(place: int, folder: Path) -> None:
    """Run a script of the page on pipelines in a folder."""
    script = folder / "pipeline.py"
    script.write_text(python_of("docs/pipelines.md")[place])
    subprocess.run([sys.executable, script], cwd=folder, timeout=120, check=True)


@pytest.mark.parametrize("place", [0, 1])
def test_the_python_about_threads_and_processes_runs(place: int, tmp_path: Path) -> None:
    run_pipeline(place, tmp_path)


def test_many_scenes_of_the_page_have_a_row_each_and_go_on_where_they_ended(tmp_path: Path) -> None:
    run_pipeline(2, tmp_path)
    with (tmp_path / "results.csv").open(newline="") as file:
        status = [row["status"].partition(":")[0] for row in csv.DictReader(file)]
    assert status == ["solved", "solved", "ObstacleError"]
    # One is there, in words of ours; one was ended before its record was written.
    kept, ended = (tmp_path / "results" / f"ball {radius}" / "contact.json" for radius in (0.01, 0.005))
    kept.write_text(kept.read_text().replace('"solved"', '"kept"'))
    before = json.loads(ended.read_text())
    ended.unlink()
    run_pipeline(2, tmp_path)
    assert '"kept"' in kept.read_text()
    after = json.loads(ended.read_text())
    for name in ("force", "moment", "contact_area", "max_pressure", "travel"):
        assert after[name] == before[name]
