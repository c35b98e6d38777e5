"""Regions of a sheet told apart by functions linear in given features: logistic regression, Newton's method."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

#: Costs of the squared weights. The largest under which every cell is told apart is kept: the smoother a function, the
#: better it is between the cells.
RIDGES = (1e-3, 1e-4, 1e-5, 1e-6)
#: Most steps of Newton's method.
STEPS = 40
#: It has ended where a step changes the function by less than that anywhere.
SMALL_STEP = 1e-2
#: Nor may a step change it by more.
LARGEST_STEP = 20.0


class Separation(NamedTuple):
    """Functions of which each is positive in one region and negative in all others.

    Attributes:
        background: the region that has none: where all are negative.
        regions: number of the region of each function (function,).
        weights: of the features, the last for a constant one (feature, function).
        margins: the smallest size of each at a cell (function,).
    """

    background: int
    regions: np.ndarray
    weights: np.ndarray
    margins: np.ndarray


def separate(features: Float[np.ndarray, "cell feature"], labels: Int[np.ndarray, " cell"]) -> Separation | None:
    """Functions that tell all regions apart, one fewer than regions, or None where some cell is told wrongly.

    The background is the region that is hardest to tell from the others.

    Args:
        features: of every cell.
        labels: region of every cell, 0 and on without a gap.
    """
    features = np.column_stack([features, np.ones(len(features))])
    size = np.sqrt(np.mean(np.sum(features**2, axis=1)))
    features = features / size
    # Of two regions one is where the other is not.
    regions = np.arange(labels.max() + 1) if labels.max() != 1 else np.array([1])
    found = [_told_apart(features, np.where(labels == region, 1.0, -1.0)) for region in regions]
    margins = np.array([margin for _, margin in found])
    background = 0 if labels.max() == 1 else int(np.argmin(margins))
    kept = np.flatnonzero(regions != background)
    if (margins[kept] <= 0.0).any():
        return None
    weights = np.stack([weights for weights, _ in found], axis=-1) / size
    return Separation(background, regions[kept], weights[:, kept], margins[kept])


def _told_apart(features, sign):
    """(weights, smallest of sign times function) of the smoothest function that has the sign at every cell."""
    weights = np.zeros(features.shape[1])
    for ridge in RIDGES:
        weights = _logistic(features, sign, ridge, weights)
        value = features @ weights
        if (value * sign).min() > 0.0:
            break
    return weights, (value * sign).min()


def _logistic(features, sign, ridge, weights):
    """Weights of the least sum of log(1 + exp(-sign * function)) and ridge / 2 times the squared weights."""
    for _ in range(STEPS):
        wrong = 1.0 / (1.0 + np.exp(np.clip(sign * (features @ weights), -500.0, 500.0)))
        gradient = ridge * weights - features.T @ (sign * wrong)
        curvature = (features * (wrong * (1.0 - wrong))[:, None]).T @ features
        curvature[np.diag_indices_from(curvature)] += ridge
        step = -np.linalg.solve(curvature, gradient)
        # A whole step may leave the few cells that decide far on the wrong side.
        step *= min(1.0, LARGEST_STEP / np.abs(features @ step).max())
        weights = weights + step
        if np.abs(features @ step).max() < SMALL_STEP:
            break
    return weights
