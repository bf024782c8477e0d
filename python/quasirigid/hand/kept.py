"""Prepared bodies kept by content: in memory, and in a folder where asked."""

from __future__ import annotations

from collections import OrderedDict
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from ..errors import ResponseError
from ..skin import load_prepared

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike

    from ..skin import PreparedSkin, Skin
    from ..skin.progress import Progress
    from ..surface import Surface

__all__ = ["kept"]

_MOST_BYTES = 5e8  # of all bodies in memory: about three whole hands
_VERSION = b"4"  # another one where the same body is solved otherwise

_known: OrderedDict[str, tuple[PreparedSkin, int]] = OrderedDict()
_lock = Lock()


def kept(
    skin: Skin,
    surface: Surface,
    nodes: ArrayLike,
    folder: str | PathLike[str] | None = None,
    progress: Progress | None = None,
    num_threads: int | None = None,
) -> PreparedSkin:
    """Return a body prepared for a surface, from memory or the folder where it is there already.

    A file that the folder lacks is written, a damaged one anew; a body in memory reads none.
    """
    if folder is not None and not Path(folder).is_dir():
        raise NotADirectoryError(f"{folder} is no folder: make it first")
    key = _key(skin, surface, nodes)
    file = None if folder is None else Path(folder) / f"{key}.npz"
    with _lock:
        if key in _known:
            _known.move_to_end(key)
        prepared, _ = _known.get(key, (None, 0))
    if prepared is not None:
        if file is not None and not file.exists():
            prepared.save(file)
        return prepared
    if file is not None and file.exists():
        with suppress(ResponseError):
            prepared = load_prepared(file)
    if prepared is None:
        prepared = skin.prepared(surface, nodes, progress=progress, num_threads=num_threads)
        if file is not None:
            prepared.save(file)
    size = sum(part.nbytes for part in _core.skin_parts(prepared._response).values())
    with _lock:
        _known[key] = prepared, size
        while len(_known) > 1 and sum(size for _, size in _known.values()) > _MOST_BYTES:
            _known.popitem(last=False)
    return prepared


def _key(skin: Skin, surface: Surface, nodes: ArrayLike) -> str:
    """Return a name for all that a body depends on."""
    content = sha256(_VERSION)
    mesh = (surface.vertices, surface.faces, surface.skin_mask, nodes)
    for one in (*skin._content.values(), *mesh):
        array = np.ascontiguousarray(np.empty(0) if one is None else one)
        content.update(f"{one is None} {array.dtype} {array.shape}".encode())
        content.update(array.tobytes())
    return content.hexdigest()[:32]
