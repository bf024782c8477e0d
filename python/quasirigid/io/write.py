"""Results out: deformed skin as PLY and VTP, arrays as NPZ, scalars with their units as JSON, the product.

Arrays are in SI, as everywhere in the package.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._arrays import Floats, Indices
from .._check import as_boolean, as_path, reals_or_empty, short
from .._extras import need_matplotlib
from .._units import LengthUnit, metres_in
from ..errors import MeshFileError
from .atomic import atomic_write, json_bytes, png_bytes, write_files
from .check import check_float32, check_values, triangle_rows
from .frame import vertex_data
from .ply import ply_bytes
from .record import contact_record, inputs_record
from .stl import stl_bytes
from .vtp import vtp_bytes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..contact.result import Contact
    from ..surface import Surface

__all__ = ["CONTACT_FILES", "GRASP_OWN_FILES", "save_contact", "save_pictures", "write_mesh"]

# All that `save_contact` may write.
CONTACT_FILES = (
    "contact.json",
    "contact.npz",
    "deformed.ply",
    "deformed.vtp",
    "deformed_product.ply",
    "footprint.png",
    "product.ply",
    "skin.png",
)
# What else `save_grasp` may write.
GRASP_OWN_FILES = ("grasp.json", "grasp.png", "hand.glb")
# Without its record nothing says that files of these names are an earlier result's.
_BY_RECORD = {"contact.json": CONTACT_FILES, "grasp.json": GRASP_OWN_FILES}

_NO_TRIANGLES = "not written: a primitive has no triangles"


def save_contact(
    contact: Contact,
    folder: str | PathLike[str],
    *,
    inputs: Mapping[str, Any] | None = None,
    pictures: bool = False,
    bone: Surface | None = None,
    unreached: str | None = None,
) -> tuple[Path, ...]:
    """Write everything about a contact into a folder.

    `deformed.ply` and `deformed.vtp` (ParaView) hold the deformed skin, the latter with what
    `vertex_data` returns; `contact.npz` the arrays, named as on `Contact`, with `vertices`, `faces` and
    `skin_mask` of the deformed skin; `contact.json` status, figures with their units, accuracy, what
    each round of refinement gave, timings, what was left out, and `inputs`; `product.ply` the triangles
    of the product where it stands (a primitive has none, and `contact.json` the arguments that make it, its
    `rotation` and `translation`), and `deformed_product.ply` those of one with a material under the forces;
    `skin.png` and `footprint.png` the pictures.

    Parameters
    ----------
    contact : Contact
        The contact.
    folder : path
        Made where it is missing. Files of these names are replaced, each of them whole; beside the
        `contact.json` of an earlier contact the rest of them is removed, and beside a `grasp.json` what is a
        grasp's alone; others stay. `contact.json` is removed first and comes after all other files but the
        pictures: a folder that has it has all numbers, also where a run was ended or no picture can be drawn.
    inputs : mapping, optional
        What the contact was computed from, for `contact.json`.
    pictures : bool
        Draw the pictures too (extra `plot`).
    bone : Surface, optional
        Bones to draw in the cut.
    unreached : str, optional
        Of a contact that only comes nearest to what was asked for, why that is out of reach.

    Returns
    -------
    tuple of Path
        The files.

    Raises
    ------
    MissingExtraError
        If pictures are asked for and matplotlib is not installed.
    OSError
        If the folder cannot be written to.
    """
    if as_boolean("pictures", pictures):
        need_matplotlib()
    place = as_path("folder", folder)
    contents = dict(_files(contact, inputs_record(inputs), unreached))
    records = [record for record in _BY_RECORD if (place / record).exists()]
    earlier = {name for record in records for name in _BY_RECORD[record]}
    # The records in front: without them a folder holds nothing whole.
    files = write_files(place, contents, instead_of=[*records, *(earlier - contents.keys())])
    return files + save_pictures(contact, place, bone=bone) if pictures else files


def save_pictures(
    contact: Contact, folder: str | PathLike[str], *, bone: Surface | None = None
) -> tuple[Path, ...]:
    """Write the pictures of a contact into a folder."""
    from ..plot import contact_figure, footprint_figure

    figures = {"skin.png": contact_figure(contact, bone=bone), "footprint.png": footprint_figure(contact)}
    return write_files(folder, {name: png_bytes(figure) for name, figure in figures.items()})


def _files(contact: Contact, inputs: Any, unreached: str | None) -> Iterator[tuple[str, bytes]]:
    """Names and contents of all files but the pictures."""
    yield "deformed.ply", _deformed_ply(contact)
    added = {"given_vertex_count": np.array([contact.given_vertex_count]), "parents": contact.parents}
    skin = contact.deformed
    yield "deformed.vtp", vtp_bytes(skin.vertices, skin.faces, vertex_data(contact), added)
    yield "contact.npz", _archive(contact)
    product = contact.obstacle.triangles()
    note = {"file": "product.ply"} if product else {"note": _NO_TRIANGLES}
    record = contact_record(contact, unreached=unreached)
    record["product"] |= note
    record["inputs"] = inputs
    if product:
        yield "product.ply", _plain_ply(*product, "m")
    if contact.obstacle.material is not None and contact.deformed_obstacle is not None:
        moved = contact.deformed_obstacle
        yield "deformed_product.ply", _plain_ply(moved.vertices, moved.faces, "m")
    # Last, so that a folder that has it has them all.
    yield "contact.json", json_bytes(record)


def _deformed_ply(contact: Contact) -> bytes:
    columns = _coordinates(contact.deformed.vertices) | {"pressure": contact.pressure}
    columns |= {f"displacement_{axis}": contact.displacement[:, at] for at, axis in enumerate("xyz")}
    comments = ["skin after contact, written by quasirigid", "units: x y z m, pressure Pa, displacement m"]
    return ply_bytes(comments, columns, contact.deformed.faces)


def _archive(contact: Contact) -> bytes:
    per_vertex = ("pressure", "node_force", "force_vectors", "gap", "displacement", "obstacle_displacement")
    other = ("candidates", "active", "force", "moment", "center_of_pressure", "given_vertex_count", "parents")
    arrays: dict[str, Any] = {name: getattr(contact, name) for name in (*per_vertex, *other)}
    arrays |= {name: getattr(contact.deformed, name) for name in ("vertices", "faces", "skin_mask")}
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


def write_mesh(vertices: ArrayLike, faces: ArrayLike, path: str | PathLike[str], *, unit: LengthUnit) -> None:
    """Write a plain mesh as binary PLY (float64) or STL (float32), by the ending of `path`.

    Parameters
    ----------
    vertices : (n, 3) array_like
        Positions (m).
    faces : (m, 3) array_like of int
        Triangles.
    path : path
        Ends in .ply or .stl; written whole or not at all.
    unit : {"m", "cm", "mm", "inch"}
        Unit of the coordinates in the file.

    Raises
    ------
    MeshFileError
        If a coordinate is no finite number, a face names a missing vertex, one of the arrays has another
        shape, the path ends in something else, or the unit is not known. Of STL also where float32 would turn
        or stretch an edge by more than 1 %, as far from the origin.
    """
    scale = metres_in(unit, MeshFileError)
    points, corners = _checked(vertices, faces, str(path))
    points /= scale
    match as_path("path", path).suffix.lower():
        case ".ply":
            content = _plain_ply(points, corners, unit)
        case ".stl":
            check_float32(points, corners, str(path), "write .ply, or move the mesh to the origin first")
            content = stl_bytes(points, corners, unit)
        case ending:
            raise MeshFileError(f"{path}: the ending is '{ending}', expected .ply or .stl")
    with atomic_write(path) as file:
        file.write(content)


def _checked(vertices: Any, faces: Any, name: str) -> tuple[Floats, Indices]:
    """Return the arrays of a mesh, copied; a MeshFileError of what could not be read again."""
    points = reals_or_empty(vertices)
    if points.ndim != 2 or points.shape[1] != 3:
        raise MeshFileError(
            f"vertices is {short(vertices)}, expected numbers (n, 3): write_mesh(vertices, faces, path, ...)"
        )
    try:
        corners = triangle_rows(faces)
    except (TypeError, ValueError) as error:
        raise MeshFileError(f"{name}: {error}") from None
    check_values(points, corners, name)
    return points, corners


def _plain_ply(points: Any, faces: Any, unit: LengthUnit) -> bytes:
    return ply_bytes([f"units: x y z {unit}"], _coordinates(points), faces)


def _coordinates(vertices: Any) -> dict[str, Any]:
    return {axis: vertices[:, at] for at, axis in enumerate("xyz")}
