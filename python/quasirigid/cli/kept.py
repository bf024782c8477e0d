"""A body that a file keeps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import quasirigid as qr

from .folder import check_file
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
    OSError
        If its folder takes no file, before the body is prepared.
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
    check_file(file, "--prepared")
    made = skin.prepared(surface, nodes, progress=progress)
    made.save(file)
    return made


def _difference(known: qr.Skin, asked: qr.Skin) -> str:
    """Return what a kept body has that the one asked for has not; empty where they are one."""
    others = asked._content
    for name, value in known._content.items():
        other = others[name]
        if not np.array_equal(value, other):
            return f"another {name}" if np.ndim(value) + np.ndim(other) else f"{name} {value}, not {other}"
    return ""
