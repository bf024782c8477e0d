"""Tables as text for a terminal and as a page in Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .extremes.page import stress_page, stress_summary
from .ladder.page import accuracy_page, accuracy_summary

__all__ = ["page_of", "summary_of"]

Rows = Sequence[Mapping[str, Any]]


def page_of(name: str, rows: Rows, *, has_picture: bool) -> str:
    """Return the page of a table, in Markdown."""
    return accuracy_page(rows, has_picture=has_picture) if name == "accuracy" else stress_page(rows)


def summary_of(name: str, rows: Rows) -> str:
    """Return the lines of a table for a terminal."""
    return accuracy_summary(rows) if name == "accuracy" else stress_summary(rows)
