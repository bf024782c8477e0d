"""What nobody can change."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

import numpy as np


class Frozen:
    """Base of objects whose arrays and mappings are read-only, after a pickle too."""

    def __getstate__(self) -> dict[str, Any]:
        """Return the attributes; pickle knows no `MappingProxyType`."""
        return {
            name: dict(value) if isinstance(value, MappingProxyType) else value
            for name, value in vars(self).items()
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take the attributes, read-only again."""
        for name, value in state.items():
            vars(self)[name] = MappingProxyType(value) if isinstance(value, dict) else value
        self._freeze()

    def _freeze(self) -> None:
        """Make the arrays read-only."""
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
