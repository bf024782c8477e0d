"""What a run of `accuracy` or `stress` gave."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from .. import _core
from .._extras import import_extra
from .._frozen import Frozen
from .._progress import print_progress, reporter
from ..errors import MissingExtraError
from ..io.atomic import json_bytes, png_bytes, write_files
from ..io.record import as_plain
from .extremes.page import stress_page, stress_summary
from .ladder.page import accuracy_page, accuracy_summary

__all__ = ["Row", "Table", "TableProgress", "table_reporter"]

Row = dict[str, Any]
TableProgress = Callable[[str, int, int], object]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Table(Frozen):
    """Rows that were measured, each with the bound that it was held to.

    Attributes
    ----------
    name : str
        "accuracy" or "stress".
    """

    name: str
    _rows: tuple[Row, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """Return every row as a dict in SI (m, N, Pa, s; errors relative); ``row["ok"]`` is its verdict."""
        return tuple(dict(row) for row in self._rows)

    @property
    def ok(self) -> bool:
        """Return whether no row is off."""
        return all(row["ok"] for row in self._rows)

    def record(self) -> Row:
        """Return the table as it is written to JSON: its name, the version, the verdict and all rows."""
        return {
            "table": self.name,
            "version": _core.__version__,
            "ok": self.ok,
            "rows": as_plain(self._rows),
        }

    def to_dataframe(self) -> Any:
        """Return a pandas DataFrame with one row a case.

        Raises
        ------
        MissingExtraError
            If pandas is not installed.
        """
        return import_extra("pandas", "data frames", "pandas").DataFrame(list(self._rows))

    def save(self, folder: str | PathLike[str]) -> tuple[Path, ...]:
        """Write the table into a folder, which is made where it is missing.

        ``<name>.json`` has all rows in SI, ``<name>.md`` the page for people, ``accuracy.png`` error against
        time; without matplotlib (the extra `plot`) there is no picture.

        Parameters
        ----------
        folder : path
            Files of the same names are replaced, each of them whole; others stay.

        Returns
        -------
        tuple of Path
            The files.

        Raises
        ------
        OSError
            If the folder cannot be written to.
        """
        contents = {f"{self.name}.json": json_bytes(self.record())}
        if self.name == "accuracy":
            picture = self._picture()
            if picture is not None:
                contents["accuracy.png"] = picture
            page = accuracy_page(self._rows, has_picture=picture is not None)
        else:
            page = stress_page(self._rows)
        contents[f"{self.name}.md"] = page.encode()
        return write_files(folder, contents)

    def _picture(self) -> bytes | None:
        """Return the picture of error against time as PNG; None without matplotlib."""
        from .ladder.picture import accuracy_figure

        try:
            return png_bytes(accuracy_figure(self._rows))
        except MissingExtraError:
            return None

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self._rows)

    def __str__(self) -> str:
        """Return the rows as a table of text, the ones that are off named last."""
        summary = accuracy_summary if self.name == "accuracy" else stress_summary
        return summary(self._rows)

    def __repr__(self) -> str:
        """Return the counts on one line."""
        off = sum(not row["ok"] for row in self._rows)
        return f"Table({self.name}: {len(self._rows)} rows, {off or 'none'} off)"


def table_reporter(progress: TableProgress | bool | None) -> TableProgress:
    """Return the function to call after each case: the caller's, one that prints for True, or none."""
    return reporter(progress, _print_case) or (lambda name, done, total: None)


def _print_case(name: str, done: int, total: int) -> None:
    print_progress(f"{done} of {total}: {name}"[:100], is_last=done == total)
