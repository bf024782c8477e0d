"""Press the skin against an obstacle."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

from . import _core
from .errors import ContactError, QuasirigidWarning
from .lcp import LcpMethod, LcpSolution

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from .obstacle import Obstacle
    from .prepared import PreparedSkin
    from .skin import Skin
    from .surface import Surface

__all__ = ["Accuracy", "Contact", "ContactOptions", "ContactStatus", "Patch", "press", "solve_contact"]


class ContactStatus(StrEnum):
    """How a contact ended; the last four are endings of its complementarity problem."""

    SOLVED = "solved"
    NO_CONTACT = "no_contact"
    RAY = "ray"
    PIVOT_LIMIT = "pivot_limit"
    BREAKDOWN = "breakdown"
    INTERRUPTED = "interrupted"


_DEFAULTS: dict[str, Any] = _core.ContactOptions.defaults()


@dataclass(frozen=True, kw_only=True)
class ContactOptions:
    """How a contact is solved.

    Attributes
    ----------
    tolerance : float
        Relative quadrature tolerance of the response matrix's entries; 0 for all that double precision gives.
    rings : int or None
        Rings of neighbours added to the penetrating vertices. None: 0 where the response has no negative
        entry (further vertices can never touch), 3 otherwise.
    method : {"lemke", "block_pivoting", "projected_cg", "auto"}
        Solver of the complementarity problem.
    num_threads : int or None
        Threads; None for all. Results are equal to the bit for any number.
    memory_limit : int or None
        Largest memory for response matrices (bytes); None for no limit.
    search_distance : float or None
        Gaps are measured up to this distance from the obstacle (m); None: depth plus two mean edge lengths.
    condition : bool
        Examine definiteness and condition of response matrices of any size; small ones always are.
    max_growths : int
        How often candidates may be added before the solve gives up.
    """

    tolerance: float = _DEFAULTS["tolerance"]
    rings: int | None = _DEFAULTS["rings"]
    method: LcpMethod = _DEFAULTS["method"]
    num_threads: int | None = _DEFAULTS["num_threads"]
    memory_limit: int | None = _DEFAULTS["memory_limit"]
    search_distance: float | None = _DEFAULTS["search_distance"]
    condition: bool = _DEFAULTS["condition"]
    max_growths: int = _DEFAULTS["max_growths"]

    def _to_core(self) -> _core.ContactOptions:
        return _core.ContactOptions(
            tolerance=self.tolerance,
            rings=self.rings,
            method=self.method,
            num_threads=self.num_threads,
            memory_limit=self.memory_limit,
            search_distance=self.search_distance,
            condition=self.condition,
            max_growths=self.max_growths,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Patch:
    """A connected part of the contact.

    Attributes
    ----------
    vertices : (k,) int64
        Vertices with f > 0, ascending.
    force : (3,) float64
        Force on the skin (N).
    moment : (3,) float64
        Moment on the skin about the origin, at deformed positions (N m).
    center_of_pressure : (3,) float64
        Mean of the deformed positions weighted by node force (m).
    contact_area : float
        Sum of the vertex areas (m^2).
    max_pressure : float
        Largest pressure at a vertex (Pa).
    """

    vertices: NDArray[np.int64]
    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    center_of_pressure: NDArray[np.float64]
    contact_area: float
    max_pressure: float

    @property
    def area(self) -> float:
        """Sum of the vertex areas (m^2)."""
        return self.contact_area


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """How far the figures of a contact can be trusted, by source of error.

    Attributes
    ----------
    natural_residual, complementarity : float
        Worst residuals of the complementarity problems, measured on the original matrix (dimensionless).
    integration_tolerance : float
        Relative quadrature tolerance of the response matrix.
    condition : float or None
        Condition number of the response matrix, where it was estimated.
    definite : bool or None
        True: the symmetric part of every response matrix was shown to be positive definite, so the answer
        is the only one. False: shown not to be. None: not examined.
    cells_per_radius : float
        Mesh cells per equivalent contact radius; under about 4 force and area are coarse, at 8 the force of a
        sphere is good to 0.2 %.
    area_resolution : float
        Uncertainty of the contact area from the mesh alone (m^2): half the area of the vertices on its rim.
    """

    natural_residual: float
    complementarity: float
    integration_tolerance: float
    condition: float | None
    definite: bool | None
    cells_per_radius: float
    area_resolution: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Contact:
    """The skin pressed against the obstacle. Arrays have one entry per vertex of the surface (n of them).

    Attributes
    ----------
    status : ContactStatus
        "solved", "no_contact" (no error: all zero) or the ending of the complementarity problem. For any
        other ending than these two the figures are nan, and `advice` says what happened and what to try.
    force : (3,) float64
        Force on the skin (N).
    moment : (3,) float64
        Moment on the skin about the origin, at deformed positions (N m).
    center_of_pressure : (3,) float64
        Mean of the deformed positions weighted by node force (m); nan without contact.
    contact_area : float
        Sum of the vertex areas with f > 0 (m^2).
    max_pressure : float
        Largest pressure at a vertex (Pa).
    volume_change : float
        Change of the volume enclosed by the skin (m^3), ``sum S_i N_i . u_i`` over the skin, N outward.
    max_penetration_before, max_penetration_after : float
        Deepest penetration of a skin vertex (m), before and, measured anew at the deformed skin, after.
    pressure : (n,) float64
        Pressure (Pa).
    node_force : (n,) float64
        Force along the obstacle's outward normal (N).
    gap : (n,) float64
        Gap (m): ``g0 + R f`` on the candidates, g0 within the search distance, inf beyond.
    displacement : (n, 3) float64
        Displacement (m), faded to zero at `fade_distance` from the candidates; the fade enters no other
        number.
    fade_distance : float
        Distance along the skin at which the drawn displacement has faded to zero (m).
    candidates : (k,) int64
        Vertices in the complementarity problem, ascending.
    active : (a,) int64
        Vertices with f > 0, ascending.
    patches : tuple of Patch
        Connected parts of the active set.
    deformed : Surface
        The deformed skin.
    obstacle : Obstacle
        The obstacle where it stands now.
    travel : float
        Way of the obstacle along the direction of a press (m).
    lcp_solutions : tuple of LcpSolution
        One per complementarity problem.
    natural_residual : float
        Worst natural residual of these (dimensionless).
    accuracy : Accuracy
        How far the figures can be trusted.
    timings : dict of str to float
        Seconds per stage.
    left_out : list of (str, str)
        What the scene did not need, and why.
    advice : str
        What happened and what to try, where the contact did not solve; else empty.
    """

    status: ContactStatus
    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    center_of_pressure: NDArray[np.float64]
    contact_area: float
    max_pressure: float
    volume_change: float
    max_penetration_before: float
    max_penetration_after: float
    pressure: NDArray[np.float64] = field(repr=False)
    node_force: NDArray[np.float64] = field(repr=False)
    gap: NDArray[np.float64] = field(repr=False)
    displacement: NDArray[np.float64] = field(repr=False)
    fade_distance: float
    candidates: NDArray[np.int64] = field(repr=False)
    active: NDArray[np.int64] = field(repr=False)
    patches: tuple[Patch, ...] = field(repr=False)
    deformed: Surface = field(repr=False)
    obstacle: Obstacle = field(repr=False)
    travel: float
    lcp_solutions: tuple[LcpSolution, ...] = field(repr=False)
    natural_residual: float
    accuracy: Accuracy = field(repr=False)
    timings: dict[str, float] = field(repr=False)
    left_out: list[tuple[str, str]] = field(repr=False)
    advice: str = field(repr=False)


def _finish(result: _core.Contact, throw: bool) -> Contact:
    """The facade's contact; warns, and raises on a bad ending where asked."""
    fields = result.fields()
    for message in fields.pop("warnings"):
        warnings.warn(message, QuasirigidWarning, stacklevel=3)
    fields["status"] = ContactStatus(fields["status"])
    contact = Contact(
        **fields,
        patches=tuple(Patch(**patch) for patch in result.patches()),
        deformed=result.deformed(),
        obstacle=result.obstacle(),
        lcp_solutions=tuple(LcpSolution._from_core(solution) for solution in result.lcp_solutions()),
        accuracy=Accuracy(**result.accuracy()),
    )
    if throw and contact.status not in (ContactStatus.SOLVED, ContactStatus.NO_CONTACT):
        error = ContactError(f"the contact ended with status {contact.status.value!r}: {contact.advice}")
        error.contact = contact
        raise error
    return contact


