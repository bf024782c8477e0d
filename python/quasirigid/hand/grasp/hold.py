"""The digits of a hand brought to what each shall hold."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ... import _core
from ...contact.ending import ContactStatus
from ...contact.options import options_to_core
from ...contact.press import solve_quietly
from ...errors import HandError
from ...obstacle import Obstacle
from ...skin import Body, HalfSpace, Skin
from ..rig.joints import DIGITS, JOINTS_16
from .search import Search

if TYPE_CHECKING:
    from ..._arrays import Floats
    from ...contact import Contact, ContactOptions
    from ...contact.accuracy import Refinement
    from ...skin.elastic import ElasticSkin
    from ...skin.progress import Progress
    from ..posed import PosedHand
    from .closing import Closing

__all__ = ["Hold"]

_SAME = 1e-4  # of what a digit shall hold, where all poses have one mesh
_NEAR = 3e-2  # of it, where that is a start for such poses alone
_HELD = 8e-3  # of it, where each pose has meshes of its own
_MISSED = 1e-2  # of it: beyond, a digit is said to miss
_MOST_TRIALS = 60  # on the given mesh
_LARGE = 1500  # candidates there: with more a trial counts for several, as its time grows with their square
_SEARCH_LINEARIZATIONS = 2  # there, where that is a start alone
_MOST_ROUNDS = 8  # with all options
_STEP = 1.5e-3  # m, of a hand of REFERENCE_LENGTH: a digit that goes on by more at once steps through walls
_BESIDE = 8e-3  # m, of that hand: skin so near the product is where a body is solved most finely
_UNSOLVED = "has no force that is known: the contact ended with '{}'"  # of a digit, by the status
_MET = "target_error"  # reason of a mesh that is as fine as was asked
_ONE_FINENESS = 2.5  # nodes over a coarser mesh's, too few for the next finer one
_HERTZ = 2.0 / 3.0  # the power of a force that grows in a straight line with the depth


class Solved(NamedTuple):
    """A posed hand and its contact."""

    posed: PosedHand
    contact: Contact


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
    # Digits that stay inside the product, how deep (m).
    standing: dict[str, float] = field(default_factory=dict)
    timings: dict[str, float] = field(default_factory=dict)
    solved: Solved | None = None
    _meshes: dict[int, Refinement] = field(default_factory=dict)

    def run(self) -> Solved:
        """Bring the digits to the product, to what they hold on the given mesh, then as the options say."""
        self._timed("approach", self._approach)
        tolerance = _NEAR if self._has_rounds else _SAME
        air = self.closing.mesh_width if self.by_force else 0.0
        self._timed(
            "search",
            lambda: self._settle(self._on_given_mesh, tolerance, _MOST_TRIALS, air=air, large=_LARGE),
        )
        self._tell("closing", 1.0)
        self._timed("rounds", self._finish)
        assert self.solved is not None, "the last stage solves a contact"
        return self.solved

    @property
    def _has_rounds(self) -> bool:
        """Whether forces are to be met once more, with other forces than those of the search."""
        is_body = isinstance(self.skin.response, Body)
        return self.by_force and (is_body or self.options.target_error is not None)

    def missed(self) -> dict[str, str]:
        """Return the digits that do not hold what they should, and why."""
        status = ContactStatus.NO_CONTACT if self.solved is None else self.solved.contact.status
        if self.by_force and status not in (ContactStatus.SOLVED, ContactStatus.NO_CONTACT):
            return dict.fromkeys((DIGITS[at] for at in self.searches), _UNSOLVED.format(status))
        unit, size = ("N", 1.0) if self.by_force else ("mm", 1e3)
        reasons = {DIGITS[at]: search.reason(_MISSED, unit, size) for at, search in self.searches.items()}
        return {digit: reason for digit, reason in reasons.items() if reason}

    def _approach(self) -> None:
        self._tell("approach", 0.0)
        self._refuse_inside(self.closing.posed(self.shares))
        moving = np.isin(np.arange(len(DIGITS)), list(self.wanted))
        if not moving.all():
            deep = self._overlaps()
            self.standing = {DIGITS[at]: float(deep[at]) for at in np.flatnonzero(~moving & (deep > 0.0))}
        self.shares = self.closing.first_touch(self.obstacle, moving)
        for at, wanted in self.wanted.items():
            self.searches[at] = Search(
                wanted=wanted,
                power=_HERTZ if self.by_force else 1.0,
                share=float(self.shares[at]),
            )

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
        # Of a product that is the hand itself all vertices stand on its surface.
        hinges = [posed.frame_of(name)[:3, 3] for name in JOINTS_16[1:]]
        if (self.obstacle.signed_distance(hinges)[0] < 0.0).all():
            raise HandError(
                "the joints of all digits stand in the product, as in one that is the hand itself: check "
                "that it is the product, and move the hand"
            )
        if within.any() or box is None:
            return
        low, high = skin.vertices.min(axis=0), skin.vertices.max(axis=0)
        if (box[0] <= low).any() or (box[1] >= high).any():
            return
        triangles = self.obstacle.triangles()
        corners = np.array(np.meshgrid(*box.T)).reshape(3, -1).T if triangles is None else triangles[0]
        hand = Obstacle.mesh(skin.vertices, skin.faces, check_crossings=False)
        if hand.signed_distance(corners[:1])[0][0] < 0.0 and (hand.signed_distance(corners)[0] < 0.0).all():
            raise HandError("the product stands inside the hand: check its unit and place")

    def _settle(
        self,
        measure: Callable[[float], Floats],
        tolerance: float,
        most: int,
        *,
        air: float,
        large: float = np.inf,
    ) -> None:
        """Move the digits until all have what they shall hold, or cannot get it; else to the best trial.

        A digit that is farther from the product than `air` (m) holds nothing. Of `most` trials, one with more
        than `large` candidates counts for several; `measure` takes the share of them that is spent.
        """
        best = worst = (len(self.searches) + 1, 0.0)
        near, steps = self._look(self.searches)
        trials = 0.0
        while trials < most:
            values = measure(trials / most)
            size = 0 if self.solved is None else len(self.solved.contact.candidates)
            trials += max((size / large) ** 2, 1.0)
            before, lost = self.shares.copy(), self._lost
            if not np.isfinite(values).all():
                return
            for at, search in self.searches.items():
                search.take(float(values[at]), tolerance, step=float(steps[at]), depth=-float(near[at]))
                self.shares[at] = search.share
            moved = np.flatnonzero(self.shares != before)
            if not moved.size:
                return
            errors = [search.error() for search in self.searches.values() if not search.missed]
            score = (sum(error > tolerance for error in errors) + self._lost, sum(errors))
            if score < best:
                best, kept = score, (before, values, self.solved)
            near[moved], steps[moved] = self._through_air(moved.tolist(), tolerance, air)[:, moved]
            if self._lost > lost:
                # It went back to where it held the most.
                best = worst
            elif all(
                one.missed or one.is_stuck or one.error() <= tolerance for one in self.searches.values()
            ):
                break
        self.shares, values, self.solved = kept
        for at, search in self.searches.items():
            search.share, search.value = float(self.shares[at]), float(values[at])
            if trials >= most and size > large and not search.missed and search.error() > tolerance:
                search.missed = "trials"

    @property
    def _lost(self) -> int:
        """How many digits cannot hold what they should."""
        return sum(bool(search.missed) for search in self.searches.values())

    def _through_air(self, digits: list[int], tolerance: float, air: float) -> Floats:
        """Let digits apart from the product go on without a press; return what `_look` says of all (2, 5)."""
        found = np.zeros((2, len(DIGITS)))
        while digits:
            looked = self._look(digits)
            apart = []
            for at in digits:
                search, found[:, at] = self.searches[at], looked[:, at]
                near, step = looked[:, at].tolist()
                if near <= air or search.missed or search.is_stuck:
                    continue
                search.take(0.0, tolerance, step=step, depth=-near)
                if search.share != self.shares[at]:
                    self.shares[at] = search.share
                    apart.append(at)
            digits = apart
        return found

    def _look(self, digits: Iterable[int]) -> Floats:
        """Return how near the digits are (m) and by how much each share may go on (2, 5)."""
        looked = np.isin(np.arange(len(DIGITS)), list(digits))
        step = _STEP * self.closing.scale
        return np.array(self.closing.look(self.shares, self.obstacle, looked, least=step))

    def _on_given_mesh(self, done: float) -> Floats:
        self._tell("closing", done)
        if not self.by_force:
            return self._overlaps()
        skin = replace(self.skin, response=HalfSpace()) if isinstance(self.skin.response, Body) else self.skin
        options = replace(self.options, target_error=None)
        if self._has_rounds:
            rounds = min(_SEARCH_LINEARIZATIONS, options.max_linearizations)
            options = replace(options, max_linearizations=rounds)
        return self._solve(skin, options)

    def _overlaps(self) -> Floats:
        """Return how deep each digit stands in the product (m), through a wall thinner than that too."""
        surface = self.closing.posed(self.shares).surface
        deep = _core.overlaps(surface, self.obstacle, options_to_core(self.options))
        return np.array([deep[vertices].max(initial=0.0) for vertices in self.closing.vertices])

    def _finish(self) -> None:
        """Solve the whole hand as asked; go on with the digits, as its forces are not those of the search."""
        if not self.by_force:
            self._with_all_options()
        if not self._has_rounds:
            return
        for search in self.searches.values():
            search.begin_again()
        self._settle(self._with_all_options, _HELD, _MOST_ROUNDS, air=np.inf)
        for search in self.searches.values():
            search.end(_MISSED)

    def _with_all_options(self, _: float = 0.0) -> Floats:
        self._tell(f"contact {self.rounds + 1}, with all options", 0.0)
        values = self._solve(self.skin, self.options)
        assert self.solved is not None
        meshes = [one for one in self.solved.contact.refinements if one.kind == "mesh"]
        self._meshes[len(meshes)] = meshes[-1]
        if not self._has_uneven_meshes:
            return values
        coarsest = min(self._meshes)
        self._keep_meshes_as(self._meshes[coarsest])
        return self._solve(self.skin, self.options) if len(meshes) > coarsest else values

    @property
    def _has_uneven_meshes(self) -> bool:
        """Whether meshes ended with different finenesses, and one not as fine as was asked."""
        return len(self._meshes) > 1 and any(one.reason != _MET for one in self._meshes.values())

    def _keep_meshes_as(self, coarsest: Refinement) -> None:
        """Let no mesh be finer from now on: on an edge each refinement has other forces."""
        nodes = max(int(_ONE_FINENESS * coarsest.nodes), 1)
        self.options = replace(self.options, max_nodes=min(nodes, self.options.max_nodes))
        self._meshes.clear()
        for search in self.searches.values():
            search.begin_again()

    def _solve(self, skin: Skin, options: ContactOptions) -> Floats:
        """Solve the contact of the whole hand; return the length of each digit's resultant (N)."""
        posed = self.closing.posed(self.shares)
        elastic: ElasticSkin = skin
        if isinstance(skin.response, Body):
            away, _, _ = self.obstacle.signed_distance(posed.surface.vertices, _BESIDE * self.closing.scale)
            beside = np.flatnonzero(np.isfinite(away) & posed.surface.skin_mask)
            elastic = posed.skin(
                shear_modulus=skin.shear_modulus,
                poisson_ratio=skin.poisson_ratio,
                response=skin.response,
                nodes=beside if len(beside) else None,
                progress=self.report,
                num_threads=options.num_threads,
            )
        contact = solve_quietly(posed.surface, self.obstacle, elastic, options)
        self.solved = Solved(posed, contact)
        self.rounds += 1
        if contact.status is ContactStatus.NO_CONTACT:
            return np.zeros(len(DIGITS))
        parts = contact.by_label(self.closing.digits)
        return np.array(
            [np.linalg.norm(parts[at].force) if at in parts else 0.0 for at in range(len(DIGITS))]
        )

    def _timed(self, name: str, work: Callable[[], None]) -> None:
        started = time.perf_counter()
        work()
        self.timings[name] = time.perf_counter() - started

    def _tell(self, what: str, done: float) -> None:
        if self.report is not None:
            self.report(what, done)
