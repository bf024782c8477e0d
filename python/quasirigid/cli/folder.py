"""The folder that results go to."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["OutFolder", "check_folder"]

OutFolder = Annotated[
    Path | None, typer.Option(help="Folder for the results; without it nothing is written.")
]


def check_folder(out: Path | None) -> None:
    """Refuse a file in the place of the folder, before anything is computed."""
    if out is not None and out.exists() and not out.is_dir():
        raise NotADirectoryError(f"--out: {out} is a file, expected a folder")
