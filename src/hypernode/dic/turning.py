"""Vectors that are turned in the plane of the sheet."""

import numpy as np
from jaxtyping import Float


def turned(vector: Float[np.ndarray, "*point axis"], angle: float) -> Float[np.ndarray, "*point axis"]:
    """Vectors turned counter-clockwise by an angle [rad]; a third component stays as it is."""
    c, s = np.cos(angle), np.sin(angle)
    result = vector.copy()
    result[..., 0] = c * vector[..., 0] - s * vector[..., 1]
    result[..., 1] = s * vector[..., 0] + c * vector[..., 1]
    return result
