"""Bones inside a finger's skin: the phalanges found, meshed, and checked against the skin."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._arrays import Floats
from .._check import as_direction, as_mask, as_number, as_vector, reals_or_empty, short
from .._geometry import sides_of
from ..errors import SurfaceError
from ..obstacle import Obstacle
from ..scene import as_surface
from ..skin.cut_out import CutOut
from ..surface import Surface, skin_without_caps
from .loft import joined
from .phalanges import LENGTHS, Frame, Phalanx, as_text, lengths_between, phalanges_in

__all__ = ["bone_of"]

_DEFAULT_NODES = 230
_MOST_NODES = 20_000  # ten times more than a body on any machine can use
_SCALES = (0.3, 2.0)  # from an infant to beyond the largest adult
_COARSER = (1.0, 1.3, 1.8)  # elements of each phalanx over the first's: the pad is pressed, the root is not


def bone_of(
    finger: Surface | CutOut,
    *,
    digit: str = "middle",
    joints: ArrayLike | None = None,
    scale: float = 1.0,
    cut: ArrayLike | None = None,
    tip: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    palmar: ArrayLike = (0.0, 0.0, -1.0),
    min_thickness: float = 1e-3,
    element_size: float | None = None,
) -> Surface:
    """Return plausible phalanges inside a finger, for `quasirigid.Body(bone=...)`.

    Distal, middle and, where the finger is long enough, proximal phalanx: straight bones of elliptic sections
    with a head, a waist and a base, each on the line that fits the finger's sections best, 1 mm apart at the
    joints. A phalanx that would reach the cut ends in front of it. Lengths are published means; breadths and
    heights scale with the finger's breadth at the distal joint.

    Parameters
    ----------
    finger : Surface or CutOut
        A closed finger, built in or scanned, its root cut off flat; fairly straight. A `CutOut` knows its
        cut.
    digit : {"thumb", "index", "middle", "ring", "little"}
        Whose lengths to take.
    joints : (k, 3) array_like, optional
        Centers of the joints (m), two or more, from the root to the tip, the fingertip last, as in a rig:
        the bones end there, and `axis` runs from the first to the last.
    scale : float
        Factor on all published lengths along the finger, 1 for the mean of adults; from 0.3 to 2.
    cut : (n,) array_like of bool, optional
        Vertices of the cut at the root; those of the `CutOut`, or of flat cuts, when left out.
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
        An argument is not of the shape or in the range above, the finger is open, its root cannot be found,
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
    if isinstance(finger, CutOut):
        cut = finger.fixed if cut is None else cut
        finger = finger.surface
    finger = as_surface("finger", finger)
    if not finger.is_closed:
        raise SurfaceError("the finger is open: a bone needs a closed skin around it, cut face included")
    if not isinstance(digit, str) or digit not in LENGTHS:
        raise SurfaceError(f"digit is {digit!r}, expected one of {', '.join(LENGTHS)}")
    scale = as_number("scale", scale, SurfaceError, *_SCALES)
    min_thickness = as_number("min_thickness", min_thickness, SurfaceError)
    places = None if joints is None else _as_joints(joints)
    if places is not None and axis is None:
        axis = places[-1] - places[0]
    frame = _find_frame(
        finger,
        None if cut is None else _as_cut(cut, len(finger.vertices)),
        None if tip is None else as_vector("tip", tip, SurfaceError),
        None if axis is None else as_direction("axis", axis, SurfaceError),
        as_direction("palmar", palmar, SurfaceError),
    )
    from_cut = max(1.5e-3, finger.mean_edge_length)

    def phalanges_at(scale: float) -> list[Phalanx]:
        lengths = LENGTHS[digit]
        if places is not None:
            lengths = lengths_between(frame, places, lengths[0], scale)
        return phalanges_in(frame, lengths, scale, from_cut, is_thumb=digit == "thumb")

    phalanges = phalanges_at(scale)
    if not phalanges:
        raise SurfaceError(_nothing_fits(frame))
    bone = _meshed(phalanges, element_size)
    thinnest, place = _thinnest(finger, bone)
    if thinnest < min_thickness:
        smaller = None
        if places is None:
            smaller = _scale_that_fits(finger, phalanges_at, scale, min_thickness)
        raise SurfaceError(_too_thin(thinnest, place, min_thickness, smaller))
    return bone


def _meshed(phalanges: list[Phalanx], element_size: float | None) -> Surface:
    """Return the phalanges as one surface, with edges of about `element_size` (m)."""
    area = sum(bone.area / _COARSER[bone.number] ** 2 for bone in phalanges)
    # A vertex of an equilateral mesh has 2 / sqrt(3) of an edge squared less the area of one: 0.866 h^2.
    if element_size is None:
        element_size = float(np.sqrt(area / (0.866 * _DEFAULT_NODES)))
    else:
        element_size = as_number("element_size", element_size, SurfaceError)
        finest, coarsest = float(np.sqrt(area / (0.866 * _MOST_NODES))), 0.25 * phalanges[0].whole
        if not finest <= element_size <= coarsest:
            raise SurfaceError(
                f"element_size is {element_size} m, expected {finest:.1e} m ({_MOST_NODES} vertices) to "
                f"{coarsest:.1e} m (a quarter of the distal phalanx)"
            )
    meshes = [bone.mesh(element_size * _COARSER[bone.number]) for bone in phalanges]
    return Surface(*joined(meshes))


