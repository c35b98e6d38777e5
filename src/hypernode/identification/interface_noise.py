"""Residuals of the displacements after a fit: their size, and their effective number of independent values."""

import dataclasses

import numpy as np

from hypernode.fem.mesh import Mesh
from hypernode.identification import priors, thresholds


@dataclasses.dataclass(frozen=True, kw_only=True)
class Left:
    """Residuals of a fit.

    Attributes:
        level: root mean square over the assumed noise, corrected for the number of fitted parameters.
        neighbours: variance of a mean over neighbours over that of independent errors, at least one.
        steps: correlation of the same point in different steps, at least zero. Errors of the law, the mesh or the
            reference picture are the same in every step.
        count: how many residuals there are.
    """

    level: float
    neighbours: float
    steps: float
    count: int
    number_of_steps: int

    @property
    def alike(self) -> bool:
        """Whether the residuals of different steps agree too well to be noise."""
        return bool(self.steps > thresholds.NOISE_SHARED)

    @property
    def inflation(self) -> float:
        """Number of residuals over the effective number of independent ones."""
        return self.neighbours * (1.0 + (self.number_of_steps - 1) * self.steps)

    @property
    def independent(self) -> float:
        """Effective number of independent residuals."""
        return self.count / self.inflation


def left_of(grid: Mesh | None, observed, white, determined: float) -> Left:
    """Size and correlation of the residuals of displacements.

    Args:
        grid: measured grid; None where no points were observed, whose neighbours might share errors.
        observed: numbers of the observed degrees of freedom, by step.
        white: their residuals over the noise, free of what edges share, by step.
        determined: how many numbers were fitted.
    """
    count = sum(len(values) for values in white)
    if grid is None:
        square = float(np.mean(np.concatenate(white) ** 2))
        return Left(
            level=np.sqrt(square / max(1.0 - determined / max(count, 1), 0.1)),
            neighbours=1.0,
            steps=0.0,
            count=count,
            number_of_steps=len(white),
        )
    place, shape = grid.places, (len(grid.lines[1]), len(grid.lines[0]))
    maps = np.full((len(white), 2, shape[0] * shape[1]), np.nan)
    for k, (dofs, values) in enumerate(zip(observed, white, strict=True)):
        maps[k, dofs % 2, place[dofs // 2]] = values
    maps = maps.reshape(len(white), 2, *shape)
    square = float(np.nanmean(maps**2))
    along = [_correlations(maps, axis) for axis in (2, 3)]
    # Of a separable correlation, a mean over the plane is worth the product of those over lines.
    neighbours = float(np.prod([1.0 + 2.0 * np.maximum(each, 0.0).sum() for each in along]))
    shared = 0.0
    if len(white) > 1:
        scaled = maps / np.sqrt(np.nanmean(maps**2, axis=(1, 2, 3), keepdims=True))
        pairs = [(i, j) for i in range(len(white)) for j in range(i)]
        shared = max(float(np.mean([np.nanmean(scaled[i] * scaled[j]) for i, j in pairs])), 0.0)
    level = np.sqrt(square / max(1.0 - determined / max(count, 1), 0.1))
    return Left(level=level, neighbours=neighbours, steps=shared, count=count, number_of_steps=len(white))


def _correlations(maps, axis: int) -> np.ndarray:
    """Correlation of points 1 to :data:`REACH` apart along an axis; none behind the first that is not there."""
    mean = np.nanmean(maps**2)
    found = np.zeros(priors.NOISE_REACH)
    for apart in range(1, min(priors.NOISE_REACH, maps.shape[axis] - 1) + 1):
        one, other = (
            np.take(maps, range(apart, maps.shape[axis]), axis),
            np.take(maps, range(maps.shape[axis] - apart), axis),
        )
        value = float(np.nanmean(one * other) / mean)
        if value <= 1.0 / np.sqrt(maps.size):
            break
        found[apart - 1] = value
    return found
