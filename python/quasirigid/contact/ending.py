"""How a contact ended, and what it left out."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

__all__ = ["ContactStatus", "LeftOut"]


class ContactStatus(StrEnum):
    """How a contact ended; the last four are endings of its complementarity problem."""

    SOLVED = "solved"
    NO_CONTACT = "no_contact"
    RAY = "ray"
    PIVOT_LIMIT = "pivot_limit"
    BREAKDOWN = "breakdown"
    INTERRUPTED = "interrupted"


class LeftOut(NamedTuple):
    """One thing that the solve left out, and why.

    Attributes
    ----------
    what : str
        The thing, in a few words that stay the same.
    why : str
        The reason, with the figures of this contact.
    """

    what: str
    why: str
