"""A body that a file keeps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

import quasirigid as qr

from .quantities import QuantityError

__all__ = ["kept_body"]


def kept_body(
    file: Path, skin: qr.Skin, surface: qr.Surface, nodes: NDArray[np.int64], *, progress: bool
) -> qr.PreparedSkin:
    """Return a body prepared for `nodes` at least, from the file where that serves; else it is written anew.

    Parameters
    ----------
    file : path
        Keeps the response.
    skin : Skin
        The body.
    surface : Surface
        The skin's mesh.
    nodes : (k,) int64
        Vertices that may touch.
    progress : bool
        Report how far the preparation is.

    Raises
    ------
    QuantityError
        If the file holds another body.
    """
    if file.exists():
        known = qr.load_prepared(file)
        if other := _difference(known.skin, skin):
            raise QuantityError(
                f"--prepared: {file} holds a body of {other}: name another file, or remove it"
            )
        known._response.check_surface(surface)
        if np.isin(nodes, known.nodes).all():
            return known
        nodes = np.union1d(nodes, known.nodes)
    made = skin.prepared(surface, nodes, progress=progress)
    made.save(file)
    return made


def _difference(known: qr.Skin, asked: qr.Skin) -> str:
    """Return what a kept body has that the one asked for has not; empty where they are one."""
    if known.shear_modulus != asked.shear_modulus:
        return f"shear modulus {known.shear_modulus:g} Pa, not {asked.shear_modulus:g}"
    if known.poisson_ratio != asked.poisson_ratio:
        return f"Poisson's ratio {known.poisson_ratio:g}, not {asked.poisson_ratio:g}"
    one, other = known.response, asked.response
    if not isinstance(one, qr.Body) or not isinstance(other, qr.Body):
        return "another response"
    for part in ("vertices", "faces"):
        if not _are_equal(*(body.bone and getattr(body.bone, part) for body in (one, other))):
            return "another bone"
    if one.coarse_edge_length != other.coarse_edge_length:
        return f"coarse edge length {one.coarse_edge_length} m, not {other.coarse_edge_length}"
    forms = [body.discretization or qr.Discretization.COLLOCATION for body in (one, other)]
    if forms[0] != forms[1]:
        return f"discretization {forms[0]}, not {forms[1]}"
    return "" if _are_equal(one.fixed, other.fixed) else "other fixed vertices"


def _are_equal(one: ArrayLike | None, other: ArrayLike | None) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(np.asarray(one), np.asarray(other))
