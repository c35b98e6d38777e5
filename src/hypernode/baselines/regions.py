"""Regions of a sheet, found without its truth."""

import numpy as np
from jaxtyping import Float, Int

#: Iterations of the two means, of which a handful suffices.
ITERATIONS = 50


def two_regions(moduli: Float[np.ndarray, " cell"]) -> Int[np.ndarray, " cell"]:
    """0 in the softer and 1 in the stiffer cells: two means of the logarithm, from its quartiles on."""
    level = np.log(moduli)
    low, high = np.quantile(level, [0.25, 0.75])
    for _ in range(ITERATIONS):
        stiff = level > 0.5 * (low + high)
        if stiff.all() or not stiff.any():
            return np.zeros(len(level), int)
        low, high = level[~stiff].mean(), level[stiff].mean()
    return stiff.astype(int)
