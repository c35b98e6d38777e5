"""Where positions lie along the lines of a grid."""

import numpy as np
from jaxtyping import Float, Int


def intervals(
    line: Float[np.ndarray, " line"], position: Float[np.ndarray, " point"]
) -> tuple[Int[np.ndarray, " point"], Float[np.ndarray, " point"]]:
    """(number of the interval of every position, the share of the way through it), the first or last one beyond ends.

    Args:
        line: increasing, two or more.
        position: any.
    """
    number = np.clip(np.searchsorted(line, position, side="right") - 1, 0, len(line) - 2)
    return number, (position - line[number]) / (line[number + 1] - line[number])
