"""What a sweep gave, and its steps solved again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from .._check import as_place
from .._frozen import Frozen
from ..errors import ResponseError
from .options import ContactOptions
from .press import Start, end_of, press_quietly
from .result import Contact, ContactError
from .warned import Warned

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from ..obstacle import Obstacle
    from ..skin.elastic import ElasticSkin
    from ..surface import Surface

__all__ = ["Question", "Sweep"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Question:
    """What is asked at every step."""

    surface: Surface
    obstacle: Obstacle
    skin: ElasticSkin
    direction: NDArray[np.float64]
    goal: str
    values: NDArray[np.float64]
    start: Start
    options: ContactOptions | None

    def answer(self, step: int, warm: _core.WarmStart) -> Contact:
        """Return the contact of a step from what the step before left."""
        goal = {self.goal: float(self.values[step])}
        return press_quietly(
            self.surface,
            self.obstacle,
            self.skin,
            self.direction,
            self.options,
            start=self.start,
            warm=warm,
            **goal,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep(Frozen):
    """What presses to several depths or forces gave: one row a step (s of them), in the order asked.

    A step that did not end solved has nan for its figures, and its message says why. ``sweep[i]`` is the
    `Contact` of step i with the figures of its row, solved again after the steps before it: all are best
    asked for in order (``for contact in sweep``). A step that is "refused" or "not_reached" has no contact:
    both raise what its message says (a `ContactError` with the largest contact where a force is out of
    reach); ``next`` of the same iterator then goes on with the step after it.

    Attributes
    ----------
    asked : (s,) float64
        Depth (m) or force (N) that each step was asked for.
    depth : (s,) float64
        Depth (m), as in `Contact`; nan where a force was not reached.
    force : (s, 3) float64
        Force on the skin (N).
    normal_force : (s,) float64
        Its part along the direction of the press (N).
    moment : (s, 3) float64
        Moment on the skin about the origin (N m).
    contact_area : (s,) float64
        Contact area (m²).
    max_pressure : (s,) float64
        Largest pressure (Pa).
    force_error, area_error, max_pressure_error : (s,) float64
        Estimated relative errors, as in `Accuracy`; nan where none was made, infinite of a peak at a sharp
        edge or a cut.
    seconds : (s,) float64
        Wall time (s).
    status : tuple of str
        Each the word of a `ContactStatus`, "not_reached" (a force out of reach), or "refused" where nothing
        could be solved.
    messages : tuple of str
        Why a step has no figures, and what to try; "" where it has.
    warnings : tuple of tuple of (category, message)
        What each step warned of, as in `Contact.warnings`.
    """

    asked: NDArray[np.float64]
    depth: NDArray[np.float64]
    force: NDArray[np.float64]
    normal_force: NDArray[np.float64]
    moment: NDArray[np.float64]
    contact_area: NDArray[np.float64]
    max_pressure: NDArray[np.float64]
    force_error: NDArray[np.float64]
    area_error: NDArray[np.float64]
    max_pressure_error: NDArray[np.float64]
    seconds: NDArray[np.float64]
    status: tuple[str, ...]
    messages: tuple[str, ...]
    warnings: tuple[tuple[Warned, ...], ...]
    _question: Question

    def __len__(self) -> int:
        """Return the number of steps."""
        return len(self.status)

    def __getitem__(self, step: int) -> Contact:
        """Return the contact of one step, solved again as it was: after all before it.

        Raises
        ------
        ContactError, ResponseError
            If the step has none.
        TypeError
            If `step` is no integer; an IndexError if there is no such step.
        """
        step, warm = as_place("step", step, len(self), "a sweep"), _core.WarmStart()
        options = self._question.options
        # A mesh taken as it is leaves nothing to the next step.
        is_warm = options is None or options.target_error is not None
        for before in range(step if is_warm else 0):
            with suppress(ContactError, ResponseError):
                self._question.answer(before, warm)
        return end_of(self._question.answer(step, warm), throw=False, stacklevel=2)

    def __iter__(self) -> Iterator[Contact]:
        """Solve one step after the other again.

        Raises
        ------
        ContactError, ResponseError
            At a step that has no contact; ``next`` goes on after it.
        """
        return _Steps(self._question)

    def summary(self) -> str:
        """Return a line for each step in mm, N and kPa as a text table, and what the steps warned of."""
        from ..io.summary import sweep_summary

        return sweep_summary(self)

    def save(
        self, folder: str | PathLike[str], *, inputs: Mapping[str, Any] | None = None
    ) -> tuple[Path, ...]:
        """Write the columns of `to_dataframe` into a folder, in SI.

        Parameters
        ----------
        folder : path
            The folder; made where it is missing. Files of these names are replaced, others stay. An earlier
            sweep.json goes first and the new one comes last: where it is, both files are of one sweep.
        inputs : mapping, optional
            What the sweep was computed from, for sweep.json.

        Returns
        -------
        tuple of Path
            sweep.csv, and sweep.json with the warnings of each step and the inputs.

        Raises
        ------
        OSError
            If the folder cannot be written to.
        """
        from ..io.sweeps import save_sweep

        return save_sweep(self, folder, inputs=inputs)

    def to_dataframe(self) -> Any:
        """Return a pandas DataFrame with one row a step."""
        from ..io.frame import sweep_dataframe

        return sweep_dataframe(self)

    def plot(self) -> Figure:
        """Return a matplotlib figure: force and contact area over the depth (extra `plot`)."""
        from ..plot.curves import sweep_figure

        return sweep_figure(self)

    def __repr__(self) -> str:
        """Return the number of steps, how many have figures, and the largest force on one line."""
        good = np.isfinite(self.normal_force)
        largest = f", up to {self.normal_force[good].max():.4g} N" if good.any() else ""
        return f"Sweep({len(self)} steps, {np.count_nonzero(good)} with figures{largest})"


class _Steps(Iterator[Contact]):
    """The contacts of a sweep; after a step that raised it goes on, which a generator does not."""

    def __init__(self, question: Question) -> None:
        self._question, self._warm, self._step = question, _core.WarmStart(), 0

    def __next__(self) -> Contact:
        if self._step == len(self._question.values):
            raise StopIteration
        self._step += 1
        return end_of(self._question.answer(self._step - 1, self._warm), throw=False, stacklevel=2)
