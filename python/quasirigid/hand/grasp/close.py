"""A hand closes on a product until its digits hold it."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ..._check import as_boolean, as_number, as_vector
from ...contact.ending import ContactStatus
from ...contact.options import ContactOptions, options_to_core
from ...contact.press import end_of
from ...errors import HandError, QuasirigidWarning, SizeWarning
from ...scene import as_obstacle
from ...skin import Body, GivenMatrix, Skin
from ...skin.progress import Progress, as_progress
from ..crossings import in_words
from ..hand import Hand
from ..rig.joints import DIGITS, index_of
from .closing import Closing
from .grasp import Grasp
from .hold import Hold

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..._arrays import Floats
    from ...contact import Contact
    from ...obstacle import Obstacle
    from ..pose import Pose
    from ..posed import PosedHand

__all__ = ["close_hand"]

TARGET_ERROR = 0.05
MOST_NODES = 1250
_HEAVIEST = 50.0  # of what a hand holds (kg)
_THUMB = 0.5  # its share of a force that is not told by digit


def close_hand(
    hand: Hand,
    obstacle: Obstacle,
    skin: Skin,
    *,
    start: Pose = "relaxed",
    end: Pose = "fist",
    force: Mapping[str, float] | float | None = None,
    overlap: Mapping[str, float] | float | None = None,
    rotation: ArrayLike | None = None,
    translation: ArrayLike | None = None,
    product_mass: float | None = None,
    center_of_mass: ArrayLike | None = None,
    gravity: ArrayLike = (0.0, 0.0, -9.81),
    options: ContactOptions | None = None,
    progress: Progress | bool | None = None,
    throw: bool = True,
) -> Grasp:
    """Close the digits of a hand on a product until each holds its force or reaches its overlap.

    Each digit goes its own way from one pose to another, a single share of the turns of all its joints; hand
    and product stay where they are. A digit that the product stands in at the start opens first, if that
    leads it out, at most to the pose "open". All digits are searched together, so that each answers to the
    others.

    Parameters
    ----------
    hand : Hand
        The hand.
    obstacle : Obstacle
        The product, where it stands.
    skin : Skin
        Material and response. A `Body` that has neither bone nor fixed vertices gets the hand's own bones and
        is held at the cut at the wrist; it is prepared anew for every pose of the last rounds.
    start, end : pose
        Where the digits begin and where they are closed, as for `Hand.posed`. From "opposed" the thumb comes
        from the other side than the fingers, as on what is thicker than 50 mm; for less, from
        ``mix("flat", "opposed", 0.6)``.
    force : float or mapping of digit to float
        Length of the resultant that a digit shall carry (N, > 0). A number is the sum over the digits: half
        on the thumb, an eighth on each finger. Digits that a mapping does not name stay at the start.
    overlap : float or mapping of digit to float
        In place of a force: deepest overlap of a digit's vertices with the product (m, > 0), measured back
        the way they came where a wall of it is thinner.
    rotation, translation : array_like, optional
        Of the whole hand, as for `Hand.posed`.
    product_mass : float, optional
        Mass of the product (kg).
    center_of_mass : (3,) array_like, optional
        Its center of mass (m); that of the obstacle filled evenly when left out.
    gravity : (3,) array_like
        Acceleration of free fall (m/s^2).
    options : ContactOptions, optional
        How contacts are solved; with ``target_error=None`` all is done on the given mesh. When left out, with
        a `target_error` of 0.05 and `max_nodes` of 1250: forces are asked for here, so what a mesh costs goes
        into the pose, and a digit on an edge or a rim would go on refining.
    progress : callable or bool, optional
        Called as ``progress(what, done)`` as the work goes on, `done` a share of 1; True prints to stderr.
    throw : bool
        Raise where a contact does not end solved, as `solve_contact`.

    Returns
    -------
    Grasp
        Pose, contact, what each digit and region carries, and which digits missed what was asked.

    Raises
    ------
    HandError
        Neither or both of force and overlap, names that are no digits, values that are not above 0, a product
        inside the hand or a hand inside the product, a body that has bones of its own.
    ContactError, ResponseError
        As `solve_contact` and `Skin.prepared` say.

    Warns
    -----
    QuasirigidWarning
        What the last contact warns of, a product too heavy for a hand, digits that were not asked for and
        stand inside the product at the start, and regions of the hand that cross each other.

    Notes
    -----
    Digits go through the air by distances alone, no vertex farther at once than the product is away, and
    further by secants on the force to the power 2/3, which grows in a straight line under a round pad. That
    is done on the given mesh, of a body under the half-space, with gaps taken anew once; the last rounds
    solve as `options` and `skin` say, to 0.8 % of each force. Where no mesh meets the `target_error`, as on
    an edge, they keep to the coarsest that one of them ended with: each refinement has other forces there.

    Examples
    --------
    >>> import numpy as np
    >>> import quasirigid as qr
    >>> hand = qr.models.hand(edge_length=4e-3)
    >>> palm = hand.posed("relaxed").palm
    >>> ball = qr.Obstacle.sphere(palm[:3, 3] + 0.03 * palm[:3, 1] + 0.04 * palm[:3, 2], 0.033)
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.495, response=qr.HalfSpace())
    >>> grasp = qr.close_hand(hand, ball, skin, force={"index": 2.0, "middle": 2.0})
    >>> round(float(np.linalg.norm(grasp.digits["index"].force)), 1)
    2.0
    """
    asked = _asked(force, overlap)
    if not isinstance(hand, Hand):
        raise TypeError(f"hand is a {type(hand).__name__}, expected a Hand, as of `read_hand`")
    as_obstacle("obstacle", obstacle)
    _check_skin(skin)
    if options is None:
        options = ContactOptions(target_error=TARGET_ERROR, max_nodes=MOST_NODES)
    options_to_core(options)
    throw = as_boolean("throw", throw)
    fall = as_vector("gravity", gravity, HandError)
    mass = None if product_mass is None else as_number("product_mass", product_mass, HandError)
    weight = None if mass is None else mass * fall
    middle = _middle_of(obstacle, center_of_mass)
    hold = Hold(
        closing=Closing(hand, start, end, rotation, translation),
        obstacle=obstacle,
        skin=skin,
        options=options,
        wanted=asked,
        by_force=force is not None,
        report=as_progress(progress),
    )
    posed, contact = hold.run()
    end_of(contact, throw=throw, stacklevel=2)
    if mass is not None and mass > _HEAVIEST:
        warnings.warn(
            f"product_mass is {mass:g} kg, more than the {_HEAVIEST:g} kg that a hand holds: is it in "
            "another unit? 400 g is 0.4",
            SizeWarning,
            stacklevel=2,
        )
    _warn(hold, posed, contact)
    return _grasp(hold, posed, contact, weight=weight, middle=middle)


def _check_skin(skin: Skin) -> None:
    """Refuse what is no skin, and one that is prepared for a single pose."""
    if not isinstance(skin, Skin):
        raise TypeError(f"skin is a {type(skin).__name__}, expected a Skin: it is prepared for each pose")
    if isinstance(skin.response, GivenMatrix) or (
        isinstance(skin.response, Body)
        and (skin.response.bone is not None or skin.response.fixed is not None)
    ):
        raise HandError(
            "the response belongs to one pose; Body() with neither bone nor fixed takes the hand's own bones"
        )


def _warn(hold: Hold, posed: PosedHand, contact: Contact) -> None:
    """Warn of digits that stay inside the product, of one that none holds and of regions that cross."""
    for digit, depth in hold.standing.items():
        warnings.warn(
            f"{digit} was not asked for and stands {1e3 * depth:.3g} mm inside the product: it stays at the "
            "start; name it too, start in another pose, or move the hand",
            QuasirigidWarning,
            stacklevel=3,
        )
    missed = hold.missed()
    if missed and contact.status is ContactStatus.NO_CONTACT:
        warnings.warn(
            f"no digit holds the product, {', '.join(missed)} missed it: move the hand to it, or end in "
            "another pose; `Grasp.missed` says why",
            QuasirigidWarning,
            stacklevel=3,
        )
    if posed.crossings:
        warnings.warn(
            f"the hand crosses itself, {in_words(posed.crossings)}: digits do not hold each other off; "
            "turn or move the hand, ask for less force or end in another pose",
            QuasirigidWarning,
            stacklevel=3,
        )


def _grasp(hold: Hold, posed: PosedHand, contact: Contact, *, weight: Floats | None, middle: Floats) -> Grasp:
    """Return what a hand holds about the middle (m) of a product, and with its weight (N)."""
    parts = contact.by_label(hold.closing.parts)  # each digit and the palm
    regions = contact.by_label(posed.labels)
    net_force = -contact.force
    net_moment = -(contact.moment - np.cross(middle, contact.force))
    return Grasp(
        pose=hold.closing.pose(hold.shares),
        posed=posed,
        contact=contact,
        shares=dict(zip(DIGITS, hold.shares.tolist(), strict=True)),
        digits={name: parts[name] for name in DIGITS if name in parts},
        palm=parts["palm"],
        regions={str(name): part for name, part in regions.items() if part.force.any()},
        net_force=net_force,
        net_moment=net_moment,
        unbalanced_force=None if weight is None else net_force + weight,
        unbalanced_moment=None if weight is None else net_moment,
        missed=hold.missed(),
        rounds=hold.rounds,
        timings=hold.timings,
    )


def _asked(
    force: Mapping[str, float] | float | None, overlap: Mapping[str, float] | float | None
) -> dict[int, float]:
    """Return what each digit shall reach, by its place in DIGITS."""
    if (force is None) == (overlap is None):
        given = "neither" if force is None else "both"
        raise HandError(f"a hand closes to a force or to an overlap; given: {given}")
    what, value = ("overlap", overlap) if force is None else ("force", force)
    if isinstance(value, Mapping):
        if not value:
            raise HandError(f"{what} names no digit, expected some of {', '.join(DIGITS)}")
        return {
            index_of(name, DIGITS, "the digit"): as_number(f"{what}[{name!r}]", number, HandError)
            for name, number in value.items()
        }
    number = as_number(what, value, HandError)
    if what == "overlap":
        return dict.fromkeys(range(len(DIGITS)), number)
    finger = (1.0 - _THUMB) / (len(DIGITS) - 1)
    return {at: number * (_THUMB if name == "thumb" else finger) for at, name in enumerate(DIGITS)}


def _middle_of(obstacle: Obstacle, center_of_mass: ArrayLike | None) -> Floats:
    if center_of_mass is not None:
        return as_vector("center_of_mass", center_of_mass, HandError)
    middle = obstacle.center_of_mass
    if middle is None:
        raise HandError("a half-space has no center of mass: give center_of_mass")
    return middle
