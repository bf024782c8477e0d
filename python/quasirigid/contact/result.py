"""What a contact returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..lcp import LcpSolution
    from ..obstacle import Obstacle
    from ..surface import Surface

__all__ = ["Accuracy", "Contact", "ContactStatus", "Patch"]


class ContactStatus(StrEnum):
    """How a contact ended; the last four are endings of its complementarity problem."""

    SOLVED = "solved"
    NO_CONTACT = "no_contact"
    RAY = "ray"
    PIVOT_LIMIT = "pivot_limit"
    BREAKDOWN = "breakdown"
    INTERRUPTED = "interrupted"


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
        Its contact area (m^2), as in `Contact`.
    max_pressure : float
        Its largest pressure (Pa), as in `Contact`.
    """

    vertices: NDArray[np.int64]
    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    center_of_pressure: NDArray[np.float64]
    contact_area: float
    max_pressure: float

    @property
    def area(self) -> float:
        """The contact area (m^2)."""
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
        With weighted gaps the rim is found between vertices, and the area is several times as good.
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
        Sum of the vertex areas with f > 0 (m^2). With weighted gaps, the area within the rim that the gaps
        beside it tell, between the vertices; under a sharp edge, where the gap opens with a step, that rim is
        up to a cell too far in (a flat punch of 8 cells' half width: 14 % low, vertex areas 8 %).
    max_pressure : float
        Largest pressure at a vertex (Pa), ``pressure.max()``. With weighted gaps it may be above that: it is
        the largest between vertices too, and never below the mean over a patch's contact area.
    volume_change : float
        Change of the volume enclosed by the skin (m^3), ``sum S_i N_i . u_i`` over the skin, N outward.
    max_penetration_before, max_penetration_after : float
        Deepest penetration of a skin vertex (m), before and, measured anew at the deformed skin, after.
    pressure : (n,) float64
        Pressure (Pa): `node_force` over vertex area. With weighted gaps that ratio is right in the mean only,
        and this is the smooth pressure recovered from it; it sums to the force up to the mesh error (some 2 %
        less at 4 cells per contact radius, 1 % at 8), `node_force` exactly.
    node_force : (n,) float64
        Force along the obstacle's outward normal (N).
    force_vectors : (n, 3) float64
        Force on the skin at each vertex (N): `node_force` along that normal.
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
    force_vectors: NDArray[np.float64] = field(repr=False)
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
