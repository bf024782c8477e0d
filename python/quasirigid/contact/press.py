"""Press the skin against an obstacle."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

from .. import _core
from .._check import as_boolean, as_choice
from .._from_core import from_core
from ..lcp.solution import solution_from_core
from ..scene import check_scene
from ..skin import Discretization
from ..skin.elastic import core_skin
from .accuracy import Accuracy, Refinement, RefinementKind
from .caps import warned_of_caps
from .drawn import Drawing
from .ending import ContactStatus, LeftOut
from .options import ContactOptions, options_to_core
from .parts import patches_of
from .result import Contact, ContactError
from .warned import warn_of, warned

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..obstacle import Obstacle
    from ..skin.elastic import ElasticSkin
    from ..surface import Surface

__all__ = ["Balance", "Start", "end_of", "press", "press_quietly", "solve_contact", "solve_quietly"]


class Start(StrEnum):
    """Where a press begins: at first touch from infinity, or where the obstacle stands."""

    INFINITY = "infinity"
    CURRENT = "current"


class Balance(StrEnum):
    """Whether the obstacle of a press only travels, or turns to its balance as well."""

    NONE = "none"
    TILT = "tilt"


def solve_contact(
    surface: Surface,
    obstacle: Obstacle,
    skin: ElasticSkin,
    *,
    options: ContactOptions | None = None,
    throw: bool = True,
) -> Contact:
    """Solve the contact of the skin with the obstacle where it stands.

    Finds node forces f >= 0 and gaps ``g = g0 + R f >= 0`` with ``g'f = 0``, R the response of the skin, and
    with it that of an obstacle with a material (`Obstacle.with_material`).

    Parameters
    ----------
    surface : Surface
        The undeformed skin. Its `skin_mask`, of `Surface.with_skin_mask`, says what may touch.
    obstacle : Obstacle
        The product, at its pose.
    skin : Skin, PreparedSkin or CombinedSkin
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
    TypeError
        For an argument of the wrong kind, such as a path in the place of the skin.

    Warns
    -----
    QuasirigidWarning
        As `press`.

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
    check_scene(surface, obstacle)
    throw = as_boolean("throw", throw)
    return end_of(solve_quietly(surface, obstacle, skin, options), throw=throw, stacklevel=2)


def press(
    surface: Surface,
    obstacle: Obstacle,
    skin: ElasticSkin,
    direction: ArrayLike,
    *,
    depth: float | None = None,
    force: float | None = None,
    overlap: float | None = None,
    start: Start | Literal["infinity", "current"] = "infinity",
    balance: Balance | Literal["none", "tilt"] = "none",
    tilt_axes: ArrayLike | None = None,
    tilt_point: ArrayLike | None = None,
    options: ContactOptions | None = None,
    throw: bool = True,
) -> Contact:
    """Move the obstacle along a direction to a depth, a force or an overlap, and solve the contact there.

    Takes one of `depth`, `force` and `overlap`.

    Parameters
    ----------
    surface : Surface
        The undeformed skin. Its `skin_mask`, of `Surface.with_skin_mask`, says what may touch.
    obstacle : Obstacle
        The product.
    skin : Skin, PreparedSkin or CombinedSkin
        Material and response.
    direction : (3,) array_like
        Direction in which the obstacle travels; normalised here.
    depth : float, optional
        Travel beyond the start (m, >= 0).
    force : float, optional
        Force on the skin along the direction, ``contact.force . direction`` (N, > 0).
    overlap : float, optional
        Deepest overlap of obstacle and undeformed skin, `Contact.max_penetration_before` (m, > 0).
    start : {"infinity", "current"}
        "infinity": the depth counts from first touch, the position on the line of travel at which the
        obstacle, coming from infinity, first meets the skin: at a vertex or, with an edge, a corner or as a
        round primitive, between vertices. "current": from where the obstacle stands, which must be free of
        penetration.
    balance : {"none", "tilt"}
        "none": the obstacle travels and keeps its attitude. "tilt": it also turns, by 30 degrees at the most,
        until the moment on the skin about the tilt axes vanishes, as a plate that is held at one point
        settles on three fingers. `Contact.obstacle` holds the pose.
    tilt_axes : (k, 3) array_like, optional
        One or two axes to turn about, of any length, not parallel; for "tilt" alone. Two at right angles to
        `direction` when left out.
    tilt_point : (3,) array_like, optional
        Point that the axes go through and that the obstacle is held at (m), where the obstacle stands now; it
        travels with the obstacle. Required for "tilt".
    options : ContactOptions, optional
        How it is solved.
    throw : bool
        Raise on an ending other than "solved" and "no_contact"; with False, read `Contact.status`. A force or
        an overlap out of reach, or no balance, raises in any case.

    Returns
    -------
    Contact
        As `solve_contact`; `depth` is the depth that was found (m), and `travel` the way of the obstacle (m),
        negative where it started in overlap or behind the skin.

    Raises
    ------
    ContactError
        For a zero direction, a negative depth, a force or an overlap that is not positive, none or several of
        these, an option out of range, an obstacle that never meets the skin, a start that penetrates, a bad
        ending (the error carries `contact`), a force or an overlap out of reach (`contact` is the largest
        that was found), tilt axes without length or parallel, a tilt without its point, or no balance (the
        message says which moment is left, `contact` is the one that was found there).
    ObstacleError, ResponseError, LcpError
        Where a part could not answer: a skin that is prepared for another surface or for other vertices, too
        much memory, a `method` that there is not.
    TypeError
        For an argument of the wrong kind, such as a path in the place of the skin.

    Warns
    -----
    SizeWarning, DirectionWarning, DepthWarning, ModulusWarning, MaskWarning, ResponseRangeWarning
        Where the question is probably not meant: a wrong unit, a product behind the skin, a depth that no
        tissue has, an inverted mask.
    CoarseMeshWarning, CutWarning, PenetrationWarning, RefinementWarning
        Where the figures lack something. `Contact.warnings` keeps them all, whatever Python's filter shows.

    Notes
    -----
    Under a force or an overlap the depth is searched to a relative 1e-6 of the value, on the given mesh, and
    again on the mesh that is refined there; what a coarse given mesh jumps over is found on that alone. Where
    it jumps by less than 1 % on the last mesh, the nearest is returned with a RefinementWarning. A press to
    `Contact.depth` gives the force back: to the bit on the given mesh (``target_error=None``), else as far as
    two refined meshes agree, some `target_error`.

    With ``balance="tilt"`` the depth is the travel of `tilt_point` beyond the first touch of the obstacle as
    it was given: the first touch of the turned one would jump from finger to finger as it turns. Force and
    overlap are those of the turned obstacle. The moment is balanced, on the given mesh, where that has a
    balance, and on the refined one, to 1e-6 of the force times the largest distance of a loaded vertex from
    the point. There is no balance where the point lies beside all that can carry the obstacle, or where a
    depth is too small for the fingers on both sides of the point to be reached.

    A vertex that came in through another side of the obstacle than its closest one (beside an edge, through a
    thin wall) has its gap measured back along the press, to where the obstacle met it; `left_out` counts
    them. A contact solved in place takes the way back along the inward normal of the skin, within the search
    distance.

    Examples
    --------
    >>> import quasirigid as qr
    >>> tip = qr.models.fingertip()
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    >>> plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
    >>> contact = qr.press(tip, plate, skin, [0, 0, 1], depth=1e-3)
    >>> contact.status.value, bool(contact.force[2] > 0)
    ('solved', True)
    >>> contact = qr.press(tip, plate, skin, [0, 0, 1], force=1.5)
    >>> round(float(contact.force[2]), 4), bool(contact.depth > 1e-3)
    (1.5, True)

    A plate held 0.5 mm beside the middle of the contact turns until it presses there:

    >>> beside = [contact.center_of_pressure[0] + 0.5e-3, contact.center_of_pressure[1], 0.0]
    >>> held = qr.press(tip, plate, skin, [0, 0, 1], force=1.5, balance="tilt", tilt_point=beside)
    >>> bool(held.center_of_pressure[0] > contact.center_of_pressure[0] + 0.4e-3)
    True
    """
    throw = as_boolean("throw", throw)
    contact = press_quietly(
        surface,
        obstacle,
        skin,
        direction,
        options,
        depth=depth,
        force=force,
        overlap=overlap,
        start=as_choice("start", start, Start, ContactError),
        balance=as_choice("balance", balance, Balance, ContactError),
        tilt_axes=tilt_axes,
        tilt_point=tilt_point,
    )
    return end_of(contact, throw=throw, stacklevel=2)


