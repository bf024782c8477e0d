"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["whole_folder", "write_whole", "write_with"]


def write_whole(path: str | os.PathLike[str], content: bytes) -> None:
    """Write the content of a file."""
    write_with(path, lambda draft: draft.write_bytes(content))


def write_with(path: str | os.PathLike[str], write: Callable[[Path], object]) -> None:
    """Write a file by a function that is given the place of its draft."""
    target = Path(path)
    draft = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        write(draft)
        draft.replace(target)
    finally:
        draft.unlink(missing_ok=True)


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """A folder to fill beside `folder`; moved to it when all went well, and thrown away when not."""
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(f"{folder} is a file, expected a folder to write to")
    folder.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    try:
        yield draft
        if folder.exists():
            for path in sorted(draft.iterdir()):
                path.replace(folder / path.name)
        else:
            draft.chmod(0o777 & ~_umask())
            draft.rename(folder)
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
