"""Press the skin against an obstacle."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Literal

from .. import _core
from ..errors import ContactError, QuasirigidWarning
from ..lcp import solution_from_core
from ..skin.elastic import core_skin
from .options import ContactOptions, options_to_core
from .result import Accuracy, Contact, ContactStatus, Patch

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..obstacle import Obstacle
    from ..skin.elastic import ElasticSkin
    from ..surface import Surface

__all__ = ["press", "solve_contact"]


def _finish(result: _core.Contact, throw: bool) -> Contact:
    """The facade's contact; warns, and raises on a bad ending where asked."""
    fields = result.fields()
    for message in fields.pop("warnings"):
        warnings.warn(message, QuasirigidWarning, stacklevel=3)
    fields["status"] = ContactStatus(fields["status"])
    displacement, fade_distance, volume_change, deformed = result.drawn()
    contact = Contact(
        **fields,
        displacement=displacement,
        fade_distance=fade_distance,
        volume_change=volume_change,
        patches=tuple(Patch(**patch) for patch in result.patches()),
        deformed=deformed,
        obstacle=result.obstacle(),
        lcp_solutions=tuple(solution_from_core(solution) for solution in result.lcp_solutions()),
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
    skin: ElasticSkin,
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
    core_options = options_to_core(options or ContactOptions())
    return _finish(_core.solve_contact(surface, obstacle, core_skin(skin, surface), core_options), throw)


def press(
    surface: Surface,
    obstacle: Obstacle,
    skin: ElasticSkin,
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
    skin : Skin, PreparedSkin or CombinedSkin
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

    Warns
    -----
    QuasirigidWarning
        Where vertices went through a wall of the obstacle that is thinner than their depth (the rim of a can
        or mug).

    Notes
    -----
    A vertex that came in through another side of the obstacle than its closest one (beside an edge, through a
    thin wall) has its gap measured back along the press, to where the obstacle met it; `left_out` counts
    them. A contact solved in place knows no way and pushes such vertices out at the side, as weighted gaps
    do.

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
    core_options = options_to_core(options or ContactOptions())
    result = _core.press(
        surface, obstacle, core_skin(skin, surface), direction, depth=depth, start=start, options=core_options
    )
    return _finish(result, throw)
