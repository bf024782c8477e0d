"""Presses to several depths or forces, one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

import numpy as np

from .. import _core
from .._check import as_choice, as_direction, as_vector, reals_or_empty, short
from .._progress import print_progress, reporter
from ..errors import QuasirigidError, ResponseError
from ..scene import check_scene
from ..skin import Body, Skin
from .ending import ContactStatus
from .options import ContactOptions, options_to_core
from .press import Start
from .result import Contact, ContactError
from .swept import Question, Sweep
from .warned import Warned, warn_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..obstacle import Obstacle
    from ..skin.elastic import ElasticSkin
    from ..surface import Surface

__all__ = ["SweepProgress", "sweep"]

SweepProgress = Callable[[int, int], object]

_SCALARS = (
    "depth",
    "normal_force",
    "contact_area",
    "max_pressure",
    "force_error",
    "area_error",
    "max_pressure_error",
    "seconds",
)


def sweep(
    surface: Surface,
    obstacle: Obstacle,
    skin: ElasticSkin,
    direction: ArrayLike,
    *,
    depths: ArrayLike | None = None,
    forces: ArrayLike | None = None,
    start: Start | Literal["infinity", "current"] = "infinity",
    options: ContactOptions | None = None,
    progress: SweepProgress | bool | None = None,
) -> Sweep:
    """Press to several depths or forces, each from what the one before left.

    Takes one of `depths` and `forces`. A step goes on on the refined mesh of the step before, which is cut
    where the rim of the contact comes to larger triangles. It begins on the given mesh where that step was on
    it, where its mesh did not meet the target (a sharp edge), or where the contact's radius has changed by
    half. Its figures are those of `press` within the estimated errors, to the bit with ``target_error=None``.
    A body that is not prepared is, once.

    Parameters
    ----------
    surface : Surface
        The undeformed skin.
    obstacle : Obstacle
        The product.
    skin : Skin, PreparedSkin or CombinedSkin
        Material and response.
    direction : (3,) array_like
        Direction in which the obstacle travels; normalised here.
    depths : (s,) array_like, optional
        Travel beyond the start (m, >= 0).
    forces : (s,) array_like, optional
        Force on the skin along the direction (N, > 0).
    start : {"infinity", "current"}
        Where each press begins, as for `press`.
    options : ContactOptions, optional
        How each is solved.
    progress : callable or bool, optional
        Called as ``progress(done, total)`` after each step; True prints to stderr.

    Returns
    -------
    Sweep
        The figures of every step.

    Raises
    ------
    ContactError
        For none or both of depths and forces, a value out of range, or what `press` raises at every step.
    ObstacleError
        As from `press`, where the obstacle cannot meet the skin.

    Warns
    -----
    QuasirigidWarning
        What `press` warns of at a step; `Sweep.warnings` keeps it. A step without figures is no warning:
        `Sweep.status` and `Sweep.messages` have it.

    Examples
    --------
    >>> import numpy as np
    >>> import quasirigid as qr
    >>> tip = qr.models.fingertip(edge_length=2e-3)
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    >>> plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
    >>> curve = qr.sweep(tip, plate, skin, [0, 0, 1], depths=[0.4e-3, 0.8e-3, 1.2e-3])
    >>> curve.status
    ('solved', 'solved', 'solved')
    >>> bool((np.diff(curve.normal_force) > 0).all())
    True
    """
    if (depths is None) == (forces is None):
        given = "neither" if depths is None else "both"
        raise ContactError(f"a sweep takes depths or forces; given: {given}")
    check_scene(surface, obstacle)
    num_threads = options_to_core(options).num_threads
    if isinstance(skin, Skin) and isinstance(skin.response, Body):
        skin = skin.prepared(surface, num_threads=num_threads)
    goal = "force" if depths is None else "depth"
    values = _values(f"{goal}s", forces if depths is None else depths, zero=goal == "depth")
    unit = as_direction("direction", direction, ContactError)
    question = Question(
        surface=surface,
        obstacle=obstacle,
        skin=skin,
        # As given: normalised twice it may be another to the bit.
        direction=as_vector("direction", direction, ContactError),
        goal=goal,
        values=values,
        start=as_choice("start", start, Start, ContactError),
        options=options,
    )
    report = reporter(progress, _print_step)
    rows, warm = _Rows(len(values), unit), _core.WarmStart()
    for step in range(len(values)):
        rows.solve(question, step, warm)
        if report is not None:
            report(step + 1, len(values))
    # What no step could answer was asked wrongly.
    if len(rows.errors) == len(values):
        raise rows.errors[0]
    return rows.sweep(question)


class _Rows:
    """The figures of a sweep under way."""

    def __init__(self, count: int, direction: NDArray[np.float64]) -> None:
        self.direction = direction
        self.scalars = {name: np.full(count, np.nan) for name in _SCALARS}
        self.vectors = {name: np.full((count, 3), np.nan) for name in ("force", "moment")}
        self.status: list[str] = []
        self.messages: list[str] = []
        self.warnings: list[tuple[Warned, ...]] = []
        self.errors: list[QuasirigidError] = []

    def solve(self, question: Question, step: int, warm: _core.WarmStart) -> None:
        """Solve one step and take its figures."""
        started = time.perf_counter()
        if question.goal == "depth":
            self.scalars["depth"][step] = question.values[step]
        try:
            contact = question.answer(step, warm)
        except (ContactError, ResponseError) as error:
            reached = error.contact if isinstance(error, ContactError) else None
            self.status.append("refused" if reached is None else "not_reached")
            self.messages.append(str(error))
            self.warnings.append(() if reached is None else reached.warnings)
            if reached is None:
                self.errors.append(error)
            warn_of(self.warnings[-1], stacklevel=3)
        else:
            self.status.append(contact.status.value)
            self.messages.append(contact.advice)
            self.warnings.append(contact.warnings)
            warn_of(contact.warnings, stacklevel=3)
            self._take(contact, step)
        self.scalars["seconds"][step] = time.perf_counter() - started

    def _take(self, contact: Contact, step: int) -> None:
        if contact.status not in (ContactStatus.SOLVED, ContactStatus.NO_CONTACT):
            return
        figures = {
            "depth": contact.depth,
            "normal_force": contact.force @ self.direction,
            "contact_area": contact.contact_area,
            "max_pressure": contact.max_pressure,
            "force_error": contact.accuracy.force_error,
            "area_error": contact.accuracy.area_error,
            "max_pressure_error": contact.accuracy.max_pressure_error,
        }
        for name, value in figures.items():
            if value is not None:
                self.scalars[name][step] = value
        for name, rows in self.vectors.items():
            rows[step] = getattr(contact, name)

    def sweep(self, question: Question) -> Sweep:
        """Return the figures."""
        return Sweep(
            asked=question.values,
            **self.scalars,
            **self.vectors,
            status=tuple(self.status),
            messages=tuple(self.messages),
            warnings=tuple(self.warnings),
            _question=question,
        )


def _values(name: str, values: ArrayLike | None, *, zero: bool) -> NDArray[np.float64]:
    """Return a row of finite numbers above 0, or from 0 on."""
    row = reals_or_empty(values)
    wanted = "numbers >= 0" if zero else "numbers > 0"
    if row.ndim != 1 or len(row) == 0:
        raise ContactError(f"{name} is {short(values)}, expected a row of {wanted}")
    good = np.isfinite(row) & ((row >= 0.0) if zero else (row > 0.0))
    if not good.all():
        step = int(np.flatnonzero(~good)[0])
        raise ContactError(f"{name}[{step}] is {row[step]}, expected finite {wanted}")
    return row


def _print_step(done: int, total: int) -> None:
    print_progress(f"{done} of {total} presses", is_last=done == total)
