"""The stress of cells under deformations that all of them undergo: what it may become, and how it may jump."""

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


class StressJumps:
    """What jumps over the sheet: how large the stress of each cell is, and how that depends on the deformation.

    Args:
        law: the law of all cells.
        F: the deformations.
    """

    def __init__(self, law: PointLaw, F: Float[np.ndarray, "deformation 2 2"]):
        F = jnp.asarray(np.moveaxis(F, 0, -1))

        def values(params):
            sizes = 0.5 * jnp.log(jnp.sum(law.stress(F, params[:, None]) ** 2, axis=(0, 1)))
            return jnp.concatenate([jnp.mean(sizes)[None], sizes - jnp.mean(sizes)])

        self._values, self._slope = jax.jit(jax.vmap(values)), jax.jit(jax.vmap(jax.jacrev(values)))
        #: Names of what jumps, the mean logarithm of the stress first, then how much each deformation differs from it.
        self.names = ("stress", *(f"stress_{k}" for k in range(F.shape[-1])))

    def values(self, params: Float[np.ndarray, "cell parameter"]) -> Float[np.ndarray, "cell value"]:
        """The logarithms of every cell."""
        return np.asarray(self._values(params))

    def slope(self, params: Float[np.ndarray, "cell parameter"]) -> Float[np.ndarray, "cell value parameter"]:
        """Their derivative by the parameters of the cell."""
        return np.asarray(self._slope(params))
