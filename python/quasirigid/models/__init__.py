"""Built-in fingers and products, so that a press needs no file at all.

Fingers have their pad to -z, their nail to +z and their axis along +y, the origin in the middle of the flat
cut; `quasirigid.flat_cap_mask` finds the cut. Products have their bounding box centred at the origin; round
ones stand along z. Every length is in metres, and `edge_length` sets the mesh density.
"""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from ..obstacle import Obstacle
from ..surface import Surface
from .bones import build_bone
from .fingers import REFERENCE_BREADTH, REFERENCE_LENGTH, build_finger
from .loft import Floats, Indices
from .products import build_bottle, build_cylinder_handle, build_rounded_box

__all__ = ["bone_of", "bottle", "cylinder_handle", "finger", "fingertip", "rounded_box"]


def fingertip(
    *, length: float = 0.030, breadth: float = 0.018, depth: float | None = None, edge_length: float = 1.2e-3
) -> Surface:
    """The end of a finger: distal phalanx and a piece of the middle one.

    Parameters
    ----------
    length : float
        From the flat cut to the tip (m).
    breadth : float
        Breadth at the distal joint (m); everything but `length` scales with it.
    depth : float, optional
        Depth at the distal joint (m); 0.86 times the breadth when left out.
    edge_length : float
        Mean edge of the mesh (m).

    Returns
    -------
    Surface
        Closed; about 1,400 vertices by default, 5,600 at 0.6 mm.

    Raises
    ------
    SurfaceError
        A length is not above 0, the finger is shorter than 0.8 breadths, or the mesh too coarse to show it.

    Examples
    --------
    >>> import quasirigid as qr
    >>> tip = qr.models.fingertip(edge_length=2e-3)
    >>> tip.is_closed, round(float(tip.vertices[:, 1].max()), 3)
    (True, 0.03)
    """
    return Surface(*build_finger(length, breadth, depth, edge_length, stretch=breadth / REFERENCE_BREADTH))


def finger(
    *, length: float = 0.076, breadth: float = 0.018, depth: float | None = None, edge_length: float = 1.85e-3
) -> Surface:
    """A whole straight finger, from its root to the tip, with the girth of its two joints.

    Parameters
    ----------
    length : float
        From the flat cut at the root to the tip (m); the joints keep their place in proportion.
    breadth : float
        Breadth at the distal joint (m).
    depth : float, optional
        Depth at the distal joint (m); 0.86 times the breadth when left out.
    edge_length : float
        Mean edge of the mesh (m).

    Returns
    -------
    Surface
        Closed; about 1,500 vertices by default, 50,000 at 0.32 mm.

    Raises
    ------
    SurfaceError
        A length is not above 0, the finger is shorter than 0.8 breadths, or the mesh too coarse to show it.

    References
    ----------
    Buryanov and Kotiuk 2010, Int. J. Morphol. 28(3), 755-758 (lengths of the phalanges); Greiner 1991, Hand
    Anthropometry of U.S. Army Personnel, Natick/TR-92/011 (breadths and girths at the joints).

    Examples
    --------
    >>> import quasirigid as qr
    >>> finger = qr.models.finger(length=0.080, breadth=0.020)
    >>> round(float(finger.vertices[:, 1].max()), 3)
    0.08
    """
    return Surface(*build_finger(length, breadth, depth, edge_length, stretch=length / REFERENCE_LENGTH))


def bone_of(
    finger: Surface,
    *,
    digit: str = "middle",
    scale: float = 1.0,
    cut: ArrayLike | None = None,
    tip: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    palmar: ArrayLike = (0.0, 0.0, -1.0),
    min_thickness: float = 1e-3,
    element_size: float | None = None,
) -> Surface:
    """Plausible phalanges inside a finger, for `quasirigid.Body(bone=...)`.

    Distal, middle and, where the finger is long enough, proximal phalanx: straight bones of elliptic sections
    with a head, a waist and a base, each on the line that fits the finger's sections best, 1 mm apart at the
    joints. A phalanx that would reach the cut ends in front of it. Lengths are published means; breadths and
    heights scale with the finger's breadth at the distal joint.

    Parameters
    ----------
    finger : Surface
        A closed finger, built in or scanned, its root cut off flat; fairly straight.
    digit : {"thumb", "index", "middle", "ring", "little"}
        Whose lengths to take.
    scale : float
        Factor on all lengths along the finger, 1 for the mean of adults; from 0.3 to 2.
    cut : (n,) array_like of bool, optional
        Vertices of the cut at the root, such as `CutOut.fixed`; those of flat cuts when left out.
    tip : (3,) array_like, optional
        Foremost point of the fingertip (m); the vertex farthest along the axis when left out.
    axis : (3,) array_like, optional
        From the root to the tip; the principal axis of the skin, away from its cut, when left out.
    palmar : (3,) array_like
        Towards the pad. Built-in fingers have it at -z.
    min_thickness : float
        Least tissue between bone and skin (m), held at every vertex of both.
    element_size : float, optional
        Edges of the distal phalanx (m), 1.3 and 1.8 times that on the next ones; at most a quarter of its
        length, at least what makes 20,000 vertices. Chosen for about 230 vertices when left out.

    Returns
    -------
    Surface
        Closed, one component for each phalanx.

    Raises
    ------
    SurfaceError
        An argument is not of the shape or in the range above, the finger is open, its root cannot be told,
        no phalanx fits, or less tissue than `min_thickness` is left.

    Notes
    -----
    In the built-in fingertip some 4 mm of soft tissue lie beyond the bone's tip, 3 mm under the nail and 6 to
    8 mm over the pad. A bone from a scan of the person at hand is better.

    References
    ----------
    Buryanov and Kotiuk 2010, Int. J. Morphol. 28(3), 755-758 (lengths, tissue beyond the tip); Murai et al.
    1997, J. Hand Surg. Am. 22(5), 935-941 (share and place of the bone); Mintalucci et al. 2014, J. Hand
    Surg. Am. 39(6), 1068-1074 (tuft); Darowish et al. 2015, Hand 10(1), 100-104 (narrowest height).

    Examples
    --------
    >>> import quasirigid as qr
    >>> finger = qr.models.fingertip(edge_length=2e-3)
    >>> bone = qr.models.bone_of(finger)
    >>> bone.is_closed, 0.08 < bone.volume / finger.volume < 0.25
    (True, True)
    """
    return build_bone(
        finger,
        digit,
        scale,
        cut,
        tip,
        axis,
        palmar,
        min_thickness,
        element_size,
    )