def _find_frame(
    finger: Surface,
    cut: NDArray[np.bool_] | None,
    tip: Floats | None,
    axis: Floats | None,
    palmar: Floats,
) -> Frame:
    """Return the frame of a finger; axis and tip are found where they are not given."""
    vertices = finger.vertices
    caps = ~skin_without_caps(finger) if cut is None else cut
    if axis is None:
        axis = _principal_axis(finger, caps, tip)
    if tip is None:
        tip = vertices[np.argmax(vertices @ axis)]
    towards_nail = -(palmar - (palmar @ axis) * axis)
    if np.linalg.norm(towards_nail) < 0.2:
        raise SurfaceError(
            f"the direction of the pad, {as_text(palmar)}, runs along the finger's axis {as_text(axis)}: "
            "give `palmar`"
        )
    dorsal = towards_nail / np.linalg.norm(towards_nail)
    edges = sides_of(finger.faces)
    height = (tip - vertices) @ axis
    # Cut straight across or askew: bones end before the first vertex of the cut.
    length = float(height[caps].min() if caps.any() else height.max())
    return Frame(
        tip=tip,
        axis=axis,
        across=np.cross(axis, dorsal),
        dorsal=dorsal,
        length=length,
        vertices=vertices,
        edges=edges[edges[:, 0] < edges[:, 1]],
    )


def _principal_axis(finger: Surface, caps: NDArray[np.bool_], tip: Floats | None) -> Floats:
    """Return the longest axis (3,) of the skin, towards its tip or, without one, away from its caps."""
    vertices, areas = finger.vertices, finger.vertex_areas
    middle = np.average(vertices, axis=0, weights=areas)
    spread = vertices - middle
    axis: Floats = np.linalg.eigh((spread * areas[:, None]).T @ spread)[1][:, -1]
    if tip is not None:
        towards = tip - middle
    elif caps.any():
        towards = middle - vertices[caps].mean(axis=0)
    else:
        raise SurfaceError("the finger has no flat cut that would tell its root: give `cut`, `tip` or `axis`")
    return axis if axis @ towards >= 0.0 else -axis


def _as_cut(cut: ArrayLike, count: int) -> NDArray[np.bool_]:
    mask = as_mask("cut", cut, count, SurfaceError)
    if mask.all() or not mask.any():
        raise SurfaceError(
            f"`cut` marks {np.count_nonzero(mask)} of the {count} vertices, expected those of the cut at the "
            "root; leave it out where that is flat"
        )
    return mask


def _nothing_fits(frame: Frame) -> str:
    return (
        f"the finger is {frame.length:.4f} m long from its cut to its tip {as_text(frame.tip)} m: no phalanx "
        "fits in it; check its unit, `tip`, `cut`, and that `axis` runs from the root to the tip"
    )


def _as_joints(joints: ArrayLike) -> Floats:
    places = reals_or_empty(joints)
    if places.ndim != 2 or places.shape[1] != 3 or len(places) < 2 or not np.isfinite(places).all():
        raise SurfaceError(
            f"joints is {short(joints)}, expected (k, 3) finite numbers of two or more joints, the tip last"
        )
    return places


def _thinnest(finger: Surface, bone: Surface) -> tuple[float, Floats]:
    """Return the least tissue (m) at a vertex of bone or skin, negative outside; and where."""
    skin, core = (
        Obstacle.mesh(surface.vertices, surface.faces, check_crossings=False) for surface in (finger, bone)
    )
    inside, around = -skin.signed_distance(bone.vertices)[0], core.signed_distance(finger.vertices)[0]
    return min(
        (float(inside.min()), bone.vertices[int(np.argmin(inside))]),
        (float(around.min()), finger.vertices[int(np.argmin(around))]),
        key=lambda found: found[0],
    )


def _scale_that_fits(
    finger: Surface, phalanges_at: Callable[[float], list[Phalanx]], scale: float, min_thickness: float
) -> float | None:
    """Return a smaller scale at which the tissue is as thick as asked; None where there is none."""
    for smaller in np.arange(np.ceil(20.0 * scale) - 1.0, 20.0 * _SCALES[0] - 0.5, -1.0) / 20.0:
        phalanges = phalanges_at(float(smaller))
        if phalanges and _thinnest(finger, _meshed(phalanges, None))[0] >= min_thickness:
            return float(smaller)
    return None


def _too_thin(thinnest: float, place: Floats, min_thickness: float, smaller: float | None) -> str:
    where = ", ".join(f"{value:.4f}" for value in place)
    least = np.floor(thinnest * 2e4) / 2e4  # to 0.05 mm below
    remedies = [] if smaller is None else [f"scale={smaller:.4g}"]
    if least > 0.0:
        state = f"lies {thinnest * 1e3:.2f} mm below"
        remedies.append(f"min_thickness={least:.2g}")
    else:
        state = f"sticks {-thinnest * 1e3:.2f} mm out of"
    passes = f"{' or '.join(remedies)} would pass; " if remedies else ""
    return (
        f"the bone {state} the skin near ({where}) m, expected at least {min_thickness * 1e3:.2f} mm of "
        f"tissue: {passes}check the finger's unit, `palmar`, `tip` and `digit`"
    )
