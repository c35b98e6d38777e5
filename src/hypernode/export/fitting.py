"""Least squares for many curves at once, with bounds: Levenberg and Marquardt's method, projected."""

from functools import lru_cache, partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.export.laws import Law

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
    return jnp.stack([P[..., 0, 0], P[..., 1, 1], (P[..., 0, 1] + P[..., 1, 0]) / jnp.sqrt(2.0)], axis=-1)


def law_components(law: Law, F: Float[np.ndarray, "point 2 2"], params) -> Float[np.ndarray, "point 3"]:
    """:func:`components` of a law's stress."""
    return components(jnp.moveaxis(law.stress(jnp.moveaxis(F, 0, -1), params), -1, 0))


@lru_cache
def _linearised(law: Law):
    """(params, F, noise) of some fits -> what the law predicts over the noise, and its derivative, of every fit."""

    def predicted(params, F, noise):
        return (law_components(law, F, params) / noise).ravel()

    def both(params, F, noise):
        value = partial(predicted, F=F, noise=noise)
        return value(params), jax.jacfwd(value)(params)

    return jax.jit(jax.vmap(both))


def fit(
    law: Law,
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
    value, jacobian = map(np.asarray, _linearised(law)(params, F, noise))
    squares = ((value - target) ** 2).sum(axis=1)
    rounding = TOLERANCE * np.finfo(float).eps * (target**2).sum(axis=1)
    open_fits = np.ones(len(starts), bool)
    for _ in range(ITERATIONS):
        step = _step(params, value - target, jacobian, damping, lowest, highest)
        moved = np.clip(params + step, lowest, highest)
        new_value, new_jacobian = map(np.asarray, _linearised(law)(moved, F, noise))
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
