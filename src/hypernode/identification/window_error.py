"""How far what an engine of image correlation sees is from the mean over its window that stands for it.

The texture of a subset decides what is seen where its deformation is not uniform. Against the mean over subsets, pyvale
and al-dic are off by a quarter of what that mean changes, at every stretch and in both components, by as much in
every load step, and alike at neighbours whose subsets overlap (docs/decisions/0060).
"""

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.measurement import correlation_window, window_uncertainty
from hypernode.fem.mesh import Mesh
from hypernode.identification.camera import window_average


def window_errors(
    measurement: xr.Dataset, grid: Mesh, u: Float[np.ndarray, "step node 2"], shared: bool
) -> tuple[np.ndarray, np.ndarray]:
    """(standard deviation of what is seen at every node about the mean over its window, level that it weighs as).

    What that mean changes is read from the displacements themselves, as the root mean square over the window: a point
    beside an interface tells nothing of how uncertain it is. The level is that of independent errors which weigh as
    much as these, which steps share wholly, and subsets by the square of the share in which they overlap.

    Args:
        u: measured displacement, known everywhere.
        shared: whether errors count as shared.
    """
    (window, kernel), share = correlation_window(measurement), window_uncertainty(measurement)
    if window == 0.0 or share == 0.0:
        return np.zeros_like(u), np.zeros_like(u)
    mean, flat = window_average(grid, window, kernel), u.reshape(len(u), -1).T
    # The weights of a quadratic fit are negative in places.
    changed = np.sqrt(np.maximum(mean @ (mean @ flat - flat) ** 2, 0.0))
    error = share * changed.T.reshape(u.shape)
    return error, error * (_weight(grid, window, len(u)) if shared else 1.0)


def _weight(grid: Mesh, window: float, steps: int) -> float:
    """Level of independent errors over that of errors which so many steps and overlapping subsets share."""
    squared = float(steps)
    for line in grid.lines:
        apart = np.arange(1, len(line)) * np.ptp(line) / (len(line) - 1)
        squared *= 1.0 + 2.0 * (np.maximum(1.0 - apart / window, 0.0) ** 2).sum()
    return float(np.sqrt(squared))
