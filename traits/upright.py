"""The axes of an upright plant, whatever the up axis of its clip."""

import numpy as np
from numpy.typing import NDArray


def upright_axes(up: str) -> NDArray[np.float64]:
    """(3, 3) right-handed axes in rows: two horizontal unit vectors, and `up` ("x" to "-z")."""
    index, sign = "xyz".index(up[-1]), -1.0 if up.startswith("-") else 1.0
    unit = np.eye(3)
    return np.array([unit[(index + 1) % 3], sign * unit[(index + 2) % 3], sign * unit[index]])
