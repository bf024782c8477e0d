"""The table of `stress` as a page and as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..._text import aligned
from ..text import as_time, markdown

__all__ = ["stress_page", "stress_summary"]

Row = Mapping[str, Any]
_HEAD = ("group", "case", "expected", "found", "limit", "time", "")
_PAGE = """\
# Extreme cases

Each case expects the scaled answer on one mesh, to the larger of 1e-9 and 100 times the rounding of the
coordinates over the depth (over the shortest edge where the pressures hang on that), or an ending that is
named. `quasirigid stress --out FOLDER` (`qr.stress`) writes this page. {verdict}

{table}
"""


def stress_page(rows: Sequence[Row]) -> str:
    """Return the page in Markdown."""
    return _PAGE.format(verdict=_verdict(rows), table=markdown(_HEAD, [_line(row) for row in rows]))


def stress_summary(rows: Sequence[Row]) -> str:
    """Return the lines for a terminal."""
    lines = [[_short(cell) for cell in _line(row)] for row in rows]
    return "\n".join([*aligned(list(zip(_HEAD, *lines, strict=True)), left=True), _verdict(rows)])


def _verdict(rows: Sequence[Row]) -> str:
    off = [row for row in rows if not row["ok"]]
    seconds = as_time(sum(row["seconds"] for row in rows))
    if not off:
        return f"All {len(rows)} cases gave what they should, in {seconds}."
    names = "; ".join(f"{row['group']}: {row['case']}" for row in off)
    return f"{len(off)} of {len(rows)} cases are off, in {seconds}: {names}."


def _line(row: Row) -> list[str]:
    limit = "-" if row["limit"] is None else f"{row['limit']:.1e}"
    state = "ok" if row["ok"] else f"OFF {row['note']}".strip()
    return [row["group"], row["case"], row["expected"], row["found"], limit, as_time(row["seconds"]), state]


def _short(cell: str) -> str:
    return cell if len(cell) <= 60 else cell[:57] + "..."
