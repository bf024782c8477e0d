"""Parts of a hand that cross one another."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["crossing_parts", "in_words"]

_NAMED = 3  # pairs that are told by name


def crossing_parts(pairs: NDArray[np.int64], labels: NDArray[np.str_]) -> tuple[tuple[str, str], ...]:
    """Return the pairs of labels whose faces (k, 2, 3) cross, those with the most crossings first."""
    names = labels[pairs]
    # A face belongs to the label of most of its corners, the first where all differ.
    own = np.where(names[..., 1] == names[..., 2], names[..., 1], names[..., 0])
    counts = Counter(tuple(sorted((str(one), str(other)))) for one, other in own)
    return tuple((one, other) for (one, other), _ in counts.most_common())


def in_words(pairs: tuple[tuple[str, str], ...]) -> str:
    """Return pairs of labels as words, such as "index-distal-palmar and thenar"."""
    words = [f"{one} and {other}" if one != other else f"{one} and itself" for one, other in pairs]
    rest = len(words) - _NAMED
    return ", ".join(words[:_NAMED]) + (f", and {rest} more" if rest > 0 else "")
