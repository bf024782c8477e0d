"""The digits of a hand brought to what each shall hold."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ..contact.ending import ContactStatus
from ..contact.press import solve_quietly
from ..errors import HandError
from ..obstacle import Obstacle
from ..skin import Body, HalfSpace, Skin
from .joints import DIGITS
from .search import Search

if TYPE_CHECKING:
    from ..contact import Contact, ContactOptions
    from ..skin.elastic import ElasticSkin
    from ..skin.progress import Progress
    from .closing import Closing
    from .posed import PosedHand
    from .rotations import Floats

__all__ = ["Hold"]

_SAME = 1e-4  # of what a digit shall hold, where all poses have one mesh
_NEAR = 3e-2  # of it, where that is a start for such poses alone
_HELD = 8e-3  # of it, where each pose has meshes of its own
_MISSED = 1e-2  # of it: beyond, a digit is said to miss
_MOST_TRIALS = 60  # on the given mesh
_MOST_ROUNDS = 6  # with all options
_STEP = 1.5e-3  # m, of a hand of 0.19 m: a digit goes on by no more at once, or it steps through thin walls
_HERTZ = 2.0 / 3.0  # the power of a force that grows in a straight line with the depth


@dataclass(kw_only=True, eq=False)
class Hold:
    """A grasp under way.

    Attributes
    ----------
    closing : Closing
        The ways of the digits.
    obstacle, skin, options
        As for `close_hand`.
    wanted : dict of int to float
        What a digit shall hold, by its place in DIGITS: N, or m of overlap.
    by_force : bool
        Which of the two.
    report : callable or None
        Called as the work goes on.
    """

    closing: Closing
    obstacle: Obstacle
    skin: Skin
    options: ContactOptions
    wanted: dict[int, float]
    by_force: bool
    report: Progress | None
    shares: Floats = field(default_factory=lambda: np.zeros(len(DIGITS)))
    searches: dict[int, Search] = field(default_factory=dict)
    rounds: int = 0
    timings: dict[str, float] = field(default_factory=dict)
    posed: PosedHand = field(init=False)
    contact: Contact = field(init=False)

    def run(self) -> None:
        """Bring the digits to the product, to what they hold on the given mesh, then as the options say."""
        self._timed("approach", self._approach)
        tolerance = _NEAR if self._has_rounds else _SAME
        self._timed("search", lambda: self._settle(self._on_given_mesh, tolerance, _MOST_TRIALS))
        self._timed("rounds", self._finish)

    @property
    def _has_rounds(self) -> bool:
        """Whether forces are to be met once more, with other forces than those of the search."""
        is_body = isinstance(self.skin.response, Body)
        return self.by_force and (is_body or self.options.target_error is not None)

    def missed(self) -> dict[str, str]:
        """Return the digits that do not hold what they should, and why."""
        unit, size = ("N", 1.0) if self.by_force else ("mm", 1e3)
        reasons = {}
        for at, search in self.searches.items():
            value, most, wanted = (f"{size * one:.3g}" for one in (search.value, search.most, search.wanted))
            if search.missed == "start":
                reason = (
                    f"is at {value} of {wanted} {unit} when it is open: the product stands in it; "
                    "move the hand away"
                )
            elif search.missed == "end" and search.most == 0.0:
                reason = "does not meet the product on its way"
            elif search.missed == "end":
                reason = f"comes to {most} of {wanted} {unit} at the most on its way"
            elif search.error() > _MISSED:
                reason = (
                    f"stands at {value} of {wanted} {unit}: there it jumps from pose to pose, "
                    "as at an edge or a thin wall"
                )
            else:
                continue
            reasons[DIGITS[at]] = reason
        return reasons

    def _approach(self) -> None:
        self._tell("approach", 0.0)
        self._refuse_inside(self.closing.posed(self.shares))
        moving = np.isin(np.arange(len(DIGITS)), list(self.wanted))
        self.shares = self.closing.first_touch(self.obstacle, moving)
        for at, wanted in self.wanted.items():
            self.searches[at] = Search(
                wanted=wanted,
                power=_HERTZ if self.by_force else 1.0,
                share=float(self.shares[at]),
            )

    def _steps(self, values: Floats) -> Floats:
        """Return by how much (5,) each digit's share may grow at once: no wall is stepped through."""
        ways = np.full(len(DIGITS), _STEP * self.closing.scale)
        if any(values[at] == 0.0 for at in self.searches):
            reach = self.closing.reach
            ways = np.maximum(ways, self.closing.distances(self.shares, self.obstacle, reach))
        speeds = np.maximum(self.closing.speeds, _STEP)
        steps: Floats = np.minimum(ways / speeds, 1.0)
        return steps

    def _refuse_inside(self, posed: PosedHand) -> None:
        """Refuse a product inside the hand and a hand inside the product."""
        skin, box = posed.surface, self.obstacle.bounding_box
        near = np.ones(len(skin.vertices), dtype=bool)
        if box is not None:
            near = ((skin.vertices >= box[0]) & (skin.vertices <= box[1])).all(axis=1)
        within = self.obstacle.signed_distance(skin.vertices[near])[0] < 0.0
        if within.sum() > 0.5 * len(near):
            raise HandError(
                f"{within.sum()} of {len(near)} vertices of the hand stand in the product: check that both "
                "have the same unit, and move the hand"
            )
        if within.any() or box is None:
            return
        triangles = self.obstacle.triangles()
        corners = np.array(np.meshgrid(*box.T)).reshape(3, -1).T if triangles is None else triangles[0]
        hand = Obstacle.mesh(skin.vertices, skin.faces, check_crossings=False)
        if hand.signed_distance(corners[:1])[0][0] < 0.0 and (hand.signed_distance(corners)[0] < 0.0).all():
            raise HandError("the product stands inside the hand: check its unit and place")

    def _settle(self, measure: Callable[[], Floats], tolerance: float, most: int) -> None:
        """Move the digits until all have what they shall hold, or cannot get it; else to the best trial."""
        best = (len(self.searches) + 1, 0.0)
        for trial in range(most):
            self._tell("closing", trial / most)
            values = measure()
            before = self.shares.copy()
            if not np.isfinite(values).all():
                return
            steps = self._steps(values)
            for at, search in self.searches.items():
                search.take(float(values[at]), tolerance, step=float(steps[at]))
                self.shares[at] = search.share
            if (self.shares == before).all():
                return
            errors = [search.error() for search in self.searches.values() if not search.missed]
            off = sum(error > tolerance for error in errors) + len(self.searches) - len(errors)
            if (off, sum(errors)) < best:
                best, kept = (off, sum(errors)), (before, values)
            if all(one.missed or one.is_stuck or one.error() <= tolerance for one in self.searches.values()):
                break
        self.shares, values = kept
        for at, search in self.searches.items():
            search.share, search.value = float(self.shares[at]), float(values[at])
        measure()

    def _on_given_mesh(self) -> Floats:
        if not self.by_force:
            return np.maximum(-self.closing.distances(self.shares, self.obstacle), 0.0)
        skin = replace(self.skin, response=HalfSpace()) if isinstance(self.skin.response, Body) else self.skin
        return self._solve(skin, replace(self.options, target_error=None))

    def _finish(self) -> None:
        """Solve the whole hand as asked; go on with the digits, as its forces are not those of the search."""
        if not self.by_force:
            self._with_all_options()
        if not self._has_rounds:
            return
        for search in self.searches.values():
            search.begin_again()
        self._settle(self._with_all_options, _HELD, _MOST_ROUNDS)

    def _with_all_options(self) -> Floats:
        return self._solve(self.skin, self.options)

    def _solve(self, skin: Skin, options: ContactOptions) -> Floats:
        """Solve the contact of the whole hand; return the length of each digit's resultant (N)."""
        self.posed = self.closing.posed(self.shares)
        elastic: ElasticSkin = skin
        if isinstance(skin.response, Body):
            elastic = self.posed.skin(
                shear_modulus=skin.shear_modulus, poisson_ratio=skin.poisson_ratio, response=skin.response
            )
        self.contact = solve_quietly(self.posed.surface, self.obstacle, elastic, options)
        self.rounds += 1
        if self.contact.status is ContactStatus.NO_CONTACT:
            return np.zeros(len(DIGITS))
        parts = self.contact.by_label(self.closing.parts)
        return np.array([np.linalg.norm(parts[name].force) if name in parts else 0.0 for name in DIGITS])

    def _timed(self, name: str, work: Callable[[], None]) -> None:
        started = time.perf_counter()
        work()
        self.timings[name] = time.perf_counter() - started

    def _tell(self, what: str, done: float) -> None:
        if self.report is not None:
            self.report(what, done)
