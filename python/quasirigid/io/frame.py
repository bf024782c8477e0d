"""A contact as an object of pandas, pyvista or trimesh; each library is imported where it is used."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._extras import import_extra
from .record import PATCH_UNITS

if TYPE_CHECKING:
    from ..contact.result import Contact
    from ..contact.swept import Sweep
    from ..hand import Grasp

__all__ = [
    "contact_dataframe",
    "contact_pyvista",
    "contact_trimesh",
    "grasp_dataframe",
    "sweep_columns",
    "sweep_dataframe",
    "vertex_data",
]

_UNITS = {"pressure": "Pa", "node_force": "N", "force": "N", "gap": "m", "displacement": "m"}
_SWEEP_UNITS = {
    "depth": "m",
    "normal_force": "N",
    "force": "N",
    "moment": "N m",
    "contact_area": "m^2",
    "max_pressure": "Pa",
    "force_error": "",
    "area_error": "",
    "max_pressure_error": "",
    "seconds": "s",
}


def vertex_data(contact: Contact) -> dict[str, NDArray[Any]]:
    """Return what a contact holds at each vertex.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    dict of str to array
        `pressure` (n,) Pa, `node_force` (n,) N, `force` (n, 3) N, `gap` (n,) m (nan where it was not
        measured), `displacement` (n, 3) m, `candidate` and `active` (n,) uint8.
    """
    flags = {}
    for name, chosen in (("candidate", contact.candidates), ("active", contact.active)):
        flags[name] = np.zeros(len(contact.pressure), dtype=np.uint8)
        flags[name][chosen] = 1
    return {
        "pressure": contact.pressure,
        "node_force": contact.node_force,
        "force": contact.force_vectors,
        # Infinite beyond the search distance, which no color bar can show.
        "gap": np.where(np.isfinite(contact.gap), contact.gap, np.nan),
        "displacement": contact.displacement,
        **flags,
    }


def contact_dataframe(contact: Contact) -> Any:
    """Return a contact as a table with one row a vertex.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    pandas.DataFrame
        In SI, the unit in each column's name: the deformed position ``x (m)``, ``y (m)``, ``z (m)``, then
        what `vertex_data` returns, vectors as ``force_x (N)`` and so on, flags as booleans. The index counts
        vertices.

    Raises
    ------
    MissingExtraError
        If pandas is not installed.
    """
    pandas = import_extra("pandas", "data frames", "pandas")
    columns: dict[str, Any] = {
        f"{axis} (m)": contact.deformed.vertices[:, at] for at, axis in enumerate("xyz")
    }
    for name, values in vertex_data(contact).items():
        unit = _UNITS.get(name, "")
        columns |= _named(name, unit, values) if unit else {name: values.astype(bool)}
    return pandas.DataFrame(columns).rename_axis(index="vertex")


def _named(name: str, unit: str, values: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Return values by their name and unit, vectors as a column a component."""
    in_unit = f" ({unit})" if unit else ""
    if values.ndim == 1:
        return {f"{name}{in_unit}": values}
    return {f"{name}_{axis}{in_unit}": values[:, at] for at, axis in enumerate("xyz")}


def sweep_columns(sweep: Sweep) -> dict[str, Any]:
    """Return the columns of a sweep, one row a step.

    Parameters
    ----------
    sweep : Sweep
        The sweep.

    Returns
    -------
    dict of str to array
        In SI, the unit in each column's name, vectors as ``force_x (N)`` and so on; of forces
        ``asked_force (N)`` first; ``status`` and ``message`` last.
    """
    # A depth that was asked for stands in the column of depths, whatever became of it.
    columns: dict[str, Any] = {"asked_force (N)": sweep.asked} if sweep._question.goal == "force" else {}
    for name, unit in _SWEEP_UNITS.items():
        columns |= _named(name, unit, getattr(sweep, name))
    return columns | {"status": list(sweep.status), "message": list(sweep.messages)}


def sweep_dataframe(sweep: Sweep) -> Any:
    """Return a sweep as a table with one row a step.

    Parameters
    ----------
    sweep : Sweep
        The sweep.

    Returns
    -------
    pandas.DataFrame
        The columns of `sweep_columns`; the index counts steps.

    Raises
    ------
    MissingExtraError
        If pandas is not installed.
    """
    pandas = import_extra("pandas", "data frames", "pandas")
    return pandas.DataFrame(sweep_columns(sweep)).rename_axis(index="step")


def grasp_dataframe(grasp: Grasp) -> Any:
    """Return what a grasp holds as a table with one row for each digit and the palm.

    Parameters
    ----------
    grasp : Grasp
        The grasp.

    Returns
    -------
    pandas.DataFrame
        `closed` (share of the way, nan of the palm), then the figures of each part, vectors as a column a
        component, with their units; `missed` says why a digit does not hold what was asked. The index names
        the digits.

    Raises
    ------
    MissingExtraError
        If pandas is not installed.
    """
    pandas = import_extra("pandas", "data frames", "pandas")
    parts = dict(grasp.digits) | {"palm": grasp.palm}
    columns: dict[str, Any] = {"closed": [grasp.shares.get(name, np.nan) for name in parts]}
    for name, unit in PATCH_UNITS.items():
        values = np.array([getattr(part, name) for part in parts.values()])
        columns |= _named(name, unit, values)
    columns["missed"] = [grasp.missed.get(name, "") for name in parts]
    return pandas.DataFrame(columns, index=pandas.Index(parts, name="digit"))


def contact_pyvista(contact: Contact) -> Any:
    """Return the deformed skin as a mesh of pyvista.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    pyvista.PolyData
        Positions in m, with what `vertex_data` returns as point data; `pressure` is the active one.

    Raises
    ------
    MissingExtraError
        If pyvista is not installed.
    """
    pyvista = import_extra("pyvista", "meshes of pyvista", "pyvista")
    faces = contact.deformed.faces
    mesh = pyvista.PolyData(np.array(contact.deformed.vertices), np.insert(faces, 0, 3, axis=1).ravel())
    for name, values in vertex_data(contact).items():
        mesh.point_data[name] = values
    mesh.set_active_scalars("pressure")
    return mesh


def contact_trimesh(contact: Contact) -> Any:
    """Return the deformed skin as a mesh of trimesh.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    trimesh.Trimesh
        Positions in m, vertices and faces in our order, with what `vertex_data` returns in
        `vertex_attributes`.

    Raises
    ------
    MissingExtraError
        If trimesh is not installed.
    """
    trimesh = import_extra("trimesh", "meshes of trimesh", "trimesh")
    return trimesh.Trimesh(
        vertices=contact.deformed.vertices,
        faces=contact.deformed.faces,
        vertex_attributes=vertex_data(contact),
        process=False,
    )