def solve_contact(
    surface: Surface,
    obstacle: Obstacle,
    skin: Skin | PreparedSkin,
    *,
    options: ContactOptions | None = None,
    throw: bool = True,
) -> Contact:
    """Solve the contact of the skin with the obstacle where it stands.

    Finds node forces f >= 0 and gaps ``g = g0 + R f >= 0`` with ``g'f = 0``.

    Parameters
    ----------
    surface : Surface
        The undeformed skin.
    obstacle : Obstacle
        The product, at its pose.
    skin : Skin or PreparedSkin
        Material and response.
    options : ContactOptions, optional
        How it is solved.
    throw : bool
        Raise on an ending other than "solved" and "no_contact"; with False, read `Contact.status`.

    Returns
    -------
    Contact
        Deformed skin, pressure, force, moment, area, and how far each can be trusted.

    Raises
    ------
    ContactError
        For a bad ending (the error carries `contact`) or an option out of range.
    ObstacleError, ResponseError, LcpError
        Where a part could not answer.

    References
    ----------
    Xie, Kanai, Date 2011, eq. 9; Johnson 1985, "Contact Mechanics".

    Examples
    --------
    >>> import quasirigid as qr
    >>> tip = qr.models.fingertip()
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    >>> far = qr.Obstacle.half_space([0, 0, -1], [0, 0, 1])
    >>> qr.solve_contact(tip, far, skin).status.value
    'no_contact'
    """
    core_options = (options or ContactOptions())._to_core()
    return _finish(_core.solve_contact(surface, obstacle, skin._on(surface), core_options), throw)


