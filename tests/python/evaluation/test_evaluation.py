"""Tables of accuracy and of extreme cases: what they hold, when they are off, what they write."""

from __future__ import annotations

import json
import math
import pickle
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.errors import MissingExtraError
from quasirigid.evaluation.extremes import alone, flat
from quasirigid.evaluation.extremes.alone import row_of_alone
from quasirigid.evaluation.extremes.case import Case, ends_with, holds, near, row_of
from quasirigid.evaluation.extremes.lcps import natural_residual
from quasirigid.evaluation.extremes.problems import problems
from quasirigid.evaluation.extremes.run import all_cases, run_cases
from quasirigid.evaluation.extremes.scaling import off
from quasirigid.evaluation.ladder import picture, run
from quasirigid.evaluation.ladder.ellipse import EllipticHertz
from quasirigid.evaluation.ladder.pixels import pixel_tasks
from quasirigid.evaluation.ladder.rows import make_row, mark_knee
from quasirigid.evaluation.memo import remembered
from quasirigid.evaluation.text import as_error


class Panic(BaseException):
    """As panics of the core are: no `Exception`."""


@pytest.fixture(scope="module")
def accuracy() -> qr.Table:
    return qr.accuracy(quick=True)


@pytest.fixture(scope="module")
def stress() -> qr.Table:
    return qr.stress(quick=True)


def one_case(outcome: object) -> qr.Table:
    """The table of a single case that is judged so."""
    return run_cases([Case(group="test", name="one", judge=lambda: outcome)])


def test_a_quick_ladder_keeps_to_its_bounds(accuracy: qr.Table) -> None:
    assert [row for row in accuracy.rows if not row["ok"]] == []
    assert accuracy.ok


def test_a_ladder_has_every_reference_problem(accuracy: qr.Table) -> None:
    scenes = {row["scene"] for row in accuracy.rows}
    wanted = {"sphere", "crossed cylinders", "cylinder", "flat punch", "cone", "sphere with a core, nu = 0.5"}
    assert wanted <= scenes
    assert any(scene.startswith("sphere on a layer") for scene in scenes)


def test_finer_meshes_are_nearer_to_hertz(accuracy: qr.Table) -> None:
    for form in ("collocation", "galerkin"):
        errors = [
            row["force_error"]
            for row in accuracy.rows
            if (row["scene"], row["mesh"], row["discretization"]) == ("sphere", "as it is", form)
        ]
        assert errors == sorted(errors, reverse=True)
        assert len(errors) > 2


def test_one_row_is_the_knee(accuracy: qr.Table) -> None:
    knees = [row for row in accuracy.rows if row["knee"]]
    assert len(knees) == 1
    assert knees[0]["scene"] == "sphere"


def test_the_knee_is_where_the_slope_breaks() -> None:
    # Ten times less error for twice the time, then half of it for ten times the time.
    points = [(1.0, 1.0), (2.0, 0.1), (20.0, 0.05), (25.0, 0.2)]
    rows = [{"seconds": seconds, "force_error": error, "knee": False} for seconds, error in points]
    mark_knee(rows)
    assert [row["knee"] for row in rows] == [False, True, False, False]


def test_a_force_beyond_its_bound_is_off() -> None:
    assert make_row(scene="x", force_error=-0.01, limit=0.02)["ok"]
    assert not make_row(scene="x", force_error=-0.03, limit=0.02)["ok"]
    assert not make_row(scene="x", force_error=None, limit=0.02)["ok"]


