"""Contacts on the flat cut face of a scan that no mask leaves out."""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from ..errors import CutWarning
from ..surface import skin_without_caps
from .warned import Warned

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .. import _core
    from ..surface import Surface

__all__ = ["WITHOUT_CAPS", "warned_of_caps"]

WITHOUT_CAPS = "surface.with_skin_mask(qr.skin_without_caps(surface))"
"""What leaves flat cut faces out of the contact."""

_SMALL_SHARE = 1e-3  # of the force, as where the core warns of cuts
_caps: WeakKeyDictionary[Surface, NDArray[np.bool_]] = WeakKeyDictionary()


def warned_of_caps(core: _core.Contact, surface: Surface) -> tuple[Warned, ...]:
    """Return the warning of force on flat cut faces; nothing where the skin has a mask."""
    if len(core.active) == 0 or not surface.skin_mask.all():
        return ()
    if surface not in _caps:
        _caps[surface] = ~skin_without_caps(surface)
    on_cap = np.zeros(len(core.gap), dtype=bool)
    on_cap[: core.given_vertex_count] = _caps[surface]
    if not on_cap.any() or _caps[surface].all():  # a block has no other skin
        return ()
    for vertex, (one, other) in enumerate(core.parents.tolist(), core.given_vertex_count):
        on_cap[vertex] = on_cap[one] and on_cap[other]
    force, total = core.node_force[on_cap].sum(), core.node_force.sum()
    if not force >= _SMALL_SHARE * total:
        return ()
    message = (
        f"{force:.3e} N ({100.0 * force / total:.2f} % of all) lie on a large flat face, as where a scan is "
        "cut and capped: the figures lack what lies beyond; where it is no skin, mask it out, as by "
        f"`{WITHOUT_CAPS}`"
    )
    return (Warned(CutWarning, message),)