def press(
    surface: Surface,
    obstacle: Obstacle,
    skin: Skin | PreparedSkin,
    direction: ArrayLike,
    *,
    depth: float,
    start: Literal["infinity", "current"] = "infinity",
    options: ContactOptions | None = None,
    throw: bool = True,
) -> Contact:
    """Move the obstacle along a direction to a depth, then solve the contact.

    Parameters
    ----------
    surface : Surface
        The undeformed skin.
    obstacle : Obstacle
        The product.
    skin : Skin or PreparedSkin
        Material and response.
    direction : (3,) array_like
        Direction in which the obstacle travels; normalised here.
    depth : float
        Travel beyond the start (m, >= 0).
    start : {"infinity", "current"}
        "infinity": the depth counts from first touch, the position on the line of travel at which the
        obstacle, coming from infinity, first brings a skin vertex to distance 0. "current": from where the
        obstacle stands, which must be free of penetration.
    options : ContactOptions, optional
        How it is solved.
    throw : bool
        Raise on an ending other than "solved" and "no_contact"; with False, read `Contact.status`.

    Returns
    -------
    Contact
        As `solve_contact`; `travel` is the way of the obstacle (m), negative where it started in overlap.

    Raises
    ------
    ContactError
        For a zero direction, a negative depth, an obstacle that never meets the skin, a start that
        penetrates, or a bad ending (the error carries `contact`).

    Examples
    --------
    >>> import quasirigid as qr
    >>> tip = qr.models.fingertip()
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    >>> plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
    >>> contact = qr.press(tip, plate, skin, [0, 0, 1], depth=1e-3)
    >>> contact.status.value, bool(contact.force[2] > 0)
    ('solved', True)
    """
    core_options = (options or ContactOptions())._to_core()
    result = _core.press(
        surface, obstacle, skin._on(surface), direction, depth=depth, start=start, options=core_options
    )
    return _finish(result, throw)
