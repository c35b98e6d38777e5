"""Least squares for many curves at once, with bounds: Levenberg and Marquardt's method, projected."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from hypernode.export.laws import ExportedLaw
from hypernode.export.numpy_material.api import STEP

#: Most iterations; a fit that still descends then is as good as its misfit says.
ITERATIONS = 200
#: A fit has ended where the sum of squares falls by less than this share of itself, plus what rounding leaves.
TOLERANCE = 1e-10
#: Damping at the beginning, and beyond which no step lowers the sum of squares.
DAMPING, LARGEST_DAMPING = 1e-2, 1e10


class Fit(NamedTuple):
    """Parameters of some fits, their sums of squares over the noise, and residuals' derivatives there."""

    params: Float[np.ndarray, "fit parameter"]
    squares: Float[np.ndarray, " fit"]
    jacobian: Float[np.ndarray, "fit residual parameter"]


def components(P: Float[np.ndarray, "... 2 2"]) -> Float[np.ndarray, "... 3"]:
    """(P_xX, P_yY, (P_xY + P_yX) / sqrt 2): a plane stress has three numbers."""
    return np.stack([P[..., 0, 0], P[..., 1, 1], (P[..., 0, 1] + P[..., 1, 0]) / np.sqrt(2.0)], axis=-1)


def law_components(
    law: ExportedLaw, F: Float[np.ndarray, "... point 2 2"], params: Float[np.ndarray, "... parameter"]
) -> Float[np.ndarray, "... point 3"]:
    """:func:`components` of a law's stress."""
    P = law.stress(np.moveaxis(F, (-2, -1), (0, 1)), np.moveaxis(params, -1, 0)[..., None])
    return components(np.moveaxis(P, (0, 1), (-2, -1)))


def _linearised(law: ExportedLaw, F, noise, params):
    """What a law predicts over the noise (fit, residual), and its derivative by each parameter."""
    value = law_components(law, F, params) / noise
    columns = []
    for k in range(params.shape[1]):
        moved = params.astype(complex)
        moved[:, k] += 1j * STEP
        columns.append(np.imag(law_components(law, F, moved)) / STEP / noise)
    return value.reshape(len(params), -1), np.stack(columns, axis=-1).reshape(len(params), -1, params.shape[1])


def fit(
    law: ExportedLaw,
    F: Float[np.ndarray, "fit point 2 2"],
    stress: Float[np.ndarray, "fit point 3"],
    noise: Float[np.ndarray, "fit point 3"],
    starts: Float[np.ndarray, "fit parameter"],
    stiffness: Float[np.ndarray, " fit"],
) -> Fit:
    """The parameters that explain stresses best, from a start each.

    Args:
        law: whose parameters are sought.
        F: deformation gradients.
        stress: :func:`components` of the stresses to be explained.
        noise: standard deviation of each, infinite where a point does not count.
        starts: where each fit begins.
        stiffness: typical modulus of each, by which the law's bounds are measured.
    """
    lowest, highest = law.bounds(stiffness)
    target = (stress / noise).reshape(len(starts), -1)
    params, damping = np.clip(starts, lowest, highest), np.full(len(starts), DAMPING)
    value, jacobian = _linearised(law, F, noise, params)
    squares = ((value - target) ** 2).sum(axis=1)
    rounding = TOLERANCE * np.finfo(float).eps * (target**2).sum(axis=1)
    open_fits = np.ones(len(starts), bool)
    for _ in range(ITERATIONS):
        step = _step(params, value - target, jacobian, damping, lowest, highest)
        moved = np.clip(params + step, lowest, highest)
        new_value, new_jacobian = _linearised(law, F, noise, moved)
        new_squares = ((new_value - target) ** 2).sum(axis=1)
        better = open_fits & (new_squares < squares)
        ended = better & (squares - new_squares <= TOLERANCE * squares + rounding)
        params, value = np.where(better[:, None], moved, params), np.where(better[:, None], new_value, value)
        jacobian = np.where(better[:, None, None], new_jacobian, jacobian)
        squares = np.where(better, new_squares, squares)
        damping = np.where(better, damping / 5.0, damping * 4.0)
        open_fits &= ~ended & (damping < LARGEST_DAMPING)
        if not open_fits.any():
            break
    return Fit(params, squares, jacobian)


def _step(params, residual, jacobian, damping, lowest, highest):
    """The damped step of every fit; parameters on a bound that would leave it stay."""
    gradient = np.einsum("frp,fr->fp", jacobian, residual)
    held = ((params <= lowest) & (gradient > 0.0)) | ((params >= highest) & (gradient < 0.0))
    free = np.where(held, 0.0, 1.0)
    normal = np.einsum("frp,frq->fpq", jacobian, jacobian) * free[:, :, None] * free[:, None, :]
    diagonal = np.einsum("fpp->fp", normal)
    # A parameter of which nothing depends would leave the matrix singular.
    scale = np.maximum(diagonal, 1e-12 * diagonal.max(axis=1, keepdims=True)) + (diagonal.max(axis=1) == 0.0)[:, None]
    normal = normal + np.einsum(
        "fp,pq->fpq", damping[:, None] * scale + np.where(held, scale, 0.0), np.eye(params.shape[1])
    )
    return -np.linalg.solve(normal, (gradient * free)[..., None])[..., 0]
