"""The folder that results go to."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["OutFolder", "check_file", "check_folder"]

OutFolder = Annotated[
    Path | None, typer.Option(help="Folder for the results; without it nothing is written.")
]


def check_folder(out: Path | None) -> None:
    """Refuse a file in the place of the folder or above it, before anything is computed."""
    if out is None:
        return
    there = next(path for path in (out, *out.parents) if path.exists())
    if not there.is_dir():
        raise NotADirectoryError(f"--out: {there} is a file, expected a folder")


def check_file(file: Path | None, option: str) -> None:
    """Refuse a folder in the place of the file, and one whose folder is missing, likewise."""
    if file is None:
        return
    if file.is_dir():
        raise IsADirectoryError(f"{option}: {file} is a folder, expected a file")
    if not file.parent.is_dir():
        raise FileNotFoundError(f"{option}: there is no folder {file.parent}")
