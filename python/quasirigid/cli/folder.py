"""Files that are read, and where results go: looked at before the work begins."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer

__all__ = ["Inputs", "OutFolder", "check_file", "check_folder", "check_inputs"]


def _folder(word: str) -> Path:
    # An empty one would be the folder at hand.
    if not word:
        raise typer.BadParameter("the word is empty, expected a folder")
    return Path(word)


OutFolder = Annotated[
    Path | None,
    typer.Option(
        parser=_folder,
        metavar="PATH",
        help="Folder for the results; without it nothing is written. Files of the same names are replaced.",
    ),
]

# Files that a command reads, by the names of their arguments; None where one is not asked for.
Inputs = Mapping[str, Path | None]


def check_inputs(inputs: Inputs) -> None:
    """Refuse files that are not there, and folders in their place."""
    for argument, file in inputs.items():
        if file is not None and not file.exists():
            raise FileNotFoundError(f"{argument}: there is no file {file}")
        if file is not None and file.is_dir():
            raise IsADirectoryError(f"{argument}: {file} is a folder, expected a file")


def check_folder(out: Path | None, names: Sequence[str] = (), inputs: Inputs | None = None) -> None:
    """Refuse a file in the place of the folder or above it, and results that would replace an input.

    Parameters
    ----------
    out : path, optional
        The folder.
    names : sequence of str
        Names of the files that are written into it.
    inputs : mapping of str to path, optional
        Files that are read.
    """
    if out is None:
        return
    there = next(path for path in (out, *out.parents) if path.exists())
    if not there.is_dir():
        raise NotADirectoryError(f"--out: {there} is a file, expected a folder")
    _check_writable(there, "--out")
    for name in names:
        _check_kept(out / name, "--out", "folder", inputs or {})


def check_file(
    file: Path | None, option: str, inputs: Inputs | None = None, *, may_be_read: bool = False
) -> None:
    """Refuse a folder in the place of the file, one whose folder is missing, and an input, likewise.

    Parameters
    ----------
    file : path, optional
        The file that is written.
    option : str
        Names it.
    inputs : mapping of str to path, optional
        Files that are read.
    may_be_read : bool
        Whether a file that is there may serve as it is: its folder need not be writable.
    """
    if file is None:
        return
    if file.is_dir():
        raise IsADirectoryError(f"{option}: {file} is a folder, expected a file")
    if not file.parent.is_dir():
        raise FileNotFoundError(f"{option}: there is no folder {file.parent}")
    if not (may_be_read and file.exists()):
        _check_writable(file.parent, option)
    _check_kept(file, option, "file", inputs or {})


def _check_writable(folder: Path, option: str) -> None:
    """Refuse a folder that takes no file."""
    try:
        # Permissions do not tell: root has them all, also where nothing can be made.
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        raise PermissionError(f"{option}: {folder} cannot be written to: name another folder") from None


def _check_kept(target: Path, option: str, kind: str, inputs: Inputs) -> None:
    """Refuse to replace a file that is read."""
    for argument, file in inputs.items():
        if file is not None and _are_same(target, file):
            raise FileExistsError(
                f"{option}: {target} is read as {argument} and would be replaced: name another {kind}"
            )


def _are_same(one: Path, other: Path) -> bool:
    # By what the system says where both are there: some tell no capitals apart.
    if one.exists() and other.exists():
        return one.samefile(other)
    return one.resolve() == other.resolve()
