"""What it costs a material to come away from what it was under deformations that a test may say nothing of."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.mechanics.point_law import PointLaw


class Nearness:
    """The squared distance of the stress of the cells from what it was, under deformations that all cells undergo.

    If under one of them the stress of all cells is off by ``deviation``, root mean square, that costs 1/2.

    Args:
        law: the law of all cells.
        params: parameters of every cell from which the stress may come away (cell, parameter).
        F: the deformations.
        deviation: relative, to the root mean square of the stress over the cells.
    """

    def __init__(
        self,
        law: PointLaw,
        params: Float[np.ndarray, "cell parameter"],
        F: Float[np.ndarray, "deformation 2 2"],
        deviation: float,
    ):
        F = jnp.asarray(np.moveaxis(F, 0, -1))

        def stress(params):
            return law.stress(F, params[:, None])

        self._before = jax.jit(jax.vmap(stress))(jnp.asarray(params))
        size = jnp.sqrt(jnp.mean(jnp.sum(self._before**2, axis=(1, 2)), axis=0))
        unit = deviation * size * np.sqrt(len(params))

        def residual(params, before):
            return ((stress(params) - before) / unit).ravel()

        self._residual = jax.jit(jax.vmap(residual))
        self._slope = jax.jit(jax.vmap(jax.jacrev(residual)))

    def value(self, params: Float[np.ndarray, "cell parameter"]) -> float:
        """The cost."""
        return 0.5 * float(jnp.sum(self._residual(params, self._before) ** 2))

    def linearise(self, params: Float[np.ndarray, "cell parameter"]) -> tuple[np.ndarray, Callable]:
        """(derivative of the cost by the flattened parameters, change -> its curvature times that)."""
        slope = np.asarray(self._slope(params, self._before))
        transposed = np.ascontiguousarray(slope.transpose(0, 2, 1))

        def curvature(change):
            return (transposed @ (slope @ change.reshape(*params.shape, 1))).ravel()

        return (transposed @ np.asarray(self._residual(params, self._before))[..., None]).ravel(), curvature
