"""How a contact is solved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .. import _core
from .._check import (
    as_boolean,
    as_choice,
    as_float,
    as_float_or_none,
    as_integer,
    as_integer_or_none,
    short,
)
from ..lcp import LcpError, LcpMethod, LcpMethodName
from .result import ContactError

__all__ = ["ContactOptions"]

_DEFAULTS: dict[str, Any] = _core.ContactOptions.defaults()
_METHOD = LcpMethod(_DEFAULTS["method"])


@dataclass(frozen=True, kw_only=True)
class ContactOptions:
    """How a contact is solved. Values are checked where they are used.

    Attributes
    ----------
    tolerance : float
        Largest error of an entry of the response matrix from numerical integration, over the half-space's
        entry (0 to 0.1); 0 for all that double precision gives.
    target_error : float or None
        Relative error that the mesh may leave in force and area, as far as it is estimated (0 < target < 1):
        the mesh is refined around the contact until then. Of several patches the force is what they carry
        each by itself, as in a grasp they balance and little is left in all. On a sharp edge of the product,
        where force and area settle slowly, it ends with a warning once the skin held on the edge is no
        broader than 1.3 depths times the root of the target (1 to 2.1, steep to blunt edges), or as half of
        `max_nodes` allow. None: the mesh is taken as it is.
    max_nodes : int
        Most contact nodes of a refined mesh.
    gap_tolerance : float
        Gap that may be left at the deformed skin where it touches, as a share of `max_penetration_before`
        (between 0 and 1); in Galerkin form how much another linearization may change an averaged one. The
        forces stand upright on the product to five times this share of theirs, in the mean.
    max_linearizations : int
        Most linear problems, each with gaps and normals taken at the skin as the one before deformed it; 1
        takes them at the undeformed skin alone. As many again where skin slipped to steep sides.
    rings : int or None
        Rings of neighbours added to the penetrating vertices. None: 0 where the response has no negative
        entry (further vertices can never touch), 1 otherwise; what is pressed beyond them is found and added.
    method : {"lemke", "block_pivoting", "projected_cg", "auto"}
        Solver of the complementarity problem, as in `solve_lcp`. "projected_cg" needs a symmetric matrix,
        which half-space and layer have with ``discretization="galerkin"``.
    num_threads : int or None
        Threads, at most four for each processor; None for all. Results are equal to the bit for any number.
    memory_limit : int or None
        Largest memory for response matrices (bytes); None for what the system, a container's limit and the
        process's own (``ulimit -v``) leave free, where they say so. A body that is prepared on the way has
        a limit of its own.
    search_distance : float or None
        Gaps are measured up to this distance from the obstacle (m), of a press up to its depth at least;
        None: depth plus two mean edge lengths, in overlap more where skin stands deeper.
    condition : bool
        Examine definiteness and condition of response matrices of any size; those of up to 64 nodes always
        are.
    couple_fingers : bool
        Let a kernel couple patches on different fingers too, through the air between them, that beside the
        parts of a `CombinedSkin` included. False: patches more than 1.5 times as far apart along the skin as
        in a straight line feel less of each other, and from twice as far on nothing, unless that line runs
        inside one body of the skin. An elastic product couples all that press it from sides that face one
        way, a matrix of it all that press it.
    max_growths : int
        How often candidates may be added before the solve gives up.
    """

    tolerance: float = _DEFAULTS["tolerance"]
    target_error: float | None = _DEFAULTS["target_error"]
    max_nodes: int = _DEFAULTS["max_nodes"]
    gap_tolerance: float = _DEFAULTS["gap_tolerance"]
    max_linearizations: int = _DEFAULTS["max_linearizations"]
    rings: int | None = _DEFAULTS["rings"]
    method: LcpMethod | LcpMethodName = _METHOD
    num_threads: int | None = _DEFAULTS["num_threads"]
    memory_limit: int | None = _DEFAULTS["memory_limit"]
    search_distance: float | None = _DEFAULTS["search_distance"]
    condition: bool = _DEFAULTS["condition"]
    couple_fingers: bool = _DEFAULTS["couple_fingers"]
    max_growths: int = _DEFAULTS["max_growths"]


def options_to_core(options: ContactOptions | None) -> _core.ContactOptions:
    """Return the core's options, or its defaults; refuse by name what is of another kind."""
    if options is None:
        options = ContactOptions()
    elif not isinstance(options, ContactOptions):
        raise TypeError(f"options is {short(options)}, expected a ContactOptions")
    return _core.ContactOptions(
        tolerance=as_float("tolerance", options.tolerance),
        target_error=as_float_or_none("target_error", options.target_error),
        max_nodes=as_integer("max_nodes", options.max_nodes, ContactError, least=1),
        gap_tolerance=as_float("gap_tolerance", options.gap_tolerance),
        max_linearizations=as_integer(
            "max_linearizations", options.max_linearizations, ContactError, least=1
        ),
        rings=as_integer_or_none("rings", options.rings, ContactError),
        method=as_choice("method", options.method, LcpMethod, LcpError),
        num_threads=as_integer_or_none("num_threads", options.num_threads, ContactError, least=1),
        memory_limit=as_integer_or_none("memory_limit", options.memory_limit, ContactError),
        search_distance=as_float_or_none("search_distance", options.search_distance),
        condition=as_boolean("condition", options.condition),
        couple_fingers=as_boolean("couple_fingers", options.couple_fingers),
        max_growths=as_integer("max_growths", options.max_growths, ContactError),
    )
