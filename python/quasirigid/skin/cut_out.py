"""Parts of a hand, cut out for a body of their own."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

import numpy as np

from .. import _core
from .._check import as_index, as_mask, as_vector
from .._frozen import Frozen
from ..errors import CutWarning, SurfaceError
from ..scene import as_surface
from .response import Body

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..surface import Surface

__all__ = ["CutOut", "cut_out"]


@dataclass(frozen=True, kw_only=True, eq=False)
class CutOut(Frozen):
    """A part of a skin, closed by caps, with what a `Body` needs to be held there.

    Attributes
    ----------
    surface : Surface
        The part: first the vertices of the whole skin that it keeps, in their order, then those of the caps.
        Caps and what was no skin before are masked.
    fixed : (m,) bool
        Vertices of the caps, rims included.
    source_vertices : (m,) int64
        For each vertex of the part the vertex of the whole skin, -1 inside a cap.
    part_vertices : (n,) int64
        For each vertex of the whole skin its vertex in the part, -1 if it is not kept.
    kept_count : int
        Number of vertices of the whole skin that it keeps.
    """

    surface: Surface
    fixed: NDArray[np.bool_]
    source_vertices: NDArray[np.int64]
    part_vertices: NDArray[np.int64]

    @property
    def kept_count(self) -> int:
        """Number of vertices of the whole skin that it keeps."""
        return int(np.count_nonzero(self.source_vertices >= 0))

    def body(self, *, bone: Surface | None = None, bone_pressure: bool = False) -> Body:
        """Return the body held at the cut.

        Parameters
        ----------
        bone : Surface, optional
            Rigid bones inside the part, each a closed surface.
        bone_pressure : bool
            Keep the pressure on the bone too (`PreparedSkin.bone_pressure`).

        Returns
        -------
        Body
            A response for `surface`, with `fixed` held.
        """
        return Body(bone=bone, fixed=self.fixed, bone_pressure=bone_pressure)

    def __repr__(self) -> str:
        """Return the counts on one line."""
        count, fixed = len(self.fixed), np.count_nonzero(self.fixed)
        return f"CutOut({count} vertices, {fixed} of them fixed, of a skin of {len(self.part_vertices)})"


@overload
def cut_out(surface: Surface, *, tip: int, point: ArrayLike, normal: ArrayLike) -> CutOut: ...
@overload
def cut_out(surface: Surface, *, keep: ArrayLike) -> CutOut: ...
def cut_out(
    surface: Surface,
    *,
    tip: int | None = None,
    point: ArrayLike | None = None,
    normal: ArrayLike | None = None,
    keep: ArrayLike | None = None,
) -> CutOut:
    """Take one finger out of a hand, as a closed surface.

    Keeps the faces in front of a plane that hang together with `tip`, or those whose corners `keep` marks,
    cutting along existing edges, and closes every border by a flat cap; faces at a border that its cap would
    cross are left out too. What the cut leaves out is taken as immobile, so cut a finger's width or more away
    from the contact.

    Parameters
    ----------
    surface : Surface
        The whole hand.
    tip : int
        A vertex of the part to keep, such as a fingertip.
    point : (3,) array_like
        A point of the plane (m). The plane has no end: it cuts other fingers too.
    normal : (3,) array_like
        The plane's normal, towards the part to keep; of any length.
    keep : (n,) array_like of bool
        In the place of these three: vertices to keep, such as those of a finger's label. Of several pieces
        that do not hang together, the one with the most faces is kept.

    Returns
    -------
    CutOut
        The part, its fixed vertices, and the numbers of its vertices in the whole skin.

    Raises
    ------
    SurfaceError
        If the tip is no vertex or lies behind the plane, the plane is not finite or cuts nothing off, `keep`
        marks no part, or the border is so crooked that its cap folds; a TypeError for another set of
        arguments.

    Warns
    -----
    CutWarning
        If a plane leaves more than half of the vertices.

    Examples
    --------
    >>> import numpy as np
    >>> import quasirigid as qr
    >>> finger = qr.models.finger(edge_length=2.5e-3)
    >>> tip = int(np.argmax(finger.vertices[:, 1]))
    >>> part = qr.cut_out(finger, tip=tip, point=[0, 0.05, 0], normal=[0, 1, 0])
    >>> part.surface.is_closed, bool(part.surface.volume < finger.volume)
    (True, True)
    >>> same = qr.cut_out(finger, keep=finger.vertices[:, 1] > 0.05)
    >>> same.kept_count == part.kept_count
    True
    """
    surface = as_surface("surface", surface)
    plane = {"tip": tip, "point": point, "normal": normal}
    given = [name for name, value in plane.items() if value is not None]
    if (keep is None) == (not given) or (keep is None and len(given) < 3):
        found = ", ".join(given + ["keep"] * (keep is not None)) or "none of them"
        raise TypeError(f"cut_out takes tip, point and normal together, or keep; given: {found}")
    count = len(surface.vertices)
    if keep is not None:
        parts = _core.cut_out_marked(surface, as_mask("keep", keep, count, SurfaceError))
        return _part(*parts)
    part = _part(
        *_core.cut_out(
            surface,
            as_index("tip", tip, count, SurfaceError),
            as_vector("point", point, SurfaceError),
            as_vector("normal", normal, SurfaceError),
        )
    )
    if 2 * part.kept_count > count:
        why = (
            f"the plane leaves {part.kept_count} of {count} vertices around the tip: it has no end, so what "
            "lies beside the finger in front of it stays; move or turn it, or take keep="
        )
        warnings.warn(why, CutWarning, stacklevel=2)
    return part


def _part(
    surface: Surface,
    fixed: NDArray[np.bool_],
    source_vertices: NDArray[np.int64],
    part_vertices: NDArray[np.int64],
) -> CutOut:
    return CutOut(surface=surface, fixed=fixed, source_vertices=source_vertices, part_vertices=part_vertices)
