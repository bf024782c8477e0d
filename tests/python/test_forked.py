"""Processes: a forked child has no threads of its parent, and results are the same in any."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from shapes import SKIN
from worker_tasks import forces, saved_forces, tip

DEADLINE = 120.0  # A child that hangs, hangs for ever.


def run_forked(work: Callable[[], None]) -> int:
    """Return the exit status of a child forked here that does `work`; it is ended where it hangs."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            work()
            status = 0
        finally:
            os._exit(status)
    end = time.monotonic() + DEADLINE
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return -signal.SIGKILL


pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")


@pytest.mark.parametrize("method", ["fork", "forkserver", "spawn"])
def test_processes_give_the_same_bits_however_they_begin(method: str) -> None:
    depths = [0.4e-3, 0.8e-3, 1.2e-3]
    expected = [forces(depth) for depth in depths]  # threads are at work here before any fork
    context = multiprocessing.get_context(method)
    with ProcessPoolExecutor(2, mp_context=context) as pool:
        found = list(pool.map(forces, depths, timeout=DEADLINE))
    np.testing.assert_array_equal(found, expected)


def test_a_child_of_a_child_has_threads_of_its_own() -> None:
    expected = forces(0.5e-3)

    def check() -> None:
        np.testing.assert_array_equal(forces(0.5e-3), expected)

    def generation() -> None:
        check()
        assert run_forked(check) == 0
        check()

    assert run_forked(generation) == 0


def test_threads_of_a_forked_child_work_side_by_side() -> None:
    expected = forces(0.5e-3)

    def check() -> None:
        with ThreadPoolExecutor(3) as pool:
            for found in pool.map(forces, [0.5e-3] * 6):
                np.testing.assert_array_equal(found, expected)

    assert run_forked(check) == 0


def test_a_fork_while_another_thread_is_at_work_does_not_hang() -> None:
    expected = forces(0.5e-3)

    def check() -> None:
        np.testing.assert_array_equal(forces(0.5e-3), expected)

    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(lambda: [forces(0.5e-3) for _ in range(4)])
        statuses = [run_forked(check) for _ in range(3)]
        running.result(timeout=DEADLINE)
    assert statuses == [0, 0, 0]


def test_a_prepared_skin_is_saved_once_and_loaded_by_each_worker(tmp_path: Path) -> None:
    surface = tip()
    path = tmp_path / "tip.npz"
    SKIN.prepared(surface, np.flatnonzero(surface.vertices[:, 2] < 0.0)).save(path)
    expected = saved_forces(path)
    for method in ("fork", "spawn"):
        with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context(method)) as pool:
            for found in pool.map(saved_forces, [path] * 3, timeout=DEADLINE):
                np.testing.assert_array_equal(found, expected)


def test_ctrl_c_reaches_a_forked_child() -> None:
    script = """
import os, signal, sys, threading, time
import numpy as np
import quasirigid as qr
rows = np.random.default_rng(0).normal(size=(1500, 1500))
matrix, q = rows @ rows.T, -np.ones(1500)
qr.solve_lcp(matrix[:200, :200], q[:200])
child = os.fork()
if child:
    sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
began = time.monotonic()
try:
    while True:
        qr.solve_lcp(matrix, q, options=qr.LcpOptions(crash=False))
except KeyboardInterrupt:
    sys.stdout.flush()
    os._exit(0)
"""
    done = subprocess.run([sys.executable, "-c", script], timeout=DEADLINE, check=False)
    assert done.returncode == 0
