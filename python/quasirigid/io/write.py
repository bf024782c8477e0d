"""Results out: deformed skin as PLY and VTP, arrays as NPZ, scalars with their units as JSON.

Arrays are in SI, as everywhere in the package. Files are written whole or not at all.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import MeshFileError
from .atomic import whole_folder, write_whole, write_with
from .ply import ply_bytes
from .stl import stl_bytes
from .summary import contact_summary
from .vtp import vtp_bytes

if TYPE_CHECKING:
    from ..contact.result import Contact
    from ..surface import Surface

__all__ = ["write_contact", "write_json", "write_mesh", "write_npz", "write_ply", "write_vtp"]


def write_contact(
    contact: Contact,
    folder: str | os.PathLike[str],
    *,
    inputs: Mapping[str, Any] | None = None,
    pictures: bool = True,
    bone: Surface | None = None,
) -> list[Path]:
    """Write everything about a contact into a folder.

    Parameters
    ----------
    contact : Contact
        What to write.
    folder : path
        Made where it is missing. Everything is written beside it first and moved in at the end, so that a
        failure leaves it as it was; files of the same names are replaced, others stay.
    inputs : mapping, optional
        What the contact was computed from, for `contact.json`.
    pictures : bool
        Draw `skin.png` and `footprint.png` too (extra `plot`).
    bone : Surface, optional
        Bones to draw in the cut.

    Returns
    -------
    list of Path
        The files.
    """
    folder = Path(folder)
    with whole_folder(folder) as draft:
        write_ply(contact, draft / "deformed.ply")
        write_vtp(contact, draft / "deformed.vtp")
        write_npz(contact, draft / "contact.npz")
        write_json(contact, draft / "contact.json", inputs=inputs)
        if pictures:
            from .. import plot

            plot.before_and_after(contact, bone=bone).savefig(draft / "skin.png")
            plot.footprint(contact).savefig(draft / "footprint.png")
        names = sorted(path.name for path in draft.iterdir())
    return [folder / name for name in names]


def write_ply(contact: Contact, path: str | os.PathLike[str]) -> None:
    """Write the deformed skin as binary PLY, with pressure (Pa) and displacement (m) at each vertex.

    Parameters
    ----------
    contact : Contact
        What to write.
    path : path
        The file.
    """
    vertices, faces = _mesh(contact)
    displacement = np.asarray(contact.displacement, dtype=np.float64)
    columns = {name: vertices[:, axis] for axis, name in enumerate("xyz")}
    columns["pressure"] = np.asarray(contact.pressure, dtype=np.float64)
    columns |= {f"displacement_{name}": displacement[:, axis] for axis, name in enumerate("xyz")}
    comments = ["skin after contact, written by quasirigid", "units: x y z m, pressure Pa, displacement m"]
    write_whole(path, ply_bytes(comments, columns, faces))


def write_vtp(contact: Contact, path: str | os.PathLike[str]) -> None:
    """Write the deformed skin as VTK XML PolyData (.vtp), which ParaView opens.

    Parameters
    ----------
    contact : Contact
        What to write.
    path : path
        The file. Point data: `pressure` (Pa), `node_force` (N), `gap` (m), `displacement` (m), and the flags
        `candidate` and `active`.
    """
    vertices, faces = _mesh(contact)
    flags = {}
    for name, chosen in (("candidate", contact.candidates), ("active", contact.active)):
        flags[name] = np.zeros(len(vertices), dtype=np.uint8)
        flags[name][np.asarray(chosen, dtype=np.int64)] = 1
    # Beyond the search distance the gap is infinite, which ParaView cannot colour.
    gap = np.asarray(contact.gap, dtype=np.float64)
    gap = np.where(np.isfinite(gap), gap, np.nan)
    data: dict[str, NDArray[Any]] = {
        "pressure": np.asarray(contact.pressure, dtype=np.float64),
        "node_force": np.asarray(contact.node_force, dtype=np.float64),
        "gap": gap,
        "displacement": np.asarray(contact.displacement, dtype=np.float64),
        **flags,
    }
    write_whole(path, vtp_bytes(vertices, faces, data))


def write_npz(contact: Contact, path: str | os.PathLike[str]) -> None:
    """Write the arrays of a contact, in SI units, as a NumPy archive.

    Parameters
    ----------
    contact : Contact
        What to write.
    path : path
        The file. Names as on `Contact`, and `vertices`, `faces`, `skin_mask` of the deformed skin.
    """
    vertices, faces = _mesh(contact)
    names = ["pressure", "node_force", "gap", "displacement", "force", "moment", "center_of_pressure"]
    arrays: dict[str, Any] = {
        name: np.asarray(getattr(contact, name)) for name in [*names, "candidates", "active"]
    }
    mask = np.asarray(contact.deformed.skin_mask)

    def save(draft: Path) -> None:
        with draft.open("wb") as file:
            np.savez_compressed(file, vertices=vertices, faces=faces, skin_mask=mask, **arrays)

    write_with(path, save)


def write_json(
    contact: Contact, path: str | os.PathLike[str], *, inputs: Mapping[str, Any] | None = None
) -> None:
    """Write status, scalars with their units, accuracy, timings and what was left out.

    Parameters
    ----------
    contact : Contact
        What to write.
    path : path
        The file. Numbers that are not finite are written as null.
    inputs : mapping, optional
        Anything JSON can hold, kept under "inputs".
    """
    document = contact_summary(contact) | {"inputs": dict(inputs or {})}
    write_whole(path, (json.dumps(document, indent=2, allow_nan=False) + "\n").encode("utf-8"))


def write_mesh(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    path: str | os.PathLike[str],
    *,
    unit: Literal["m", "mm"],
) -> None:
    """Write a plain mesh as binary PLY (float64) or STL (float32), by the ending of `path`.

    Parameters
    ----------
    vertices : (n, 3) float64
        Positions (m).
    faces : (m, 3) int64
        Triangles.
    path : path
        Ends in .ply or .stl.
    unit : {"m", "mm"}
        Unit of the coordinates in the file.
    """
    points = np.asarray(vertices, dtype=np.float64) * {"m": 1.0, "mm": 1e3}[unit]
    corners = np.asarray(faces, dtype=np.int64)
    match Path(path).suffix.lower():
        case ".ply":
            comments = [f"units: x y z {unit}"]
            content = ply_bytes(comments, {name: points[:, axis] for axis, name in enumerate("xyz")}, corners)
        case ".stl":
            content = stl_bytes(points, corners, unit)
        case ending:
            raise MeshFileError(f"{path}: the ending is '{ending}', expected .ply or .stl")
    write_whole(path, content)


def _mesh(contact: Contact) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    return (
        np.asarray(contact.deformed.vertices, dtype=np.float64),
        np.asarray(contact.deformed.faces, dtype=np.int64),
    )
