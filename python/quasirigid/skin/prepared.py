"""A skin's response, computed once for a surface and stored."""

from __future__ import annotations

import errno
import json
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from ..contact.result import Contact
from ..errors import ResponseError
from .material import Skin
from .response import Body, GaussianCorrected, GivenMatrix, HalfSpace, Layer, Response

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    from ..surface import Surface

__all__ = ["PreparedSkin", "load_prepared"]


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
    _response: _core.Skin = field(repr=False)

    @property
    def nodes(self) -> NDArray[np.int64]:
        """(k,) int64: vertices whose response is known."""
        return self._response.nodes()

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
        forces = load.force_vectors if isinstance(load, Contact) else load
        pressures = self._response.bone_pressures(forces)
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
        return PreparedSkin(skin=self.skin, _response=self._response.moved(rotation, translation))

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
        target = Path(path)
        if not target.parent.is_dir():
            raise FileNotFoundError(errno.ENOENT, "there is no folder", str(target.parent))
        arrays: dict[str, Any] = {**self._response.parts(), **_fields(self.skin)}
        header = {"format": _FORMAT, "version": _VERSION, **_describe(self.skin)}
        partial = target.with_name(target.name + ".partial")
        try:
            with partial.open("wb") as file:
                np.savez(file, header=np.array(json.dumps(header)), **arrays)
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the numbers, as `save` does, beside the skin as it is."""
        return _from_parts, (self.skin, self._response.parts())

    def _on(self, surface: Surface) -> _core.Skin:
        return self._response


_FORMAT = "quasirigid prepared skin"
_VERSION = 1
_KERNELS = (HalfSpace, GaussianCorrected, Layer)


def _describe(skin: Skin) -> dict[str, Any]:
    """The material and the response's numbers."""
    response = skin.response
    numbers: dict[str, Any] = {}
    if not isinstance(response, (Body, GivenMatrix)):
        for name, value in vars(response).items():
            if value is None or isinstance(value, str):
                numbers[name] = value
            elif np.ndim(value) == 0:
                # NumPy's numbers too, which JSON does not know.
                numbers[name] = float(value)
    return {
        "shear_modulus": float(skin.shear_modulus),
        "poisson_ratio": float(skin.poisson_ratio),
        "response": type(response).__name__,
        "numbers": numbers,
    }


def _fields(skin: Skin) -> dict[str, NDArray[Any]]:
    """The response's fields over the surface, and a body's bone."""
    fields: dict[str, NDArray[Any]] = {}
    if isinstance(skin.response, Body):
        if skin.response.bone is not None:
            fields |= {"bone_vertices": skin.response.bone.vertices, "bone_faces": skin.response.bone.faces}
        if skin.response.fixed is not None:
            fields["fixed"] = np.asarray(skin.response.fixed, dtype=np.bool_)
        return fields
    if isinstance(skin.response, Layer) and np.ndim(skin.response.thickness) > 0:
        return {"thickness": np.asarray(skin.response.thickness, dtype=np.float64)}
    return {}


def load_prepared(path: str | PathLike[str]) -> PreparedSkin:
    """Read what `PreparedSkin.save` wrote.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    PreparedSkin
        Equal to the one saved, to the bit. Using it with another surface is an error that says what differs.

    Raises
    ------
    ResponseError
        If the file is no prepared skin, is damaged or from a later version.
    """
    try:
        loaded = np.load(path, allow_pickle=False)
        if not isinstance(loaded, np.lib.npyio.NpzFile):
            raise ValueError("it holds a single array, expected a .npz file")
        with loaded as file:
            stored = {name: file[name] for name in file.files}
        header = json.loads(str(stored["header"]))
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError) as error:
        if isinstance(error, FileNotFoundError):
            raise
        raise ResponseError(f"{path} cannot be read as a prepared skin: {error}") from error
    if not isinstance(header, dict) or header.get("format") != _FORMAT or header.get("version") != _VERSION:
        raise ResponseError(f"{path} is no prepared skin of version {_VERSION}")
    try:
        return _restore(header, stored)
    except (KeyError, TypeError) as error:
        raise ResponseError(f"{path} lacks or misnames a part of a prepared skin: {error}") from error


def _restore(header: dict[str, Any], stored: dict[str, NDArray[Any]]) -> PreparedSkin:
    material = {name: header[name] for name in ("shear_modulus", "poisson_ratio")}
    kind = header["response"]
    response: Response
    if kind == "Body":
        response = _restored_body(stored)
    elif kind == "GivenMatrix":
        nodes = stored["nodes"]
        blocks = "matrix" not in stored
        compliance = (
            stored["displacement"].reshape(-1, 3, len(nodes), 3)[nodes] if blocks else stored["matrix"]
        )
        response = GivenMatrix(nodes, compliance)
    else:
        kernels: dict[str, Any] = {
            kernel.__name__: kernel for kernel in (HalfSpace, GaussianCorrected, Layer)
        }
        fields = {name: stored[name] for name in ("thickness",) if name in stored}
        response = kernels[kind](**header["numbers"], **fields)
    return _from_parts(Skin(**material, response=response), stored)


def _from_parts(skin: Skin, stored: dict[str, NDArray[Any]]) -> PreparedSkin:
    """The prepared skin of a skin and the numbers that `_core.Skin.parts` told."""
    surface = _core.Surface(stored["vertices"], stored["faces"])
    nodes = stored["nodes"]
    if skin._kernel is not None:
        core = skin._kernel.restore(surface, nodes, stored["matrix"])
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
    return PreparedSkin(skin=skin, _response=core)


def _restored_body(stored: dict[str, NDArray[Any]]) -> Body:
    """The body as it was described; files of before have nothing of it."""
    bone = None
    if "bone_vertices" in stored:
        bone = _core.Surface(stored["bone_vertices"], stored["bone_faces"])
    return Body(bone=bone, fixed=stored.get("fixed"), bone_pressure="bone_pressure" in stored)