def test_what_a_row_of_the_ladder_raises_is_a_row_that_is_off(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails() -> None:
        raise Panic("of a sudden")

    monkeypatch.setattr(
        run, "_PARTS", [lambda quick: [("first", fails), ("second", lambda: make_row(scene="x"))]]
    )
    calls: list[tuple[str, int, int]] = []
    table = qr.accuracy(progress=lambda *words: calls.append(words))
    assert [row["ok"] for row in table.rows] == [False, True]
    assert table.rows[0]["note"] == "Panic: of a sudden"
    assert "off: first, -, -: Panic: of a sudden" in str(table)
    assert calls == [("first", 1, 2), ("second", 2, 2)]


def test_a_table_can_be_pickled(accuracy: qr.Table) -> None:
    there = pickle.loads(pickle.dumps(accuracy))
    assert there.rows == accuracy.rows
    assert repr(there) == repr(accuracy)


def test_tamaas_is_measured_beside_it() -> None:
    pytest.importorskip("tamaas")
    errors = [work()["force_error"] for _, work in pixel_tasks(quick=True)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-3


def test_rows_cannot_be_changed_through_the_table(accuracy: qr.Table) -> None:
    accuracy.rows[0]["ok"] = False
    assert accuracy.ok


def test_a_ladder_is_saved_with_its_picture(accuracy: qr.Table, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    files = accuracy.save(tmp_path / "new")
    assert [file.name for file in files] == ["accuracy.json", "accuracy.png", "accuracy.md"]
    stored = json.loads((tmp_path / "new" / "accuracy.json").read_text())
    assert stored["ok"] is True
    assert [row["force"] for row in stored["rows"]] == [row["force"] for row in accuracy.rows]
    page = (tmp_path / "new" / "accuracy.md").read_text()
    assert "![" in page
    assert page.count("\n| ") > len(accuracy)
    assert (tmp_path / "new" / "accuracy.png").read_bytes().startswith(b"\x89PNG")


def test_without_matplotlib_the_table_is_saved_alone(
    accuracy: qr.Table, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(*_: object) -> None:
        raise MissingExtraError("pictures need matplotlib")

    monkeypatch.setattr(picture, "accuracy_figure", missing)
    files = accuracy.save(tmp_path)
    assert [file.name for file in files] == ["accuracy.json", "accuracy.md"]
    assert "![" not in (tmp_path / "accuracy.md").read_text()


def test_a_table_is_not_written_over_a_file(accuracy: qr.Table, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    with pytest.raises(NotADirectoryError, match="taken is a file"):
        accuracy.save(tmp_path / "taken")


def test_a_table_becomes_a_data_frame(accuracy: qr.Table) -> None:
    pytest.importorskip("pandas")
    frame = accuracy.to_dataframe()
    assert len(frame) == len(accuracy)
    assert frame["ok"].all()


def test_a_quick_stress_passes(stress: qr.Table) -> None:
    assert [row for row in stress.rows if not row["ok"]] == []
    groups = {row["group"] for row in stress.rows}
    wanted = {"modulus", "length", "place", "Poisson's ratio", "depth", "mesh", "contact", "product", "LCP"}
    assert wanted <= groups


def test_no_two_cases_have_the_same_name() -> None:
    names = [(case.group, case.name) for case in all_cases()]
    assert len(set(names)) == len(names)


def test_a_case_with_a_wrong_expectation_is_off(tmp_path: Path) -> None:
    table = one_case(near("one is two", 1.0, 0.5))
    assert not table.ok
    assert "1 of 1 cases are off" in str(table)
    assert repr(table) == "Table(stress: 1 rows, 1 off)"
    assert [file.name for file in table.save(tmp_path)] == ["stress.json", "stress.md"]
    assert json.loads((tmp_path / "stress.json").read_text())["ok"] is False


def test_an_error_that_is_no_number_is_off() -> None:
    assert not near("a number", math.nan, 1.0).ok
    assert near("exact", 0.0, 0.0).ok


@pytest.mark.parametrize("name", ["force", "contact_area", "max_pressure"])
def test_a_figure_that_is_no_number_is_off(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    figures = {"force": np.array([0.0, 0.0, 1.0]), "contact_area": 1.0, "max_pressure": 1.0}
    wanted: Any = SimpleNamespace(**figures)
    unknown: Any = SimpleNamespace(**(figures | {name: math.nan * figures[name]}))
    assert off(wanted, wanted) == 0.0
    assert math.isnan(off(unknown, wanted))
    for judge in ("_as_without", "length_judge", "modulus_judge"):
        monkeypatch.setattr(flat, judge, lambda *_: near("right", 0.5, 1.0))
    assert flat._all_scaled(lambda _: wanted, 1.0, far=False).ok
    monkeypatch.setattr(flat, "length_judge", lambda *_: near("wrong", off(unknown, wanted), 1.0))
    assert not flat._all_scaled(lambda _: wanted, 1.0, far=False).ok


@pytest.mark.parametrize("kind", [ZeroDivisionError, Panic, qr.SurfaceError])
def test_what_a_case_did_not_expect_is_a_row_and_no_abort(kind: type[BaseException]) -> None:
    def fails() -> None:
        raise kind("of a sudden")

    good = Case(group="test", name="after it", judge=lambda: holds("true", "true", True))
    table = run_cases([Case(group="test", name="one", judge=fails), good])
    first, second = table.rows
    assert not first["ok"]
    assert first["found"] == f"{kind.__name__}: of a sudden"
    assert second["ok"]


def test_an_interrupt_ends_the_run() -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_cases([Case(group="test", name="one", judge=interrupted)])


def test_an_ending_is_expected_by_its_class_and_words() -> None:
    def refused() -> None:
        raise qr.SurfaceError("face 3 refers to vertex 9")

    assert ends_with(refused, qr.SurfaceError, "vertex 9").ok
    assert ends_with(refused, qr.QuasirigidError, "vertex 9").ok
    assert not ends_with(refused, qr.SurfaceError, "vertex 8").ok
    assert not ends_with(lambda: 1, qr.SurfaceError, "vertex 9").ok
    # Another class is unexpected, so the runner makes a row of it.
    with pytest.raises(qr.SurfaceError):
        ends_with(refused, qr.ContactError, "vertex 9")


def test_a_case_of_its_own_process_gives_the_same_row() -> None:
    case = next(case for case in all_cases() if case.name == "Kostreva, n = 3, lemke")
    here, there = row_of(case), row_of_alone(case)
    for row in (here, there):
        del row["seconds"]
    assert here == there


def test_a_case_that_does_not_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(alone, "_PROGRAM", "import time; time.sleep(60)")
    row = row_of_alone(Case(group="test", name="for ever", judge=lambda: holds("", "", True), alone=0.2))
    assert not row["ok"]
    assert row["found"] == "nothing in 0.2 s"
    assert row["seconds"] < 30


def test_a_process_that_dies_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(alone, "_PROGRAM", "import sys; sys.exit('out of memory')")
    row = row_of_alone(Case(group="test", name="dies", judge=lambda: holds("", "", True), alone=30))
    assert not row["ok"]
    assert row["found"] == "status 1: out of memory"


def test_progress_counts_the_rows() -> None:
    calls: list[tuple[str, int, int]] = []
    cases = [Case(group="test", name=name, judge=lambda: holds("", "", True)) for name in ("a", "b")]
    run_cases(cases, lambda *words: calls.append(words))
    assert calls == [("test: a", 1, 2), ("test: b", 2, 2)]
    with pytest.raises(TypeError, match="progress is 3"):
        run_cases(cases, 3)


def test_the_natural_residual_is_computed_as_defined() -> None:
    matrix, vector = np.array([[2.0, 0.0], [0.0, 0.0]]), np.array([-4.0, 1.0])
    assert natural_residual(matrix, vector, np.array([2.0, 0.0])) == 0.0
    # w = (-2, 1): the first row is 2 off, of max(-q) = 4.
    assert natural_residual(matrix, vector, np.array([1.0, 0.0])) == 0.5
    # The second row has no entry: z = 3 counts by its largest entry, 0, and w = 1 is not missed.
    assert natural_residual(matrix, vector, np.array([2.0, 3.0])) == 0.0
    assert math.isnan(natural_residual(matrix, vector, np.array([2.0, math.nan])))


def test_chosen_answers_solve_their_problems() -> None:
    for problem in problems():
        if problem.solution is not None:
            assert natural_residual(problem.matrix, problem.vector, problem.solution) < 1e-13, problem.name
        assert not problem.symmetric or (problem.matrix == problem.matrix.T).all(), problem.name


def test_a_circle_is_the_ellipse_of_equal_radii() -> None:
    ellipse = EllipticHertz(long_radius=1.0 + 1e-7, short_radius=1.0, contact_modulus=2.0)
    circle = qr.reference.Hertz(radius=1.0, contact_modulus=2.0)
    assert ellipse.force(1e-3) == pytest.approx(circle.force(1e-3), rel=1e-6)
    assert ellipse.max_pressure(1e-3) == pytest.approx(circle.max_pressure(1e-3), rel=1e-6)
    assert ellipse.half_axes(1e-3) == pytest.approx((circle.contact_radius(1e-3),) * 2, rel=1e-6)


@pytest.mark.parametrize("ratio", [1.2, 4.0, 100.0])
def test_the_pressure_of_the_ellipse_closes_the_gap(ratio: float) -> None:
    approach, modulus = 1e-3, 3.0
    ellipse = EllipticHertz(long_radius=ratio, short_radius=1.0, contact_modulus=modulus)
    a, b = ellipse.half_axes(approach)
    peak = ellipse.max_pressure(approach)
    # Boussinesq about a point: u = 1 / (pi E*) times the integral of the pressure along all rays.
    count = 20_000
    around = (np.arange(count) + 0.5) / count * 2 * np.pi
    rays = 1 / np.sqrt(np.cos(around) ** 2 / a**2 + np.sin(around) ** 2 / b**2)
    middle = peak * (rays * np.pi / 4).mean() * 2 / modulus
    assert middle == pytest.approx(approach, rel=1e-9)
    for half_axis, other, radius in ((a, b, ratio), (b, a, 1.0)):
        # From the end of a half axis: chords of length L = B / A under p0 sqrt(B r - A r^2).
        turn = (np.arange(count) + 0.5) / count * np.pi - np.pi / 2
        curved = np.cos(turn) ** 2 / half_axis**2 + np.sin(turn) ** 2 / other**2
        chords = 2 * np.cos(turn) / half_axis / curved
        end = peak * (np.sqrt(curved) * np.pi / 8 * chords**2).mean() / modulus
        assert end == pytest.approx(approach - half_axis**2 / (2 * radius), rel=1e-6)


def test_a_run_leaves_nothing_for_the_next() -> None:
    made = []

    @remembered
    def prepared() -> int:
        made.append(1)
        return len(made)

    cases = [Case(group="test", name=name, judge=lambda: holds("", str(prepared()), True)) for name in "ab"]
    assert [row["found"] for row in run_cases(cases).rows] == ["1", "1"]
    assert [row["found"] for row in run_cases(cases).rows] == ["2", "2"]


def test_errors_are_percents_of_two_figures() -> None:
    words = [as_error(error) for error in (0.1234, -0.01234, 0.0996, None)]
    assert words == ["12 %", "1.2 %", "10 %", "-"]
    assert as_error(-0.0123, signed=True) == "-1.2 %"
    assert as_error(0.123, signed=True) == "+12 %"
