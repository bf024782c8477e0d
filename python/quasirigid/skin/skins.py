"""What the skin is made of: material and response, joined from parts."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .. import _core
from .._check import as_float, as_integer_or_none, as_reals
from .._frozen import Made
from ..errors import ResponseError, ResponseRangeWarning
from ..scene import as_surface
from .core import ElasticConstants, build_kernel, build_prepared
from .cut_out import CutOut
from .given_mesh import forces_on_given_mesh
from .prepared import PreparedSkin, bone_pressures_of
from .progress import Progress, as_progress
from .response import Body, Discretization, Response

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..contact.result import Contact
    from ..surface import Surface

__all__ = ["CombinedSkin", "Skin"]


@dataclass(frozen=True, kw_only=True)
class Skin:
    """Material and response of the skin.

    Parameters
    ----------
    shear_modulus : float
        G (Pa), > 0 (1e-60 to 1e60). About 60 kPa for a fingertip (Xie, Kanai, Date 2011).
    poisson_ratio : float
        nu, in [0, 0.5]; 0.5 is incompressible.
    response : HalfSpace, GaussianCorrected, Layer, Body or GivenMatrix
        Displacement of the surface per unit force.

    Raises
    ------
    ResponseError
        If a constant is out of range.

    Warns
    -----
    ResponseRangeWarning
        If the response is not well posed, with the bound on its constants.

    Examples
    --------
    >>> import quasirigid as qr
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    """

    shear_modulus: float
    poisson_ratio: float
    response: Response

    def __post_init__(self) -> None:
        """Build the kernel, and warn where it is not well posed."""
        why = None if self._kernel is None else self._kernel.ill_posedness()
        if why is not None:
            warnings.warn(why, ResponseRangeWarning, stacklevel=3)

    def __getstate__(self) -> dict[str, Any]:
        """Return all but the kernel, which is built again."""
        return {name: value for name, value in vars(self).items() if name != "_kernel"}

    @cached_property
    def _kernel(self) -> _core.Skin | None:
        """None where the response depends on the surface."""
        return build_kernel(self._constants, self.response)

    def prepared(
        self,
        surface: Surface,
        nodes: ArrayLike | None = None,
        *,
        progress: Progress | bool | None = None,
        num_threads: int | None = None,
    ) -> PreparedSkin:
        """Compute the response for a surface once, to use it for every product.

        Parameters
        ----------
        surface : Surface
            The skin's mesh.
        nodes : (k,) array_like of int, optional
            Vertices that may touch; None for all of the skin mask (less the fixed ones of a body). A body
            takes time and memory for each of these. A `GivenMatrix` has its own.
        progress : callable or bool, optional
            How far a body is: True prints to stderr; a function is called with words and the part that is
            done, first with memory and operations and 0, then with "assembly", "factorization" and
            "solution". Ctrl-C ends the work at any time, and so does what the function raises, which is
            raised here.
        num_threads : int, optional
            Threads; None for all. The response is equal to the bit for any number.

        Returns
        -------
        PreparedSkin
            Goes wherever a `Skin` goes; can be saved, loaded, and moved with the surface.

        Raises
        ------
        ResponseError
            If a node is double or no vertex, a part does not fit, or the preparation needs too much memory.
        TypeError
            If `progress` cannot be called or the fixed vertices of a body are no booleans.
        """
        surface = as_surface("surface", surface)
        response = build_prepared(
            self._constants,
            self.response,
            surface,
            nodes=nodes,
            progress=as_progress(progress),
            num_threads=as_integer_or_none("num_threads", num_threads, ResponseError, least=1),
        )
        return PreparedSkin._of(skin=self, _response=response)

    def combined(self, surface: Surface, parts: Mapping[str, tuple[CutOut, PreparedSkin]]) -> CombinedSkin:
        """Join bodies of parts of a skin with this kernel for the rest.

        Parameters
        ----------
        surface : Surface
            The whole skin, such as a hand.
        parts : mapping of str to (CutOut, PreparedSkin)
            For each part, by any name, how it was cut out of `surface` and its prepared body.

        Returns
        -------
        CombinedSkin
            Goes wherever a `Skin` goes.

        Raises
        ------
        ResponseError
            If a part does not fit, two overlap, this skin is no kernel of linear pressure, or one of them
            takes its gaps in Galerkin form. A contact raises it where a patch of candidates straddles a cut,
            naming the part; `CombinedSkin.without` leaves that part to the kernel.
        TypeError
            If `parts` is no mapping of names to a cut and its prepared skin.

        Notes
        -----
        A force on a part moves that part alone, a force off the parts the rest alone: patches on different
        sides of a cut do not couple, since each body is held there. Patches off the parts feel of each other
        what they do under the kernel alone.
        """
        return _combine(self, surface, parts)

    @property
    def _constants(self) -> ElasticConstants:
        return as_float("shear_modulus", self.shear_modulus), as_float("poisson_ratio", self.poisson_ratio)

    @property
    def _content(self) -> dict[str, Any]:
        """By name what the response of a body depends on, beside its surface and nodes."""
        content = {
            "shear modulus (Pa)": self.shear_modulus,
            "Poisson's ratio": self.poisson_ratio,
            "response": type(self.response).__name__,
        }
        if not isinstance(body := self.response, Body):
            return content
        return content | {
            "bone": body.bone and body.bone.vertices,
            "mesh of the bone": body.bone and body.bone.faces,
            "fixed part": body.fixed,
            "bone pressure": body.bone_pressure,
            "coarse edge length (m)": body.coarse_edge_length,
            "discretization": str(body.discretization or Discretization.COLLOCATION),
        }

    def _core_on(self, surface: Surface, num_threads: int | None) -> _core.Skin:
        if self._kernel is not None:
            return self._kernel
        return build_prepared(self._constants, self.response, surface, num_threads=num_threads)


@dataclass(frozen=True, init=False, eq=False)
class CombinedSkin(Made):
    """Bodies where they exist, a kernel off them; made by `Skin.combined`, goes wherever a `Skin` goes.

    Attributes
    ----------
    background : Skin
        The kernel off the parts.
    parts : mapping of str to (CutOut, PreparedSkin)
        The parts by name.
    """

    background: Skin
    parts: Mapping[str, tuple[CutOut, PreparedSkin]]
    _surface: Surface
    _response: _core.Skin
    _makers: ClassVar[str] = "`Skin.combined`"

    def without(self, *names: str) -> CombinedSkin:
        """Return the same with parts left to the kernel, as where a contact straddles their cut.

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
        return _combine(self.background, self._surface, kept)

    def bone_pressure(self, load: Contact | ArrayLike) -> dict[str, NDArray[np.float64]]:
        """Return the pressure on the bones of the parts.

        Parameters
        ----------
        load : Contact or (n, 3) array_like
            A contact solved with this skin, or forces (N) at the vertices of the whole skin.

        Returns
        -------
        dict of str to (m,) float64
            For each part that knows it, the pressure (Pa) at each vertex of its bone, as
            `PreparedSkin.bone_pressure`: under the forces on that part alone, its cut excepted.

        Raises
        ------
        ResponseError
            If no part was asked for it (``Body(..., bone_pressure=True)``), or a force is not finite or at a
            vertex that its part is not prepared for.
        """
        forces = as_reals("forces", forces_on_given_mesh(load))
        count = len(self._surface.vertices)
        if forces.shape != (count, 3):
            raise ResponseError(f"the forces have shape {forces.shape}, expected ({count}, 3)")
        found = {}
        for name, (cut, prepared) in self.parts.items():
            on_part = np.where(cut.fixed[:, None], 0.0, forces[cut.source_vertices])
            pressures, unprepared = bone_pressures_of(prepared._response, on_part)
            if pressures is None:
                continue
            if unprepared.size > 0:
                first = unprepared[0]
                raise ResponseError(
                    f"vertex {cut.source_vertices[first]} carries force, but part {name!r} was prepared for "
                    f"{len(prepared.nodes)} other vertices: prepare it for this one too, its vertex {first}"
                )
            found[name] = pressures
        if not found:
            raise ResponseError("no bone pressure is known: prepare `Body(bone=..., bone_pressure=True)`")
        return found

    def moved(self, rotation: ArrayLike | None = None, translation: ArrayLike | None = None) -> CombinedSkin:
        """Return the response of the surface after a rigid motion, ``rotation @ x + translation``.

        Parameters
        ----------
        rotation : (3, 3) or (4, 4) array_like, optional
            Proper rotation; a (4, 4) matrix holds the shift too.
        translation : (3,) array_like, optional
            Shift (m).

        Returns
        -------
        CombinedSkin
            For ``surface.moved(rotation, translation)``; its parts are moved too.
        """
        motion = (rotation, translation)
        response = self._response.moved(*motion)
        parts = {
            name: (replace(cut, surface=cut.surface.moved(*motion)), prepared.moved(*motion))
            for name, (cut, prepared) in self.parts.items()
        }
        return CombinedSkin._of(
            background=self.background,
            parts=parts,
            _surface=self._surface.moved(*motion),
            _response=response,
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what it is made of."""
        return _combine, (self.background, self._surface, dict(self.parts))

    def __repr__(self) -> str:
        """Return the names of the parts and the kernel on one line."""
        return f"CombinedSkin({', '.join(self.parts) or 'no parts'}, background {self.background!r})"

    def _core_on(self, surface: Surface, num_threads: int | None) -> _core.Skin:
        return self._response


def _combine(
    background: Skin, surface: Surface, parts: Mapping[str, tuple[CutOut, PreparedSkin]]
) -> CombinedSkin:
    if background._kernel is None:
        raise ResponseError("a combined skin needs a kernel off its parts, such as HalfSpace()")
    surface = as_surface("surface", surface)
    if not isinstance(parts, Mapping):
        raise TypeError(
            f"parts is a {type(parts).__name__}, expected a dict of names to (CutOut, PreparedSkin)"
        )
    for name, part in parts.items():
        _check_part(name, part)
    given = [
        (name, prepared._response, cut.part_vertices.tolist(), cut.fixed)
        for name, (cut, prepared) in parts.items()
    ]
    response = _core.Skin.combined(surface, background._kernel, given)
    return CombinedSkin._of(background=background, parts=dict(parts), _surface=surface, _response=response)


def _check_part(name: object, part: Any) -> None:
    if not isinstance(name, str):
        raise TypeError(f"the part {name!r} is named by a {type(name).__name__}, expected a str")
    match part:
        case [CutOut(), PreparedSkin()]:
            return
        case [CutOut(), Skin()]:
            why = "prepare the skin for the part's surface"
        case [PreparedSkin(), CutOut()]:
            why = "swap the two"
        case _:
            why = "cut_out and Skin.prepared make them"
    is_pair = isinstance(part, (tuple, list))
    kinds = ", ".join(type(member).__name__ for member in part) if is_pair else type(part).__name__
    found = f"({kinds})" if is_pair else f"a {kinds}"
    raise TypeError(f"part {name!r} is {found}, expected (CutOut, PreparedSkin): {why}")
