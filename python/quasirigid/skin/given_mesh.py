"""From the refined mesh of a contact back to the given one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import as_array, short
from ..errors import ResponseError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..contact.result import Contact

__all__ = ["forces_on_given_mesh"]


def forces_on_given_mesh(load: Contact | ArrayLike) -> ArrayLike:
    """Return the forces (N) at the given vertices, those of the added ones shared by the two beside.

    Raises
    ------
    ResponseError
        If forces of one's own are not finite; the core says what is wrong with what are none.
    """
    if not hasattr(load, "force_vectors"):
        _check_finite(load)
        return load
    contact: Any = load
    forces: NDArray[np.float64] = contact.force_vectors.copy()
    for row in reversed(range(len(contact.parents))):
        forces[contact.parents[row]] += 0.5 * forces[contact.given_vertex_count + row]
    return forces[: contact.given_vertex_count]


def _check_finite(forces: ArrayLike) -> None:
    rows = as_array("forces", forces)
    if rows.dtype.kind != "f" or rows.ndim != 2:
        return
    wrong = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if wrong.size > 0:
        first = short(rows[wrong[0]])
        raise ResponseError(f"forces[{wrong[0]}] is {first}, expected finite forces ({wrong.size} are not)")
