"""How far the figures of a contact can be trusted, and what each mesh gave."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from .._frozen import Frozen

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..skin.response import Discretization

__all__ = ["Accuracy", "Refinement", "RefinementKind"]


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """How far the figures of a contact can be trusted, by source of error.

    Estimated are the errors of meshes. What the response leaves out, as the bone under a half-space, is not
    among them; nor are the shapes that the given meshes stand for: the product's is taken as it is drawn,
    facets and all, the skin's as the smooth surface that its vertices and their normals imply. Where the skin
    is drawn with few triangles a radius of its curvature, only a finer drawing tells what that costs.

    Attributes
    ----------
    natural_residual, complementarity : float
        Worst residuals of the complementarity problems, measured on the original matrix (dimensionless).
    integration_tolerance : float
        Largest error of an entry of the response matrix from numerical integration, over the half-space's.
    discretization : Discretization
        "collocation" or "galerkin": how gaps were taken on the mesh that was solved.
    condition : float or None
        Largest condition number of the response matrices' symmetric parts; infinite of one that is not
        positive definite. None where one was not examined: those of up to 64 nodes always are, larger ones
        where `ContactOptions.condition` asks for it.
    definite : bool or None
        True: the symmetric part of every response matrix was shown to be positive definite, so the answer
        is the only one. False: shown not to be, or singular to rounding. None: not examined.
    cells_per_radius : float
        Mesh cells per contact radius, taken as 2 area / rim length. Below about 4 the mesh is coarse.
    force_error : float or None
        Estimated error of the force over its length: `mesh_error` + `body_error`. Where forces balance
        each other, as in a pinch or a ring, little is left, and it may be above 1. None, here and below,
        where no estimate was made; `Contact.left_out` says why. Infinite where the mesh is too coarse to
        tell, as where it penetrates and nothing carries force.
    mesh_error, body_error : float or None
        Parts of `force_error`: from the mesh around the contact; from the coarse mesh of a body or of a
        product's given matrix. Penetration that a refined mesh leaves, over that before, is in `mesh_error`
        and `area_error` with its mean over the skin under force, in `max_pressure_error` with its largest.
    area_error : float or None
        Estimated error of `contact_area` over it, with what the body's mesh costs it.
    max_pressure_error : float or None
        Estimated error of `max_pressure` over it; infinite where a sharp edge carries force, or a vertex at
        a cut or the rim of the skin mask, too. Where facets of a product's mesh meet under the peak, they
        make it grow as cells get smaller, without end: what cells a quarter as large would add is in it.
        So is how far the peak stands out from what is beside it, as on a bump or a crease of a scanned skin.
    """

    natural_residual: float
    complementarity: float
    integration_tolerance: float
    discretization: Discretization
    condition: float | None
    definite: bool | None
    cells_per_radius: float
    force_error: float | None
    mesh_error: float | None
    body_error: float | None
    area_error: float | None
    max_pressure_error: float | None


class RefinementKind(StrEnum):
    """What a `Refinement` was: a mesh, solved to the end, or one linear problem on the way there."""

    MESH = "mesh"
    LINEARIZATION = "linearization"


@dataclass(frozen=True, kw_only=True, eq=False)
class Refinement(Frozen):
    """What one mesh gave, or one linear problem on the way there.

    Attributes
    ----------
    kind : RefinementKind
        "mesh", or "linearization": gaps and normals taken anew at the deformed skin.
    nodes : int
        Contact nodes: unknowns of the complementarity problems.
    force : (3,) float64
        Force on the skin (N).
    contact_area : float or None
        Contact area (m²); None of a linearization.
    max_pressure : float or None
        Largest pressure (Pa); None of a linearization.
    force_error, area_error : float or None
        Estimated relative errors; None of a linearization and without contact.
    max_penetration : float
        Deepest penetration left (m); of a linearization the largest gap of a vertex under force or
        penetration of another, in Galerkin form the largest change of a node's averaged gap.
    seconds : float
        Wall time (s).
    reason : str
        Why no further round followed; empty of all but the last. "target_error" is the target met,
        "max_nodes" and "memory_limit" are options that were reached; others say it in words, such as "a
        sharp edge".
    """

    kind: RefinementKind
    nodes: int
    force: NDArray[np.float64]
    contact_area: float | None
    max_pressure: float | None
    force_error: float | None
    area_error: float | None
    max_penetration: float
    seconds: float
    reason: str
