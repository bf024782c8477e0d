"""Ctrl-C ends the command line and long work at once, without a traceback and with nothing half written."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")

import quasirigid as qr

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals as POSIX has them")

#: Seconds from the signal to the end.
PATIENCE = 0.3
#: Other processes may take the processors in some of them.
TRIES = 10
MAIN = "import sys; sys.argv[0] = 'quasirigid'; from quasirigid.__main__ import main; main()"
SCENE = (
    "handle.stl --unit m --product-unit mm --translate 0,19.2,-40mm --rotate 0,90,0deg --direction 0,0,1"
    " --shear-modulus 60kPa --poisson-ratio 0.5"
)
# Some seconds of work each, and what is on stderr while it is under way.
STAGES = {
    "preparation": (f"press mid.ply {SCENE} --depth 2mm --response body --prepared kept.npz", "body of "),
    "refinement": (
        f"press mid.ply {SCENE} --depth 2.5mm --target-error 0.0001"
        " --response layer:thickness=5mm,discretization=galerkin --out out",
        "pressing ...",
    ),
    "force search": (f"press fine.ply {SCENE} --force 20N --target-error none --out out", "pressing ..."),
    "sweep": (f"sweep fine.ply {SCENE} --depths 3:4:40mm --target-error none --out out", "2 of 40 presses"),
}


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with fine fingertips and a handle."""
    folder = tmp_path_factory.mktemp("scene")
    for name, edge_length in (("mid", 0.8e-3), ("fine", 0.35e-3)):
        tip = qr.models.fingertip(edge_length=edge_length)
        qr.io.write_mesh(tip.vertices, tip.faces, folder / f"{name}.ply", unit="m")
    handle = qr.models.cylinder_handle(edge_length=1e-3).triangles()
    assert handle is not None
    qr.io.write_mesh(*handle, folder / "handle.stl", unit="mm")
    return folder


def interrupted(code: str, words: Sequence[str], sign: str, folder: Path) -> tuple[float, int, str]:
    """Seconds to the end after a signal once `sign` is on stderr, exit status, and stderr."""
    with subprocess.Popen(
        [sys.executable, "-c", code, *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
    ) as running:
        assert running.stderr is not None
        told = ""
        while sign not in told:
            line = running.stderr.readline()
            assert line, f"it ended before: {told}"
            told += line
        time.sleep(0.05)
        sent = time.perf_counter()
        running.send_signal(signal.SIGINT)
        told += running.stderr.read()
        return time.perf_counter() - sent, running.wait(), told


@pytest.mark.parametrize(("command", "sign"), STAGES.values(), ids=STAGES.keys())
def test_every_stage_ends_at_once_with_nothing_half_written(command: str, sign: str, scene: Path) -> None:
    before = sorted(path.name for path in scene.iterdir())
    seconds = []
    for _ in range(TRIES):
        took, status, told = interrupted(MAIN, command.split(), sign, scene)
        assert status == 130
        assert told.splitlines()[-1] == "error: interrupted"
        assert "Traceback" not in told
        assert sorted(path.name for path in scene.iterdir()) == before
        seconds.append(took)
        if took < PATIENCE:
            break
    assert min(seconds) < PATIENCE, seconds


LCP = """
import sys
import numpy as np
import quasirigid as qr

n = 5000
x = np.arange(n)
matrix = np.exp(-np.abs(x[:, None] - x) / 300.0)
matrix[x, x] += 0.01
q = -1.0 - np.sin(x)
print("solving", file=sys.stderr, flush=True)
while True:
    qr.solve_lcp(matrix, q, method=sys.argv[1])
"""


# Work of a second and more, over and over.
FIGURES = {
    "signed distances": "points = np.full((1_000_000, 3), 0.3); work = lambda: mesh.signed_distance(points)",
    "definiteness": "matrix = np.eye(2500) + 1e-9; work = lambda: qr.definiteness(matrix)",
}
FIGURE = """
import sys
import numpy as np
import quasirigid as qr

mesh = qr.Obstacle.from_mesh(qr.models.fingertip(edge_length=0.35e-3))
exec(sys.argv[1])
print("working", file=sys.stderr, flush=True)
while True:
    work()
"""


@pytest.mark.parametrize(
    ("code", "argument"),
    [
        (LCP, "lemke"),
        (LCP, "block_pivoting"),
        (LCP, "projected_cg"),
        *((FIGURE, one) for one in FIGURES.values()),
    ],
    ids=["lemke", "block pivoting", "projected cg", *FIGURES],
)
def test_a_figure_that_takes_long_ends_at_once(code: str, argument: str, tmp_path: Path) -> None:
    seconds = []
    for _ in range(TRIES):
        took, _, told = interrupted(code, [argument], "ing", tmp_path)
        assert told.splitlines()[-1] == "KeyboardInterrupt"
        seconds.append(took)
        if took < PATIENCE:
            break
    assert min(seconds) < PATIENCE, seconds


# Imports of the package itself, of what it needs, and of the command line.
@pytest.mark.parametrize("module", ["numpy", "quasirigid.models.loft", "quasirigid.cli", "rich.console"])
def test_an_import_under_way_leaves_no_traceback(module: str, tmp_path: Path) -> None:
    code = (
        f"""
import sys, time

class Slow:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            print("importing", file=sys.stderr, flush=True)
            time.sleep(20.0)

sys.meta_path.insert(0, Slow())
"""
        + MAIN
    )
    took, status, told = interrupted(code, ["--version"], "importing", tmp_path)
    assert took < PATIENCE
    assert status in (130, -signal.SIGINT)
    assert told.splitlines() == ["importing", "error: interrupted"]