def press_quietly(
    surface: Surface,
    obstacle: Obstacle,
    skin: ElasticSkin,
    direction: ArrayLike,
    options: ContactOptions | None,
    **asked: Any,
) -> Contact:
    """Return the contact of a press; nothing is warned of, no ending is an error."""
    check_scene(surface, obstacle)
    core_options = options_to_core(options)
    core = core_skin(skin, surface, core_options.num_threads)
    try:
        pressed = _core.press(surface, obstacle, core, direction, options=core_options, **asked)
    except ContactError as error:
        if isinstance(error.contact, _core.Contact):
            error.contact = _from_core(error.contact, surface)
        raise
    return _from_core(pressed, surface)


def solve_quietly(
    surface: Surface, obstacle: Obstacle, skin: ElasticSkin, options: ContactOptions | None
) -> Contact:
    """Return the contact in place; nothing is warned of, no ending is an error."""
    core_options = options_to_core(options)
    core = core_skin(skin, surface, core_options.num_threads)
    return _from_core(_core.solve_contact(surface, obstacle, core, core_options), surface)


def end_of(contact: Contact, *, throw: bool, stacklevel: int) -> Contact:
    """Return the contact; warn, and raise a bad ending where asked."""
    warn_of(contact.warnings, stacklevel=stacklevel + 1)
    if throw and contact.status not in (ContactStatus.SOLVED, ContactStatus.NO_CONTACT):
        error = ContactError(f"the contact did not end solved: {contact.advice}")
        error.contact = contact
        raise error
    return contact


def _from_core(core: _core.Contact, surface: Surface) -> Contact:
    total, accuracy = core.resultant, core.accuracy
    return from_core(
        Contact,
        core,
        status=ContactStatus(core.status),
        refinements=tuple(
            from_core(Refinement, one, kind=RefinementKind(one.kind)) for one in core.refinements
        ),
        force=total.force,
        moment=total.moment,
        center_of_pressure=total.center_of_pressure,
        contact_area=total.contact_area,
        max_pressure=total.max_pressure,
        patches=patches_of(core.patches),
        lcp_solutions=tuple(solution_from_core(solution) for solution in core.lcp_solutions),
        natural_residual=accuracy.natural_residual,
        accuracy=from_core(Accuracy, accuracy, discretization=Discretization(accuracy.discretization)),
        timings=dict(core.timings),
        left_out=tuple(LeftOut(what, why) for what, why in core.left_out),
        warnings=warned(core.warnings) + warned_of_caps(core, surface),
        _loaded=core.loaded,
        _drawing=Drawing(core.drawing, None if len(core.parents) else surface),
    )
