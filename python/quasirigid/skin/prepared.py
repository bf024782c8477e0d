"""A skin whose response is computed for one surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .. import _core
from .._frozen import Made
from ..errors import ResponseError
from .core import restore_prepared
from .given_mesh import forces_on_given_mesh
from .storage import write_prepared

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    from ..contact.result import Contact
    from ..surface import Surface
    from .skins import Skin

__all__ = ["PreparedSkin", "restore_skin"]


@dataclass(frozen=True, init=False, eq=False)
class PreparedSkin(Made):
    """A skin whose response is computed for one surface; made by `Skin.prepared` or `load_prepared`.

    Attributes
    ----------
    skin : Skin
        Material and response that it came from; a body's bone and fixed vertices as they were when prepared.
    """

    skin: Skin
    _response: _core.Skin
    _makers: ClassVar[str] = "`Skin.prepared` or `load_prepared`"

    @property
    def nodes(self) -> NDArray[np.int64]:
        """(k,) int64: vertices whose response is known."""
        return self._response.nodes()

    def bone_pressure(self, load: Contact | ArrayLike) -> NDArray[np.float64]:
        """Return the pressure on a body's bone.

        Parameters
        ----------
        load : Contact or (n, 3) array_like
            A contact solved with this skin, or forces (N) at the vertices of its surface, zero where it is
            not prepared.

        Returns
        -------
        (m,) float64
            Pressure (Pa) at each vertex of the bone, positive where tissue pushes on it. At nu = 0.5 a
            uniform pressure on the skin arrives unchanged, but for the mesh: 2 to 3 % where the body is
            solved on a coarse one, as by default; with ``coarse_edge_length=0`` 0.2 % on 642 vertices.

        Raises
        ------
        ResponseError
            If the body was not asked for it (``Body(..., bone_pressure=True)``) or has no bone, or a force is
            not finite or at a vertex that it is not prepared for.
        """
        forces = forces_on_given_mesh(load)
        pressures, unprepared = bone_pressures_of(self._response, forces)
        if pressures is None:
            raise ResponseError("no bone pressure is known: prepare `Body(bone=..., bone_pressure=True)`")
        if unprepared.size > 0:
            raise ResponseError(
                f"vertex {unprepared[0]} carries force, but the response was prepared for {len(self.nodes)} "
                "other vertices: prepare it for this one too"
            )
        return pressures

    def moved(self, rotation: ArrayLike | None = None, translation: ArrayLike | None = None) -> PreparedSkin:
        """Return the response of the surface after a rigid motion, ``rotation @ x + translation``.

        Parameters
        ----------
        rotation : (3, 3) or (4, 4) array_like, optional
            Proper rotation; a (4, 4) matrix holds the shift too.
        translation : (3,) array_like, optional
            Shift (m).

        Returns
        -------
        PreparedSkin
            For ``surface.moved(rotation, translation)``.
        """
        return PreparedSkin._of(skin=self.skin, _response=self._response.moved(rotation, translation))

    def save(self, path: str | PathLike[str]) -> None:
        """Write it to a file, whole or not at all.

        Parameters
        ----------
        path : path
            A file, by custom named ``.npz``: numbers of the response, and the mesh and material that it is
            for.

        Raises
        ------
        OSError
            If the folder does not exist or cannot be written to.
        """
        write_prepared(path, _core.skin_parts(self._response), self.skin._constants, self.skin.response)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the numbers, as `save` does, beside the skin as it is."""
        return restore_skin, (self.skin, _core.skin_parts(self._response))

    def __repr__(self) -> str:
        """Return the number of nodes and the skin on one line."""
        return f"PreparedSkin({len(self.nodes)} nodes, {self.skin!r})"

    def _core_on(self, surface: Surface, num_threads: int | None) -> _core.Skin:
        return self._response


def bone_pressures_of(
    response: _core.Skin, forces: ArrayLike
) -> tuple[NDArray[np.float64] | None, NDArray[np.int64]]:
    """Return the pressure on the bone, where it is known, and the vertices under force that are not prepared.

    The pressure is that of the forces at the prepared vertices alone.
    """
    rows = np.asarray(forces)
    if rows.dtype.kind not in "fiu" or rows.ndim != 2:
        return response.bone_pressures(forces), np.empty(0, dtype=np.int64)
    other = ~np.isin(np.arange(len(rows)), response.nodes())
    pressures = response.bone_pressures(np.where(other[:, None], 0.0, rows))
    return pressures, np.flatnonzero(other & rows.any(axis=1))


def restore_skin(skin: Skin, stored: Mapping[str, NDArray[Any]]) -> PreparedSkin:
    """Return the prepared skin of a skin and the numbers that `_core.skin_parts` returned."""
    return PreparedSkin._of(skin=skin, _response=restore_prepared(skin._constants, skin.response, stored))
