"""How far a digit closes: the search for the share of its way at which it holds what it should."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Search"]

_CLOSEST = 1e-6  # shares of a way between which a digit can do no more
_CLOSE = 1e-5  # shares too close to each other for a slope between them
_BACK = 2.0  # steps that a digit may open at once
_OLD = 3  # trials after which a value may be no more
_STALE = 2  # brackets that closed and may have been stale
_STEADY = 3.0  # a slope that is known from another measure is right up to this factor
_FADED = 0.5  # of the most: a digit that goes deeper and holds less has gone through what it held
_FADES = 3  # trials in a row of which that is true
_SLIPPED = 0.95  # of the most: one that goes on in the last rounds and holds less slips by
_NEARLY = 0.8  # of what is wanted: what slipped by with less does so however it is measured
_FAR_BELOW = 0.5  # of the wanted height: from there up, a slope is that of the digit itself
_INWARDS = 0.05  # of a bracket: no trial nearer to its ends


@dataclass
class Search:
    """The search of one digit; its values grow with a power of its share past first touch.

    Attributes
    ----------
    wanted : float
        The value to be reached, > 0.
    power : float
        The power of a value that grows in a straight line: 2/3 for forces (Hertz), 1 for overlaps.
    share : float
        Where the digit is.
    missed : str
        Why it cannot reach the value; empty as long as it may.
    """

    wanted: float
    power: float
    share: float
    value: float = 0.0
    missed: str = ""
    _slope: float = 0.0
    _known_slope: float = 0.0
    _below: tuple[float, float] | None = None
    _last: tuple[float, float] | None = None
    _low: float | None = None
    _high: float | None = None
    _most: tuple[float, float] = (0.0, 0.0)
    _most_depth: float = 0.0
    _faded: int = 0
    _falls: bool = False
    _is_again: bool = False
    _has_missed: bool = False
    _closed: int = 0
    _trial: int = 0
    _low_since: int = 0
    _high_since: int = 0

    def error(self) -> float:
        """Return how far the value is from the wanted one, over that."""
        return abs(self.value / self.wanted - 1.0)

    def reason(self, tolerance: float, unit: str, size: float) -> str:
        """Return why it does not hold what it should; nothing where it does.

        Parameters
        ----------
        tolerance : float
            The error up to which it does.
        unit, size : str, float
            Unit that values are told in, and how many of it are 1.
        """
        value, wanted, most = (f"{size * one:.3g}" for one in (self.value, self.wanted, self.most))
        if self.missed == "start":
            return (
                f"is at {value} of {wanted} {unit} when it is open: the product stands in it; "
                "move the hand away"
            )
        if self.missed == "end" and self.most == 0.0:
            return "does not meet the product on its way"
        if self.missed == "end":
            stands = "" if most == value else f" and stands at {value}"
            return f"comes to {most} of {wanted} {unit} at the most on its way{stands}"
        if self.missed == "trials":
            return (
                f"was at {value} of {wanted} {unit} when its trials ended, few as the contact is large: "
                "the product stands in the hand; move the hand away"
            )
        if self.error() <= tolerance:
            return ""
        why = "there it jumps from pose to pose, as at an edge or a thin wall"
        if not self.is_stuck:
            why = f"its trials ended before it was there, or {why}; move the hand a little"
        return f"stands at {value} of {wanted} {unit}: {why}"

    def begin_again(self) -> None:
        """Forget all values but not how fast they grow: from now on they are measured in another way.

        A digit that missed has another try, but where it slipped by with far less."""
        if self._known_slope == 0.0 and self._last is not None and self._below is not None:
            # From far below: between close shares a slope is that of other digits' moves.
            (share, height), (below, low) = self._last, self._below
            if share - below > _CLOSE and height > low:
                self._slope = (height - low) / (share - below)
        self._slope = self._known_slope = self._known_slope or self._slope
        self._last = self._low = self._high = None
        self._closed = 0
        self._is_again = True
        self._has_missed = self._has_missed or self.missed == "end"
        # To look again costs nothing at the end of a way, but many trials where a digit slips by.
        slips_by = abs(self.share) < 1.0 and self.most < _NEARLY * self.wanted
        if self.missed != "trials" and not slips_by:
            self.missed = ""
        self._most, self._most_depth, self._faded, self._falls = (0.0, 0.0), 0.0, 0, False

    def end(self, tolerance: float) -> None:
        """Say of a digit that had missed that it does, where it holds less again the farther it goes."""
        slips_by = self._has_missed and self._falls and self.most < self.wanted
        if slips_by and not self.missed and self.error() > tolerance:
            self.missed = "end"

    def take(self, value: float, tolerance: float, *, step: float, depth: float) -> None:
        """Take the value at the present share; go on by at most a step, unless it is the wanted one.

        A digit is `depth` deep in the product (m).
        """
        self.value = value
        height = (value / self.wanted) ** self.power
        if (value, self.share) > self._most:
            self._most, self._most_depth = (value, self.share), depth
        self._falls = self._falls or (value < self.most and self.share > self._most[1])
        self._faded = self._faded + 1 if self._is_less(value, depth) else 0
        if self._below is None or height < _FAR_BELOW or self.share < self._below[0]:
            self._below = (self.share, height)
        # Across a jump the slope is that of nothing.
        if self._last is not None and abs(self.share - self._last[0]) > _CLOSE:
            slope = (height - self._last[1]) / (self.share - self._last[0])
            if self._known_slope > 0.0:
                slope = min(max(slope, self._known_slope / _STEADY), self._known_slope * _STEADY)
            if slope > 0.0:
                self._slope = slope
        self._last = (self.share, height)
        if self.missed or self.error() <= tolerance:
            return
        self._trial += 1
        self._bracket(height)
        if height > 1.0 and self.share <= -1.0:
            self.missed = "start"
        elif height < 1.0 and (self.share >= 1.0 or self._faded >= _FADES):
            self._go_back()
        else:
            self._open_again()
            self.share = self._next(height, step)

    @property
    def most(self) -> float:
        """The largest value that was met."""
        return self._most[0]

    @property
    def is_stuck(self) -> bool:
        """Whether the value jumps across the wanted one wherever it was looked for."""
        return self._closed > _STALE

    def _is_less(self, value: float, depth: float) -> bool:
        """Whether it holds less because it went on too far; where trials are few, the sooner."""
        gone_through = depth > self._most_depth and value < _FADED * self.most
        farther = self.most < self.wanted and self.share > self._most[1]
        return gone_through or (self._is_again and farther and value < _SLIPPED * self.most)

    def _go_back(self) -> None:
        """Return to where there was the most, to look there once more if that was enough."""
        self.share = self._most[1]
        if self.most < self.wanted:
            self.missed = "end"
        self._low = self._high = None
        self._slope = self._known_slope
        self._faded = 0
        self._closed += 1

    def _open_again(self) -> None:
        """Forget a bracket that closed: digits move each other's values, so its values may be no more."""
        if self._low is not None and self._high is not None and self._high - self._low < _CLOSEST:
            self._low = self._high = None
            self._slope = self._known_slope
            self._closed += 1

    def _bracket(self, height: float) -> None:
        # Digits move each other's values: what is old or contradicts the newest is forgotten.
        if height < 1.0:
            self._low, self._low_since = self.share, self._trial
            if self._high is not None and (self._high <= self.share or self._trial - self._high_since > _OLD):
                self._high = None
        else:
            self._high, self._high_since = self.share, self._trial
            if self._low is not None and (self._low >= self.share or self._trial - self._low_since > _OLD):
                self._low = None

    def _next(self, height: float, step: float) -> float:
        wanted = self.share + (1.0 - height) / self._slope if self._slope > 0.0 else None
        if wanted is None or height == 0.0:
            wanted = self.share + (step if height < 1.0 else -step)
        if self._low is not None and self._high is not None:
            width = self._high - self._low
            inside = self._low + _INWARDS * width < wanted < self._high - _INWARDS * width
            return wanted if inside else self._low + 0.5 * width
        wanted = min(max(wanted, self.share - _BACK * step), self.share + step)
        return min(max(wanted, -1.0), 1.0)
