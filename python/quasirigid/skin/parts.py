"""Parts of a hand: cut out for a body of their own, and joined again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from .._check import index_of, vector_of
from ..errors import ResponseError, SurfaceError
from .prepared import PreparedSkin
from .response import Body

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..surface import Surface
    from .material import Skin

__all__ = ["CombinedSkin", "CutOut", "cut_out"]


@dataclass(frozen=True, kw_only=True, eq=False)
class CutOut:
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
    fixed: NDArray[np.bool_] = field(repr=False)
    source_vertices: NDArray[np.int64] = field(repr=False)
    part_vertices: NDArray[np.int64] = field(repr=False)

    def body(self, bone: Surface | None = None, *, bone_pressure: bool = False) -> Body:
        """The body held at the cut, with `bone` inside if there is one."""
        return Body(bone=bone, fixed=self.fixed, bone_pressure=bone_pressure)


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
        index_of("tip", tip, len(surface.vertices), SurfaceError),
        vector_of("point", point, SurfaceError),
        vector_of("normal", normal, SurfaceError),
    )
    return CutOut(surface=part, fixed=fixed, source_vertices=source_vertices, part_vertices=part_vertices)


@dataclass(frozen=True, kw_only=True, eq=False)
class CombinedSkin:
    """Bodies where they exist, a kernel elsewhere; made by `Skin.combined`, goes wherever a `Skin` goes.

    Attributes
    ----------
    elsewhere : Skin
        The kernel off the parts.
    parts : mapping of str to (CutOut, PreparedSkin)
        The parts by name.
    """

    elsewhere: Skin
    parts: Mapping[str, tuple[CutOut, PreparedSkin]]
    _surface: Surface = field(repr=False)
    core: _core.Skin = field(repr=False)

    def without(self, *names: str) -> CombinedSkin:
        """The same with these parts left to the kernel, as where a contact straddles their cut.

        Parameters
        ----------
        *names : str
            Parts to leave out.

        Raises
        ------
        ResponseError
            If there is no such part; a TypeError if a name is no str.
        """
        if wrong := [name for name in names if not isinstance(name, str)]:
            raise TypeError(f"without() takes names of parts one by one, not {wrong[0]!r}")
        if unknown := [name for name in names if name not in self.parts]:
            raise ResponseError(f"there is no part {unknown[0]!r}, only {', '.join(self.parts)}")
        kept = {name: part for name, part in self.parts.items() if name not in names}
        return combine(self.elsewhere, self._surface, kept)

    def moved(self, rotation: ArrayLike, translation: ArrayLike) -> CombinedSkin:
        """The response of the surface after a rigid motion, ``rotation @ x + translation``.

        Parameters
        ----------
        rotation : (3, 3) array_like
            Proper rotation.
        translation : (3,) array_like
            Shift (m).

        Returns
        -------
        CombinedSkin
            For ``surface.moved(rotation, translation)``; its parts are moved too.
        """
        response = self.core.moved(rotation, translation)
        parts = {
            name: (
                replace(cut, surface=cut.surface.moved(rotation, translation)),
                prepared.moved(rotation, translation),
            )
            for name, (cut, prepared) in self.parts.items()
        }
        return CombinedSkin(
            elsewhere=self.elsewhere,
            parts=parts,
            _surface=self._surface.moved(rotation, translation),
            core=response,
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what it is made of."""
        return combine, (self.elsewhere, self._surface, self.parts)

    def core_on(self, surface: Surface) -> _core.Skin:
        """The core's skin, which refuses any other surface."""
        return self.core


def combine(
    elsewhere: Skin, surface: Surface, parts: Mapping[str, tuple[CutOut, PreparedSkin]]
) -> CombinedSkin:
    """What `Skin.combined` returns."""
    if elsewhere.kernel is None:
        raise ResponseError("a combined skin needs a kernel off its parts, such as HalfSpace()")
    if not isinstance(parts, Mapping):
        raise TypeError(
            f"parts is a {type(parts).__name__}, expected a dict of names to (CutOut, PreparedSkin)"
        )
    for name, part in parts.items():
        _check_part(name, part)
    told = [
        (name, prepared.core, cut.part_vertices.tolist(), cut.fixed)
        for name, (cut, prepared) in parts.items()
    ]
    response = _core.Skin.combined(surface, elsewhere.kernel, told)
    return CombinedSkin(elsewhere=elsewhere, parts=dict(parts), _surface=surface, core=response)


def _check_part(name: object, part: object) -> None:
    if not isinstance(name, str):
        raise TypeError(f"the part {name!r} is named by a {type(name).__name__}, expected a str")
    members = part if isinstance(part, (tuple, list)) else (part,)
    kinds = [type(member).__name__ for member in members]
    match members:
        case [CutOut(), PreparedSkin()]:
            return
        case [CutOut(), _] if kinds[1] == "Skin":
            why = "prepare the skin for the part's surface"
        case [PreparedSkin(), CutOut()]:
            why = "swap the two"
        case _:
            why = "cut_out and Skin.prepared make them"
    found = f"({', '.join(kinds)})" if isinstance(part, (tuple, list)) else f"a {kinds[0]}"
    raise TypeError(f"part {name!r} is {found}, expected (CutOut, PreparedSkin): {why}")
