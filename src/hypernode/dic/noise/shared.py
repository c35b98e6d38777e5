"""Errors that several frames share: the speckle pattern biases every frame alike, so averaging does not remove them."""

import numpy as np
from jaxtyping import Float

from hypernode.dic.noise.local import STENCIL

#: Correlation of the fine errors of load steps beyond which they are the sheet's own deformation. A texture misleads
#: pictures that each have noise: steps of three printed sheets share 0.90. Of a sheet without noise they share 0.99 and
#: more wherever interfaces are sharp, and its kinks pass for noise that is a hundred times too large.
DEFORMATION = 0.97
#: Steps that tell what a step does not share with the others.
FEWEST_STEPS = 3
#: Power of the size of the displacement with which deformation grows at least. It is 1, or a little less where stiff
#: grains give way; errors of the reference are the same in every step.
GROWTH = 0.5
#: Ratio of the displacements of two steps from which growth is seen.
APART = 1.5


def fine(displacement: Float[np.ndarray, "step row column 2"]) -> Float[np.ndarray, "step value"]:
    """Fourth differences of every load step along x and y, NaN where one of the points was lost."""
    parts = []
    for axis in (1, 2):
        size = displacement.shape[axis] - len(STENCIL) + 1
        shifted = [np.take(displacement, np.arange(k, k + size), axis=axis) for k in range(len(STENCIL))]
        parts.append(sum(c * part for c, part in zip(STENCIL, shifted, strict=True)))
    return np.concatenate([part.reshape(len(displacement), -1) for part in parts], axis=1)


def shared_by_steps(displacement: Float[np.ndarray, "step row column 2"]) -> float:
    """Mean correlation of the fine errors of two load steps, from 0 to 1.

    It is sin(pi/2 q), with q the mean product of the signs of the fine differences. This holds for a normal
    distribution (Blomqvist, On a measure of dependence between two random variables, 1950). The few points at
    interfaces have little influence.
    """
    values = fine(displacement)
    found = []
    for a in range(len(values)):
        for b in range(a):
            both = np.isfinite(values[a]) & np.isfinite(values[b]) & (values[a] != 0.0) & (values[b] != 0.0)
            if both.any():
                found.append(np.sin(0.5 * np.pi * np.mean(np.sign(values[a][both] * values[b][both]))))
    return float(np.clip(np.mean(found), 0.0, 1.0)) if found else 0.0


def belongs_to_the_sheet(displacement: Float[np.ndarray, "step row column 2"], shared: float) -> bool:
    """Whether the fine differences are deformation: load steps share them, and they grow with the displacement.

    Args:
        shared: mean correlation of the fine errors of two steps.
    """
    if len(displacement) < FEWEST_STEPS or shared <= DEFORMATION:
        return False
    size = np.nanstd(displacement, axis=(1, 2)).max(axis=1)
    rough = np.sqrt(np.nanmean(fine(displacement) ** 2, axis=1))
    least, most = np.argmin(size), np.argmax(size)
    if not 0.0 < APART * size[least] < size[most]:
        return False
    return bool(rough[most] > rough[least] * (size[most] / size[least]) ** GROWTH)


def as_independent(level: Float[np.ndarray, "step 2"], shared: float) -> Float[np.ndarray, "step 2"]:
    """Level of independent errors that make the mean of the steps as uncertain as shared errors do.

    The mean of n values of variance s^2 and correlation r has the variance s^2 (1 + (n - 1) r) / n.
    """
    return level * np.sqrt(1.0 + (len(level) - 1) * shared)


def not_shared(displacement: Float[np.ndarray, "step row column 2"]) -> Float[np.ndarray, "step row column 2"]:
    """Residual of each step after regression on its two nearest steps, scaled to the size of its own errors.

    The regression is fitted to the fine differences.
    """
    count, left = len(displacement), np.empty_like(displacement)
    for component in range(2):
        each = displacement[..., component]
        values = fine(each[..., None])
        values = values[:, np.isfinite(values).all(axis=0)]
        for step in range(count):
            beside = np.argsort(np.abs(np.arange(count) - step), kind="stable")[1:3]
            shares = np.linalg.lstsq(values[beside].T, values[step], rcond=None)[0]
            rest = each[step] - np.tensordot(shares, each[beside], 1)
            left[step, ..., component] = rest / np.hypot(1.0, np.linalg.norm(shares))
    return left
