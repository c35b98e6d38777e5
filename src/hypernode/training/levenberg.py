"""Least squares with a few parameters: Levenberg's method."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

#: Damping at the beginning, and beyond which no step lowers the sum of squares, over the mean curvature.
DAMPING, LARGEST_DAMPING = 1e-3, 1e4
#: A fit has ended where two steps running lower the sum of squares by less than this share of it.
TOLERANCE = 1e-2


def least_squares(residual: Callable, iterations: int, enough: float) -> Callable:
    """A function of (start, data) that lowers the squares of ``residual(params, data)``, compiled once for all data.

    Every parameter is damped alike. The weights of a neural ODE are of one size, and with Marquardt's scaling those of
    which little depends would run away.

    Args:
        residual: function of the parameters (parameter,) and of a pytree of arrays, one axis.
        iterations: most steps that lower it.
        enough: sum of squares below which it ends.

    Returns:
        function whose values are the parameters at the end, and the sum of squares at the start and after every step.
    """

    @jax.jit
    def linearised(params, data):
        return residual(params, data), jax.jacfwd(residual)(params, data)

    value_at = jax.jit(residual)

    def solve(start, data) -> tuple[Float[np.ndarray, " parameter"], Float[np.ndarray, " step"]]:
        params, damping = np.asarray(start, float), DAMPING
        value, jacobian = _doubles(*linearised(jnp.asarray(params, jnp.float32), data))
        squares = [value @ value]
        while len(squares) <= iterations and squares[-1] > enough and damping < LARGEST_DAMPING:
            curvature = jacobian.T @ jacobian
            damped = curvature + damping * np.trace(curvature) / len(params) * np.eye(len(params))
            moved = params - np.linalg.solve(damped, jacobian.T @ value)
            (there,) = _doubles(value_at(jnp.asarray(moved, jnp.float32), data))
            if not there @ there < squares[-1]:
                damping *= 4.0
                continue
            params, damping = moved, damping / 5.0
            value, jacobian = _doubles(*linearised(jnp.asarray(params, jnp.float32), data))
            squares.append(value @ value)
            if len(squares) > 2 and squares[-3] - squares[-1] < TOLERANCE * squares[-3]:
                break
        return params, np.array(squares)

    return solve


def _doubles(*arrays):
    return tuple(np.asarray(array, float) for array in arrays)
