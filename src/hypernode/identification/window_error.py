"""Difference between the displacement of a correlation engine and the plain average over its window.

If the deformation of a subset is not uniform, its texture influences the result. The difference is a quarter of the
change that averaging makes, for pyvale and al-dic, at every stretch and in both components. It is the same in every
load step, and similar at neighbours with overlapping subsets (docs/decisions/0060).
"""

import numpy as np
import xarray as xr
from jaxtyping import Float
from scipy.optimize import minimize

from hypernode.data.measurement import correlation_window, window_sought, window_uncertainty
from hypernode.fem.mesh import Mesh
from hypernode.identification import priors, thresholds
from hypernode.identification.camera import window_average


def changed_by_window(
    grid: Mesh, u: Float[np.ndarray, "step node 2"], window: float, kernel: str
) -> Float[np.ndarray, "step node 2"]:
    """Change of a displacement by averaging over the window, as its root mean square over that window.

    The value of a single point beside an interface may vanish by accident, so the mean over its surroundings is taken.
    """
    if window == 0.0:
        return np.zeros_like(u)
    mean, flat = window_average(grid, window, kernel), u.reshape(len(u), -1).T
    # The weights of a quadratic fit are negative in places.
    return np.sqrt(np.maximum(mean @ (mean @ flat - flat) ** 2, 0.0)).T.reshape(u.shape)


def blurred_edges(
    measurement: xr.Dataset, grid: Mesh, u: Float[np.ndarray, "step node 2"], noise: Float[np.ndarray, "step 2"]
) -> Float[np.ndarray, "step node 2"]:
    """By how much a point may be off that prescribes what it sees through a window; zero where noise would hide it.

    Where an interface crosses an edge, the displacement bends, and a mean over a window is not its middle. A point
    inside the sheet is compared through the window. One that prescribes the displacement cannot be.

    Args:
        u: measured displacement, known everywhere.
        noise: of a displacement.
    """
    side, kernel = correlation_window(measurement)
    side = priors.USUAL_WINDOW * grid.step if window_sought(measurement) else side
    changed = changed_by_window(grid, u, side, kernel)
    return np.where(changed > thresholds.BY_CHANCE * noise[:, None], changed, 0.0)


def window_errors(
    measurement: xr.Dataset, grid: Mesh, u: Float[np.ndarray, "step node 2"], shared: bool
) -> tuple[np.ndarray, np.ndarray]:
    """(standard deviation of what is seen at every node about the mean over its window, level that it weighs as).

    The level is that of equivalent independent errors. The errors are identical in all steps, and shared between
    subsets by the square of their overlap.

    Args:
        u: measured displacement, known everywhere.
        shared: whether errors count as shared.
    """
    (window, kernel), share = correlation_window(measurement), window_uncertainty(measurement)
    error = share * changed_by_window(grid, u, window, kernel)
    return error, error * (_weight(grid, window, len(u)) if shared and window > 0.0 else 1.0)


def with_errors_of_elements(error, weighed, grid: Mesh, u: Float[np.ndarray, "step node 2"], size: float):
    """The errors of :func:`window_errors`, beside those that finite elements make where displacements bend.

    Elements are as wrong as what a mean over one of them changes. They are so in every step.

    Args:
        size: root mean square of the errors of elements.
    """
    side = grid.step
    changed = changed_by_window(grid, u, side, "average")
    mean = float(np.sqrt(np.mean(changed**2)))
    if mean == 0.0:
        return error, weighed
    own = size / mean * changed
    return np.hypot(error, own), np.hypot(weighed, own * _weight(grid, side, len(u)))


def told_errors(residuals: Float[np.ndarray, " point"], changed: Float[np.ndarray, " point"]) -> tuple[float, float]:
    """Maximum-likelihood (level of the noise, share of the change by the window) for the residuals of a field.

    Residuals are normal with the variance level^2 + share^2 changed^2. Correlation of the errors changes the
    uncertainty of this estimate, and not the estimate.

    Args:
        residuals: of displacements.
        changed: what the window changes of them, in the same unit.
    """
    size = float(np.sqrt(np.mean(residuals**2)))
    if not changed.any():
        return size, 0.0

    def unlikely(numbers):
        variance = np.exp(2.0 * numbers[0]) + (numbers[1] * changed / size) ** 2
        return float(np.mean(np.log(variance) + (residuals / size) ** 2 / variance))

    bounds = [(-5.0, 1.0), (0.0, priors.LARGEST_SHARE)]
    level, share = minimize(unlikely, [0.0, priors.FIRST_SHARE], bounds=bounds, method="L-BFGS-B").x
    return size * float(np.exp(level)), float(share)


def _weight(grid: Mesh, window: float, steps: int) -> float:
    """Level of independent errors over that of errors which so many steps and overlapping subsets share."""
    squared = float(steps)
    for line in grid.lines:
        apart = np.arange(1, len(line)) * np.ptp(line) / (len(line) - 1)
        squared *= 1.0 + 2.0 * (np.maximum(1.0 - apart / window, 0.0) ** 2).sum()
    return float(np.sqrt(squared))
