"""Patches of a contact, and what named parts of the skin carry of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import as_mask, as_vertex_labels, kind_of
from .._from_core import from_core
from .._frozen import Frozen

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .. import _core
    from ..errors import QuasirigidError

__all__ = ["Part", "Patch", "part_of", "parts_by_label", "patches_of"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Patch(Frozen):
    """A connected part of the contact.

    The errors of `Contact.accuracy` are shares of the whole: a small patch beside a large one may be off by
    more of its own.

    Attributes
    ----------
    vertices : (k,) int64
        Vertices with f > 0, ascending.
    force : (3,) float64
        Force on the skin (N).
    moment : (3,) float64
        Moment on the skin about the origin, at deformed positions (N m).
    center_of_pressure : (3,) float64
        Mean of the deformed positions weighted by node force (m).
    contact_area : float
        Its contact area (m²), as in `Contact`.
    max_pressure : float
        Its largest pressure (Pa), as in `Contact`.
    mean_pressure : float
        Its largest mean pressure over 1 cm² (Pa), as `Contact.mean_pressure` of its vertices alone.
    """

    vertices: NDArray[np.int64]
    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    center_of_pressure: NDArray[np.float64]
    contact_area: float
    max_pressure: float
    mean_pressure: float

    def __repr__(self) -> str:
        """Return vertices, force, area and peak on one line."""
        return f"Patch({len(self.vertices)} vertices, {figures_text(self)})"


@dataclass(frozen=True, kw_only=True, eq=False)
class Part(Frozen):
    """What a part of the skin carries of a contact; made by `Contact.part` and `Contact.by_label`.

    The errors of `Contact.accuracy` are shares of the whole: a part that carries little may be off by more of
    its own.

    Attributes
    ----------
    force : (3,) float64
        Force on the skin (N).
    moment : (3,) float64
        Moment on the skin about the origin, at deformed positions (N m).
    center_of_pressure : (3,) float64
        Mean of the deformed positions weighted by node force (m); nan without force.
    contact_area : float
        Its share of the contact area (m²).
    max_pressure : float
        The largest pressure that one of its vertices stands for (Pa), as in `Contact`.
    mean_pressure : float
        Its largest mean pressure over 1 cm² (Pa), as `Contact.mean_pressure` of its vertices alone.
    patches : tuple of Patch
        The patches of the contact that reach it, each as far as it lies on this part.
    """

    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    center_of_pressure: NDArray[np.float64]
    contact_area: float
    max_pressure: float
    mean_pressure: float
    patches: tuple[Patch, ...]

    def __repr__(self) -> str:
        """Return force, area, peak and patches on one line."""
        return f"Part({figures_text(self)}, {len(self.patches)} patch{'es' * (len(self.patches) != 1)})"


def figures_text(part: Any) -> str:
    """Return force, area and peak of a contact, a patch or a part."""
    force = float((part.force @ part.force) ** 0.5)
    return f"force {force:.4g} N, area {part.contact_area:.4g} m², peak {part.max_pressure:.4g} Pa"


def patches_of(core: list[tuple[NDArray[np.int64], _core.Resultant]]) -> tuple[Patch, ...]:
    """Return the facade's patches."""
    return tuple(from_core(Patch, figures, vertices=vertices) for vertices, figures in core)


def part_of(
    loaded: _core.LoadedVertices, mask: ArrayLike, counts: tuple[int, int], refusal: type[QuasirigidError]
) -> Part:
    """Return what the vertices of a mask carry.

    Parameters
    ----------
    loaded : _core.LoadedVertices
        The vertices under force.
    mask : (n,) array_like of bool
        Which vertices, of the given mesh or of the one that was solved.
    counts : (int, int)
        Vertices of these.
    refusal : exception class
        What is raised where the mask has another length.
    """
    if isinstance(mask, str):
        remedy = f"by_label(labels)[{mask!r}] has the part of a label"
        raise TypeError(f"`mask` is {mask!r}, expected an array of booleans: {remedy}")
    figures, patches = loaded.part(as_mask("mask", mask, counts, refusal))
    return from_core(Part, figures, patches=patches_of(patches))


def parts_by_label(
    loaded: _core.LoadedVertices, labels: ArrayLike, counts: tuple[int, int], refusal: type[QuasirigidError]
) -> dict[int | str, Part]:
    """Return what the vertices of each label carry, as `part_of`."""
    if isinstance(labels, Mapping):
        found = f"`labels` is {kind_of(labels)}, expected an array with a label for each vertex"
        raise TypeError(f"{found}: part(mask) takes a mask")
    entries = as_vertex_labels("labels", labels, counts, refusal)
    names, group = np.unique(entries, return_inverse=True)
    return {name.item(): part_of(loaded, group == at, counts, refusal) for at, name in enumerate(names)}
