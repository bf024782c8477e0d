"""The Python of the README and of the pages runs as it stands."""

from __future__ import annotations

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
@pytest.mark.parametrize("depth", [0.3e-3, 1.5e-3, 2e-3, 3e-3])
def test_the_finger_with_its_bone_serves_every_depth(depth: float) -> None:
    (block,) = (block for block in python_of("docs/usage.md") if "qr.Body(" in block)
    names: dict[str, Any] = {"qr": qr}
    exec(compile(block, "docs/usage.md", "exec"), names)
    contact = qr.press(names["tip"], names["phone"], names["prepared"], [0, 0, 1], depth=depth)
    assert contact.status == "solved"


@pytest.mark.parametrize("place", [0, 1])
def test_the_python_about_threads_and_processes_runs(place: int, tmp_path: Path) -> None:
    script = tmp_path / "pipeline.py"
    script.write_text(python_of("docs/pipelines.md")[place])
    subprocess.run([sys.executable, script], cwd=tmp_path, timeout=120, check=True)
