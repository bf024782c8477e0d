"""Parts of a hand, cut out for a body of their own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from .._check import as_index, as_vector
from .._frozen import Frozen
from ..errors import SurfaceError
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
    """

    surface: Surface
    fixed: NDArray[np.bool_]
    source_vertices: NDArray[np.int64]
    part_vertices: NDArray[np.int64]

    def body(self, *, bone: Surface | None = None, bone_pressure: bool = False) -> Body:
        """Return the body held at the cut, with `bone` inside if there is one."""
        return Body(bone=bone, fixed=self.fixed, bone_pressure=bone_pressure)

    def __repr__(self) -> str:
        """Return the counts on one line."""
        count, fixed = len(self.fixed), np.count_nonzero(self.fixed)
        return f"CutOut({count} vertices, {fixed} of them fixed, of a skin of {len(self.part_vertices)})"


def cut_out(surface: Surface, *, tip: int, point: ArrayLike, normal: ArrayLike) -> CutOut:
    """Take one finger out of a hand, as a closed surface.

    Keeps the faces in front of a plane that hang together with `tip`, cutting along existing edges, and
    closes every border by a flat cap. What the cut leaves out is taken as immobile, so cut a finger's width
    or more away from the contact.

    Parameters
    ----------
    surface : Surface
        The whole hand.
    tip : int
        A vertex of the part to keep, such as a fingertip.
    point : (3,) array_like
        A point of the plane (m).
    normal : (3,) array_like
        The plane's normal, towards the part to keep; of any length.

    Returns
    -------
    CutOut
        The part, its fixed vertices, and the numbers of its vertices in the whole skin.

    Raises
    ------
    SurfaceError
        If the tip is no vertex or lies behind the plane, the plane is not finite or cuts nothing off, or the
        border is so crooked that its cap folds.

    Examples
    --------
    >>> import numpy as np
    >>> import quasirigid as qr
    >>> finger = qr.models.finger(edge_length=2.5e-3)
    >>> tip = int(np.argmax(finger.vertices[:, 1]))
    >>> part = qr.cut_out(finger, tip=tip, point=[0, 0.04, 0], normal=[0, 1, 0])
    >>> part.surface.is_closed, bool(part.surface.volume < finger.volume)
    (True, True)
    """
    part, fixed, source_vertices, part_vertices = _core.cut_out(
        surface,
        as_index("tip", tip, len(surface.vertices), SurfaceError),
        as_vector("point", point, SurfaceError),
        as_vector("normal", normal, SurfaceError),
    )
    return CutOut(surface=part, fixed=fixed, source_vertices=source_vertices, part_vertices=part_vertices)
