"""A skin whose response is computed once for a surface."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from ..errors import ResponseError
from .response import Body
from .storage import write_prepared

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    from ..contact.result import Contact
    from ..surface import Surface
    from .material import Skin

__all__ = ["PreparedSkin", "from_parts"]


@dataclass(frozen=True, kw_only=True, eq=False)
class PreparedSkin:
    """A skin whose response is computed for one surface; made by `Skin.prepared` or `load_prepared`.

    Attributes
    ----------
    skin : Skin
        Material and response that it came from; a body's bone and fixed vertices as they were when prepared.
    nodes : (k,) int64
        Vertices whose response is known.
    """

    skin: Skin
    core: _core.Skin = field(repr=False)

    @property
    def nodes(self) -> NDArray[np.int64]:
        """(k,) int64: vertices whose response is known."""
        return self.core.nodes()

    def bone_pressure(self, load: Contact | ArrayLike) -> NDArray[np.float64]:
        """Tell the pressure on a body's bone.

        Parameters
        ----------
        load : Contact or (n, 3) array_like
            A contact solved with this skin, or forces (N) at the vertices of its surface, zero where it is
            not prepared.

        Returns
        -------
        (m,) float64
            Pressure (Pa) at each vertex of the bone, positive where tissue pushes on it. At nu = 0.5 a
            uniform pressure on the skin arrives unchanged.

        Raises
        ------
        ResponseError
            If the body was not asked for it (``Body(..., bone_pressure=True)``) or has no bone.
        """
        forces: Any = getattr(load, "force_vectors", load)
        pressures = self.core.bone_pressures(forces)
        if pressures is None:
            raise ResponseError("no bone pressure is known: prepare Body(bone=..., bone_pressure=True)")
        return pressures

    def moved(self, rotation: ArrayLike, translation: ArrayLike) -> PreparedSkin:
        """The response of the surface after a rigid motion, ``rotation @ x + translation``.

        Parameters
        ----------
        rotation : (3, 3) array_like
            Proper rotation.
        translation : (3,) array_like
            Shift (m).

        Returns
        -------
        PreparedSkin
            For ``surface.moved(rotation, translation)``.
        """
        return PreparedSkin(skin=self.skin, core=self.core.moved(rotation, translation))

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
        write_prepared(
            path,
            self.core.parts(),
            shear_modulus=self.skin.shear_modulus,
            poisson_ratio=self.skin.poisson_ratio,
            response=self.skin.response,
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the numbers, as `save` does, beside the skin as it is."""
        return from_parts, (self.skin, self.core.parts())

    def core_on(self, surface: Surface) -> _core.Skin:
        """The core's skin, which refuses any other surface."""
        return self.core


def from_parts(skin: Skin, stored: dict[str, NDArray[Any]]) -> PreparedSkin:
    """The prepared skin of a skin and the numbers that `_core.Skin.parts` told."""
    surface = _core.Surface(stored["vertices"], stored["faces"])
    nodes = stored["nodes"]
    if skin.kernel is not None:
        core = skin.kernel.restore(surface, nodes, stored["matrix"])
    elif "matrix" in stored:
        core = _core.Skin.given(surface, nodes, stored["matrix"])
    else:
        core = _core.Skin.restore_body(
            surface,
            skin.shear_modulus,
            skin.poisson_ratio,
            nodes,
            stored["displacement"],
            stored["area_vectors"],
            stored["rotation"],
            bone_pressure=stored.get("bone_pressure"),
            solved=isinstance(skin.response, Body),
        )
    return PreparedSkin(skin=skin, core=core)
