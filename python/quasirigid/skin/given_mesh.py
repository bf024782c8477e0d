"""From the refined mesh of a contact back to the given one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from ..contact.result import Contact

__all__ = ["forces_on_given_mesh"]


def forces_on_given_mesh(load: Contact | ArrayLike) -> ArrayLike:
    """Return the forces (N) at the given vertices, those of the added ones shared by the two beside."""
    if not hasattr(load, "force_vectors"):
        return load
    contact: Any = load
    forces: NDArray[np.float64] = contact.force_vectors.copy()
    for row in reversed(range(len(contact.parents))):
        forces[contact.parents[row]] += 0.5 * forces[contact.given_vertex_count + row]
    return forces[: contact.given_vertex_count]
