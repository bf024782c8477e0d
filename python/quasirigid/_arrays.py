"""Types of numpy arrays."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["Floats", "Indices", "Mask"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]
