"""Files of prepared skins: a NumPy archive of the response's numbers, with the material in a JSON header."""

from __future__ import annotations

import errno
import json
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ResponseError
from ..io.atomic import atomic_write
from ..surface import Surface
from .response import Body, GaussianCorrected, GivenMatrix, HalfSpace, Layer, Response

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike

    from numpy.typing import NDArray

__all__ = ["read_prepared", "restored_response", "write_prepared"]

_FORMAT = "quasirigid prepared skin"
_VERSION = 1


def write_prepared(
    path: str | PathLike[str],
    parts: Mapping[str, NDArray[Any]],
    material: tuple[float, float],
    response: Response,
) -> None:
    """Write the numbers of a prepared response and the material, whole or not at all.

    Parameters
    ----------
    path : path
        The file.
    parts : mapping of str to array
        As `_core.Skin.parts` returns them.
    material, response
        Shear modulus (Pa) and Poisson's ratio of the `Skin` that was prepared, and its response.

    Raises
    ------
    OSError
        If the folder does not exist or cannot be written to.
    """
    target = Path(path)
    if not target.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "there is no folder", str(target.parent))
    arrays: dict[str, Any] = {**parts, **_fields(response)}
    header = {
        "format": _FORMAT,
        "version": _VERSION,
        "shear_modulus": float(material[0]),
        "poisson_ratio": float(material[1]),
        "response": type(response).__name__,
        "numbers": _numbers(response),
    }
    with atomic_write(target) as file:
        np.savez(file, header=np.array(json.dumps(header)), **arrays)


def _numbers(response: Response) -> dict[str, Any]:
    """Return the response's numbers and choices."""
    numbers: dict[str, Any] = {}
    if isinstance(response, Body):
        return {"coarse_edge_length": response.coarse_edge_length}
    if not isinstance(response, GivenMatrix):
        for name, value in vars(response).items():
            if value is None or isinstance(value, str):
                numbers[name] = value
            elif np.ndim(value) == 0:
                # NumPy's numbers too, which JSON does not know.
                numbers[name] = float(value)
    return numbers


def _fields(response: Response) -> dict[str, NDArray[Any]]:
    """Return the response's fields over the surface, and a body's bone."""
    fields: dict[str, NDArray[Any]] = {}
    if isinstance(response, Body):
        if response.bone is not None:
            fields |= {"bone_vertices": response.bone.vertices, "bone_faces": response.bone.faces}
        if response.fixed is not None:
            fields["fixed"] = np.asarray(response.fixed, dtype=np.bool_)
        return fields
    if isinstance(response, Layer) and np.ndim(response.thickness) > 0:
        return {"thickness": np.asarray(response.thickness, dtype=np.float64)}
    return {}


def read_prepared(path: str | PathLike[str]) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Read the header and the arrays that `write_prepared` wrote.

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
    return header, stored


def restored_response(header: Mapping[str, Any], stored: Mapping[str, NDArray[Any]]) -> Response:
    """Return the response that `write_prepared` wrote; KeyError or TypeError where it lacks a part."""
    kind = header["response"]
    if kind == "Body":
        return _restored_body(stored, header["numbers"])
    if kind == "GivenMatrix":
        nodes = stored["nodes"]
        blocks = "matrix" not in stored
        compliance = (
            stored["displacement"].reshape(-1, 3, len(nodes), 3)[nodes] if blocks else stored["matrix"]
        )
        return GivenMatrix(nodes=nodes, compliance=compliance)
    kernels: dict[str, Any] = {kernel.__name__: kernel for kernel in (HalfSpace, GaussianCorrected, Layer)}
    fields = {name: stored[name] for name in ("thickness",) if name in stored}
    response: Response = kernels[kind](**header["numbers"], **fields)
    return response


def _restored_body(stored: Mapping[str, NDArray[Any]], numbers: Mapping[str, Any]) -> Body:
    """Return the body that `write_prepared` wrote."""
    bone = None
    if "bone_vertices" in stored:
        bone = Surface(stored["bone_vertices"], stored["bone_faces"])
    kept = "bone_pressure" in stored
    return Body(bone=bone, fixed=stored.get("fixed"), bone_pressure=kept, **numbers)
