"""PLY, ASCII and binary (Turk 1994), with vertices and faces in the order of the file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._arrays import Floats, Indices
from ..errors import MeshFileError
from .check import fans, lines_of, to_float, to_int

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8",
}  # fmt: skip
_COUNTERS = {kind for kind, dtype in _TYPES.items() if dtype[0] != "f"}
_FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True)
class _Property:
    name: str
    kind: str  # NumPy type of the value, or of a list's members
    counter: str | None  # NumPy type of a list's length; None for a plain value


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: list[_Property]


def read_ply(data: bytes, name: str) -> tuple[Floats, Indices]:
    """Return vertices (n, 3) and faces (m, 3) as stored; larger faces become fans."""
    order, elements, start = _header(data, name)
    corner_name = _check_header(elements, name)
    if order == "":
        columns = _ascii(data[start:], elements, name)
    else:
        columns = _binary(data, start, order, elements, name)
    vertices = np.stack([np.asarray(columns["vertex"][axis], dtype=np.float64) for axis in "xyz"], axis=1)
    corners = columns["face"][corner_name]
    if isinstance(corners, np.ndarray) and corners.ndim == 2 and corners.shape[1] == 3:
        return vertices, corners.astype(np.int64)
    rows = [[int(corner) for corner in face] for face in corners]
    for number, face in enumerate(rows):
        if len(face) < 3:
            few = sum(len(other) < 3 for other in rows)
            raise MeshFileError(
                f"{name}: face {number} has {len(face)} corners, expected at least 3 ({few} such)"
            )
    return vertices, fans(rows, vertices, name)


def _header(data: bytes, name: str) -> tuple[str, list[_Element], int]:
    if not data.startswith((b"ply\n", b"ply\r")):
        raise MeshFileError(f"{name}: does not start with 'ply'")
    end = re.search(rb"[\r\n]end_header(?:\r\n|\n|\r)", data)
    if end is None:
        raise MeshFileError(f"{name}: the header has no end ('end_header')")
    order: str | None = None
    elements: list[_Element] = []
    for number, line in enumerate(lines_of(data[: end.start()]), start=1):
        match line.split():
            case [] | ["ply"] | ["comment", *_] | ["obj_info", *_]:
                pass
            case ["format", kind, "1.0"] if kind in _FORMATS:
                order = _FORMATS[kind]
            case ["element", element, count] if count.isdecimal() and len(count) < 19:
                elements.append(_Element(element, int(count), []))
            case ["property", "list", counter, kind, prop] if (
                elements and counter in _COUNTERS and kind in _TYPES
            ):
                elements[-1].properties.append(_Property(prop, _TYPES[kind], _TYPES[counter]))
            case ["property", kind, prop] if elements and kind in _TYPES:
                elements[-1].properties.append(_Property(prop, _TYPES[kind], None))
            case _:
                raise MeshFileError(
                    f"{name}: line {number} of the header is not understood: '{line.strip()}'"
                )
    if order is None:
        raise MeshFileError(f"{name}: the header names no format")
    return order, elements, end.end()


def _check_header(elements: list[_Element], name: str) -> str:
    """Return the name of the list of corners; a header without what a mesh needs is refused."""
    for element in elements:
        names = [prop.name for prop in element.properties]
        if not names or len(set(names)) < len(names):
            raise MeshFileError(f"{name}: element '{element.name}' has no properties, or one of them twice")
    if len({element.name for element in elements}) < len(elements):
        raise MeshFileError(f"{name}: the header names an element twice")
    found = {(element.name, prop.name): prop for element in elements for prop in element.properties}
    for axis in "xyz":
        prop = found.get(("vertex", axis))
        if prop is None or prop.counter:
            raise MeshFileError(f"{name}: the header has no element 'vertex' with a number '{axis}'")
    for corner_name in ("vertex_indices", "vertex_index"):
        prop = found.get(("face", corner_name))
        if prop is not None and prop.counter and prop.kind[0] != "f":
            return corner_name
    raise MeshFileError(
        f"{name}: the header has no element 'face' with a list of whole numbers 'vertex_indices'"
    )


def _binary(
    data: bytes, start: int, order: str, elements: list[_Element], name: str
) -> dict[str, dict[str, Any]]:
    columns: dict[str, dict[str, Any]] = {}
    at = start
    for element in elements:
        if element.count == 0:
            columns[element.name] = {prop.name: [] for prop in element.properties}
            continue
        dtype = _row_type(data, at, order, element)
        if dtype is not None and at + dtype.itemsize * element.count <= len(data):
            table = np.frombuffer(data, dtype, element.count, at)
            counts = [table[f"#{prop.name}"] for prop in element.properties if prop.counter]
            if all((count == count[:1]).all() for count in counts):
                columns[element.name] = {prop.name: table[prop.name] for prop in element.properties}
                at += dtype.itemsize * element.count
                continue
        columns[element.name], at = _rows_of_lists(data, at, order, element, name)
    if at != len(data):
        raise MeshFileError(f"{name}: {len(data) - at} bytes are left after the last element")
    return columns


def _row_type(data: bytes, at: int, order: str, element: _Element) -> np.dtype[Any] | None:
    """Return the type of a row, all lists as long as the first row's; None where that row is cut off."""
    fields: list[Any] = []
    for prop in element.properties:
        if prop.counter is None:
            fields.append((prop.name, order + prop.kind))
            at += np.dtype(prop.kind).itemsize
        else:
            counter = np.dtype(order + prop.counter)
            if at + counter.itemsize > len(data):
                return None
            length = max(0, int(np.frombuffer(data, counter, 1, at)[0]))
            if at + length * np.dtype(prop.kind).itemsize > len(data):
                return None
            fields += [(f"#{prop.name}", counter), (prop.name, order + prop.kind, (length,))]
            at += counter.itemsize + length * np.dtype(prop.kind).itemsize
    return np.dtype(fields)


