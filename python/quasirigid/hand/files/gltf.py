"""glTF 2.0, binary or as text: the container and its arrays, strictly."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

import numpy as np

from ..._check import short
from ...errors import MeshFileError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Gltf"]

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_JSON, _BINARY = 0x4E4F534A, 0x004E4942


class Gltf:
    """A glTF file: its description and its arrays.

    Parameters
    ----------
    path : Path
        The file: .glb, or .gltf with its arrays in it or in files beside it.

    Raises
    ------
    MeshFileError
        It cannot be read, is no glTF of version 2, ends too early, or describes what is not in it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        data = _bytes_of(path)
        chunks = {_JSON: data} if path.suffix.lower() == ".gltf" else self._chunks(data)
        if _JSON not in chunks:
            raise MeshFileError(f"{path}: it has no description (JSON chunk)")
        try:
            self.description: Any = json.loads(chunks[_JSON])
        except (ValueError, RecursionError) as error:
            raise MeshFileError(f"{path}: its description is no JSON: {error}") from None
        if not isinstance(self.description, dict):
            raise MeshFileError(f"{path}: its description is no object, but {short(self.description)}")
        self._binary = chunks.get(_BINARY)
        self._buffers: dict[int, bytes] = {}
        needed = self.entry("extensionsRequired") if "extensionsRequired" in self.description else []
        if needed:
            raise MeshFileError(f"{path}: it needs the extension {needed[0]}: save it without compression")

    def _chunks(self, data: bytes) -> dict[int, bytes]:
        if data[:4] != b"glTF":
            raise MeshFileError(f"{self.path}: it does not begin as a GLB does (binary glTF)")
        if len(data) < 12:
            raise MeshFileError(f"{self.path}: it ends in its header")
        version, length = struct.unpack_from("<II", data, 4)
        if version != 2:
            raise MeshFileError(f"{self.path}: it is glTF version {version}, expected 2")
        if length > len(data):
            raise MeshFileError(f"{self.path}: it ends after {len(data)} of {length} bytes")
        chunks: dict[int, bytes] = {}
        at = 12
        while at + 8 <= length:
            size, kind = struct.unpack_from("<II", data, at)
            if at + 8 + size > length:
                raise MeshFileError(f"{self.path}: a chunk of {size} bytes at byte {at} goes beyond the end")
            chunks.setdefault(kind, data[at + 8 : at + 8 + size])
            at += 8 + size
        return chunks

    def entry(self, *way: str | int) -> Any:
        """Return what stands in the description at the end of a way of names and numbers."""
        found = self.description
        for step in way:
            try:
                if isinstance(step, int) and step < 0:
                    raise IndexError
                found = found[step]
            except (KeyError, IndexError, TypeError):
                raise MeshFileError(
                    f"{self.path}: its description has no {'/'.join(map(str, way))}"
                ) from None
        return found

    def objects(self, *way: str | int) -> list[dict[str, Any]]:
        """Return the list of objects at the end of a way."""
        found = self.entry(*way)
        if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
            raise MeshFileError(
                f"{self.path}: its description has {short(found)} as {'/'.join(map(str, way))}, "
                "expected objects"
            )
        return found

    def rows(self, accessor: Any) -> NDArray[Any]:
        """Return the array (n, k) of an accessor by its number; normalised integers as shares of 1."""
        self.objects("accessors")
        known = self.entry("accessors", accessor)
        if "sparse" in known or "bufferView" not in known:
            raise MeshFileError(f"{self.path}: accessors/{accessor} is sparse or empty, which is not read")
        try:
            kind = np.dtype(_TYPES[known["componentType"]])
            columns, count = _COLUMNS[known["type"]], int(known["count"])
            self.objects("bufferViews")
            view = self.entry("bufferViews", known["bufferView"])
            start = int(view.get("byteOffset", 0)) + int(known.get("byteOffset", 0))
            width = columns * kind.itemsize
            stride = int(view.get("byteStride", width))
        except (KeyError, TypeError, ValueError, OverflowError):
            raise MeshFileError(f"{self.path}: accessors/{accessor} describes no array: {known}") from None
        buffer = self._buffer(view.get("buffer"))
        end = start + (count - 1) * stride + width if count else start
        if min(count, start) < 0 or stride < width or end > len(buffer):
            raise MeshFileError(
                f"{self.path}: accessors/{accessor} reads up to byte {end}, there are {len(buffer)}"
            )
        raw = np.ndarray((count, columns), kind, buffer, start, (stride, kind.itemsize))
        if known.get("normalized") and kind.kind in "iu":
            return np.maximum(raw / float(np.iinfo(kind).max), -1.0)
        return raw.copy()

    def _buffer(self, number: Any) -> bytes:
        """Return a buffer by its number: the file's own, one within the description, or a file beside it."""
        self.objects("buffers")
        uri = self.entry("buffers", number).get("uri")
        if number not in self._buffers:
            if uri is None and number == 0 and self._binary is not None:
                self._buffers[number] = self._binary
            elif isinstance(uri, str) and uri.startswith("data:"):
                try:
                    self._buffers[number] = base64.b64decode(uri.partition(";base64,")[2], validate=True)
                except binascii.Error as error:
                    raise MeshFileError(f"{self.path}: buffers/{number} is no base64: {error}") from None
            elif isinstance(uri, str) and (beside := Path(unquote(uri))).name == str(beside) != "":
                self._buffers[number] = _bytes_of(self.path.with_name(beside.name))
            else:
                raise MeshFileError(
                    f"{self.path}: buffers/{number} is {short(uri)}, expected a file beside it or its bytes"
                )
        return self._buffers[number]


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise MeshFileError(f"{path}: {error.strerror or error}") from None
