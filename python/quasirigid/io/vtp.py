"""VTK XML PolyData (.vtp), binary inline: writing."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import Floats, Indices

__all__ = ["vtp_bytes"]


def vtp_bytes(
    vertices: Floats,
    faces: Indices,
    data: Mapping[str, NDArray[Any]],
    whole: Mapping[str, NDArray[Any]],
) -> bytes:
    """Return a file of triangles with `data` of a contact (as `vertex_data`) at each vertex.

    `whole` holds arrays of the mesh as a whole, of any length (VTK's field data).
    """
    lines = [
        '<?xml version="1.0"?>',
        "<!-- skin after contact, written by quasirigid; units: points, gap and displacement m, pressure Pa,"
        " node_force and force N -->",
        '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        "<PolyData>",
        "<FieldData>",
        *(_vtk_array(name, values, is_field=True) for name, values in whole.items()),
        "</FieldData>",
        f'<Piece NumberOfPoints="{len(vertices)}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0"'
        f' NumberOfPolys="{len(faces)}">',
        '<PointData Scalars="pressure" Vectors="displacement">',
        *(_vtk_array(name, values) for name, values in data.items()),
        "</PointData>",
        "<Points>",
        _vtk_array("points", vertices),
        "</Points>",
        "<Polys>",
        _vtk_array("connectivity", faces.ravel()),
        _vtk_array("offsets", 3 * np.arange(1, len(faces) + 1)),
        "</Polys>",
        "</Piece>",
        "</PolyData>",
        "</VTKFile>",
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def _vtk_array(name: str, values: NDArray[Any], *, is_field: bool = False) -> str:
    kind = {"f": "Float64", "i": "Int64", "u": "UInt8"}[values.dtype.kind]
    raw = np.ascontiguousarray(values.astype(values.dtype.newbyteorder("<"))).tobytes()
    width = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    text = base64.b64encode(len(raw).to_bytes(8, "little") + raw).decode("ascii")
    count = f' NumberOfTuples="{len(values)}"' if is_field else ""
    return f'<DataArray type="{kind}" Name="{name}"{width}{count} format="binary">{text}</DataArray>'