def cylinder_handle(
    *, radius: float = 0.016, length: float = 0.110, edge_radius: float = 0.003, edge_length: float = 1e-3
) -> Obstacle:
    """A round bar along z with rounded rims.

    Parameters
    ----------
    radius, length : float
        Of the whole bar (m).
    edge_radius : float
        Of the rounding at both rims (m); at most the radius and half the length.
    edge_length : float
        Mean edge of the mesh (m); at most 1.25 edge radii. Facets lie up to ``edge_length**2 / 8 / radius``
        inside the round, which a fine skin mesh feels.

    Returns
    -------
    Obstacle
        A closed mesh, centred at the origin.

    Raises
    ------
    ObstacleError
        A length is not above 0, or they do not fit together.

    Examples
    --------
    >>> import quasirigid as qr
    >>> handle = qr.models.cylinder_handle(radius=0.012)
    >>> distance, _, _ = handle.signed_distance([[0.020, 0.0, 0.0]])
    >>> bool(abs(distance[0] - 0.008) < 1e-4)
    True
    """
    return _product(*build_cylinder_handle(radius, length, edge_radius, edge_length))


def rounded_box(
    *, size: Sequence[float] = (0.075, 0.150, 0.009), edge_radius: float = 0.003, edge_length: float = 2.5e-3
) -> Obstacle:
    """A box with rounded edges and corners; by default about the size of a mobile phone.

    Parameters
    ----------
    size : (3,) float
        Outer lengths along x, y and z (m).
    edge_radius : float
        Of all edges and corners (m); at most half the shortest side.
    edge_length : float
        Mean edge of the mesh (m); at most 1.25 edge radii. Facets lie up to ``edge_length**2 / 8 / radius``
        inside the round, which a fine skin mesh feels.

    Returns
    -------
    Obstacle
        A closed mesh, centred at the origin.

    Raises
    ------
    ObstacleError
        A length is not above 0, or they do not fit together.

    Examples
    --------
    >>> import quasirigid as qr
    >>> box = qr.models.rounded_box(size=(0.04, 0.04, 0.02))
    >>> distance, _, _ = box.signed_distance([[0.0, 0.0, 0.015]])
    >>> round(float(distance[0]), 6)
    0.005
    """
    return _product(*build_rounded_box(size, edge_radius, edge_length))


def bottle(
    *,
    radius: float = 0.0325,
    height: float = 0.215,
    neck_radius: float = 0.014,
    neck_height: float = 0.030,
    edge_radius: float = 0.003,
    edge_length: float = 2e-3,
) -> Obstacle:
    """A standing bottle: body, shoulder and neck; by default about the size of a half-litre drink.

    Parameters
    ----------
    radius, height : float
        Of the whole bottle (m).
    neck_radius, neck_height : float
        Of the straight neck above the shoulder (m).
    edge_radius : float
        Of the rounding at foot and mouth (m).
    edge_length : float
        Mean edge of the mesh (m); at most 1.25 edge radii.

    Returns
    -------
    Obstacle
        A closed mesh about the z axis, its bounding box centred at the origin.

    Raises
    ------
    ObstacleError
        A length is not above 0, or they do not fit together.

    Examples
    --------
    >>> import quasirigid as qr
    >>> distance, _, _ = qr.models.bottle().signed_distance([[0.0, 0.0, 0.0], [0.0, 0.0, 0.2]])
    >>> bool(distance[0] < 0 < distance[1])
    True
    """
    return _product(*build_bottle(radius, height, neck_radius, neck_height, edge_radius, edge_length))


def _product(vertices: Floats, faces: Indices) -> Obstacle:
    # Nothing built here crosses itself, so the search for crossing faces is left out.
    return Obstacle.mesh(vertices, faces, check_crossings=False)
