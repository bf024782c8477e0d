"""Files of prepared skins: a NumPy archive of the response's numbers, with the material in a JSON header."""

from __future__ import annotations

import io
import json
import math
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import as_float_or_none, as_path
from ..errors import ResponseError
from ..io.atomic import atomic_write
from ..surface import Surface
from .response import Body, GaussianCorrected, GivenMatrix, HalfSpace, Layer, Response

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike

    from numpy.typing import NDArray

    from .core import ElasticConstants

__all__ = ["read_prepared", "restored_response", "write_prepared"]

_FORMAT = "quasirigid prepared skin"
_VERSION = 3
# What a part holds, where it is not float64.
_DTYPES = dict.fromkeys(("nodes", "faces", "bone_faces", "coarse_nodes", "coarse_corners"), "int64")
_DTYPES |= dict.fromkeys(("fixed", "held"), "bool")


def write_prepared(
    path: str | PathLike[str],
    parts: Mapping[str, NDArray[Any]],
    constants: ElasticConstants,
    response: Response,
) -> None:
    """Write the numbers of a prepared response and the material, whole or not at all.

    Parameters
    ----------
    path : path
        The file.
    parts : mapping of str to array
        As `_core.skin_parts` returns them.
    constants, response
        Shear modulus (Pa) and Poisson's ratio of the `Skin` that was prepared, and its response.

    Raises
    ------
    OSError
        If the folder does not exist or cannot be written to.
    """
    arrays: dict[str, Any] = {**parts, **_fields(response)}
    header = {
        "format": _FORMAT,
        "version": _VERSION,
        "shear_modulus": float(constants[0]),
        "poisson_ratio": float(constants[1]),
        "response": type(response).__name__,
        "numbers": _numbers(response),
        "parts": sorted(arrays),
    }
    with atomic_write(path) as file:
        np.savez(file, header=np.array(json.dumps(header)), **arrays)


def _numbers(response: Response) -> dict[str, Any]:
    """Return the response's numbers and choices."""
    if isinstance(response, Body):
        return {
            "coarse_edge_length": as_float_or_none("coarse_edge_length", response.coarse_edge_length),
            "discretization": response.discretization,
        }
    if isinstance(response, GivenMatrix):
        return {}
    # NumPy's numbers too, which JSON does not know.
    return {
        name: value if value is None or isinstance(value, str) else float(value)
        for name, value in vars(response).items()
        if np.ndim(value) == 0
    }


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
    """Read the header and the arrays that `write_prepared` wrote; nothing in the file is unpickled.

    No more is read than the file is long: what is compressed, or promises more than it holds, is refused.

    Raises
    ------
    ResponseError
        If the file is no prepared skin, is damaged or from a later version.
    """
    file_path = as_path("path", path)
    try:
        with file_path.open("rb") as file:
            if file.read(len(np.lib.format.MAGIC_PREFIX)) == np.lib.format.MAGIC_PREFIX:
                raise ValueError("it holds a single array, expected a .npz file")
        with zipfile.ZipFile(file_path) as archive:
            members = archive.infolist()
            names = [member.filename.removesuffix(".npy") for member in members]
            if "header" not in names:
                raise ValueError("it holds no prepared skin")
            if len(set(names)) < len(names):
                raise ValueError("it holds a part twice")
            if any(member.compress_type != zipfile.ZIP_STORED for member in members):
                raise ValueError("its parts are compressed, and such files are not read: save it with `save`")
            if sum(member.file_size for member in members) > file_path.stat().st_size:
                raise ValueError("its parts are longer than itself")
            stored = {name: _array_of(archive, member) for name, member in zip(names, members, strict=True)}
        header = json.loads(str(stored["header"]))
    except Exception as error:
        raise ResponseError(f"{path} cannot be read as a prepared skin: {error}") from error
    if not isinstance(header, dict) or header.get("format") != _FORMAT or header.get("version") != _VERSION:
        raise ResponseError(f"{path} is no prepared skin of version {_VERSION}")
    found, expected = sorted(stored.keys() - {"header"}), header.get("parts")
    if found != expected:
        raise ResponseError(
            f"{path} lacks or misnames a part of a prepared skin: it holds {found}, expected {expected}"
        )
    for name in found:
        dtype, wanted = stored[name].dtype, _DTYPES.get(name, "float64")
        if dtype != wanted:
            raise ResponseError(
                f"{path} holds no sound prepared skin: {name} has dtype {dtype}, expected {wanted}"
            )
    return header, stored


def _array_of(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    """Return a member's array, as NumPy writes it; a ValueError where it is not as long as it says."""
    data = io.BytesIO(archive.read(member))
    version = np.lib.format.read_magic(data)
    read = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }.get(version)
    if read is None:
        raise ValueError(f"{member.filename} has format {version}")
    shape, by_columns, dtype = read(data)
    if dtype.hasobject or min(shape, default=0) < 0:
        raise ValueError(f"{member.filename} holds no numbers")
    held = len(data.getbuffer()) - data.tell()
    if math.prod(shape) * dtype.itemsize != held:
        raise ValueError(f"{member.filename} promises {shape} entries of {dtype}, but holds {held} bytes")
    flat = np.frombuffer(data.getvalue(), dtype, math.prod(shape), data.tell())
    return flat.reshape(shape, order="F" if by_columns else "C")


def restored_response(header: Mapping[str, Any], stored: Mapping[str, NDArray[Any]]) -> Response:
    """Return the response that `write_prepared` wrote.

    Raises
    ------
    KeyError, TypeError, ValueError
        If the header or a part is damaged.
    """
    kind = header["response"]
    if kind == "Body":
        return _restored_body(stored, header["numbers"])
    if kind == "GivenMatrix":
        nodes = stored["nodes"]
        count = len(nodes)
        blocks = "matrix" not in stored
        compliance = stored["displacement"].reshape(count, 3, count, 3) if blocks else stored["matrix"]
        return GivenMatrix(nodes=nodes, compliance=compliance)
    kernels: dict[str, Any] = {kernel.__name__: kernel for kernel in (HalfSpace, GaussianCorrected, Layer)}
    fields = {"thickness": stored["thickness"]} if "thickness" in stored else {}
    response: Response = kernels[kind](**header["numbers"], **fields)
    return response


def _restored_body(stored: Mapping[str, NDArray[Any]], numbers: Mapping[str, Any]) -> Body:
    """Return the body that `write_prepared` wrote."""
    bone = None
    if "bone_vertices" in stored:
        bone = Surface(stored["bone_vertices"], stored["bone_faces"])
    kept = "bone_pressure" in stored
    return Body(bone=bone, fixed=stored.get("fixed"), bone_pressure=kept, **numbers)