def _rows_of_lists(
    data: bytes, at: int, order: str, element: _Element, name: str
) -> tuple[dict[str, list[Any]], int]:
    """Read row by row: for lists of several lengths, and to find where a file ends too early."""
    columns: dict[str, list[Any]] = {prop.name: [] for prop in element.properties}
    for row in range(element.count):
        for prop in element.properties:
            length = 1
            for kind, is_counter in ((prop.counter, True), (prop.kind, False)):
                if kind is None:
                    continue
                dtype = np.dtype(order + kind)
                wanted = dtype.itemsize * (1 if is_counter else length)
                if length < 0 or at + wanted > len(data):
                    raise MeshFileError(
                        f"{name}: ends in {element.name} {row} of {element.count} (after {len(data)} bytes)"
                    )
                values = np.frombuffer(data, dtype, 1 if is_counter else length, at)
                at += wanted
                if is_counter:
                    length = int(values[0])
            columns[prop.name].append(values if prop.counter else values[0])
    return columns, at


def _ascii(text: bytes, elements: list[_Element], name: str) -> dict[str, dict[str, Any]]:
    lines = [line for line in lines_of(text) if line.strip()]
    columns: dict[str, dict[str, Any]] = {}
    at = 0
    for element in elements:
        table: dict[str, list[Any]] = {prop.name: [] for prop in element.properties}
        for row in range(element.count):
            if at == len(lines):
                raise MeshFileError(f"{name}: ends in {element.name} {row} of {element.count}")
            words = lines[at].split()
            at += 1
            try:
                for prop in element.properties:
                    length = to_int(words.pop(0)) if prop.counter else 1
                    taken, words = words[:length], words[length:]
                    if len(taken) < length or length < 0:
                        raise IndexError
                    values = [to_float(word) if prop.kind[0] == "f" else to_int(word) for word in taken]
                    table[prop.name].append(values if prop.counter else values[0])
                if words:
                    raise IndexError
            except (ValueError, IndexError):
                wrong = lines[at - 1].strip()[:60]
                raise MeshFileError(f"{name}: {element.name} {row} is not understood: '{wrong}'") from None
        columns[element.name] = table
    if at != len(lines):
        raise MeshFileError(f"{name}: {len(lines) - at} lines are left after the last element")
    return columns


def ply_bytes(comments: list[str], columns: Mapping[str, Floats], faces: Indices) -> bytes:
    """Return a binary little-endian PLY with a double property for each column."""
    rows = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, faces
    values = np.column_stack(list(columns.values())).astype("<f8")
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *(f"comment {comment}" for comment in comments),
        f"element vertex {len(values)}",
        *(f"property double {name}" for name in columns),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    return ("\n".join(header) + "\n").encode("ascii") + values.tobytes() + rows.tobytes()
