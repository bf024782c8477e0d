"""The README's Python runs as it stands."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

README = Path(__file__).parents[2] / "README.md"
BLOCKS = re.findall(
    r"^```python\n(.*?)^```", README.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
)


def test_the_python_in_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert BLOCKS
    # One after the other in one namespace, as a reader would type them.
    names: dict[str, object] = {}
    for block in BLOCKS:
        exec(compile(block, str(README), "exec"), names)


PIPELINES = README.parent / "docs" / "pipelines.md"


@pytest.mark.parametrize("place", [0, 1])
def test_the_python_about_threads_and_processes_runs(place: int, tmp_path: Path) -> None:
    text = PIPELINES.read_text(encoding="utf-8")
    block = re.findall(r"^```python\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)[place]
    script = tmp_path / "pipeline.py"
    script.write_text(block)
    subprocess.run([sys.executable, script], cwd=tmp_path, timeout=120, check=True)
