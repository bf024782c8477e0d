"""Files that are written whole or not at all, and what stands in them."""

from __future__ import annotations

import errno
import io
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from .._check import as_path

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["atomic_write", "json_bytes", "png_bytes", "write_files"]


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file for writing that takes its name once it is whole; on an error the old one stays.

    Raises
    ------
    OSError
        If its folder does not exist or cannot be written to, or a folder has its name.
    """
    target = as_path("path", path)
    # A link stays one, and what it leads to is replaced.
    place = Path(os.path.realpath(target))
    if not place.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "its folder does not exist", str(target))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a folder, expected a file", str(target))
    draft = place.with_name(f".{place.name}.{os.urandom(4).hex()}")
    try:
        file = draft.open("xb")
    except OSError as error:
        error.filename = str(target)
        raise
    try:
        with file:
            yield file
        draft.replace(place)
    finally:
        draft.unlink(missing_ok=True)


def write_files(
    folder: str | os.PathLike[str], contents: Mapping[str, bytes], *, instead_of: Iterable[str] = ()
) -> tuple[Path, ...]:
    """Write files of these names into a folder, each of them whole; return their paths.

    Parameters
    ----------
    folder : path
        Made where it is missing.
    contents : mapping of str to bytes
        What stands in each file, by its name.
    instead_of : iterable of str
        Names of files that are removed first.

    Raises
    ------
    OSError
        If the folder is a file or cannot be written to.
    """
    folder = as_path("folder", folder)
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(f"{folder} is a file, expected a folder to write to")
    folder.mkdir(parents=True, exist_ok=True)
    for name in instead_of:
        (folder / name).unlink(missing_ok=True)
    for name, content in contents.items():
        with atomic_write(folder / name) as file:
            file.write(content)
    return tuple(folder / name for name in contents)


def json_bytes(record: Mapping[str, Any]) -> bytes:
    """Return a record of plain values as indented JSON, a line end after it."""
    return (json.dumps(record, indent=2, allow_nan=False) + "\n").encode()


def png_bytes(figure: Figure) -> bytes:
    """Return a matplotlib figure as a PNG file."""
    file = io.BytesIO()
    figure.savefig(file, format="png")
    return file.getvalue()
