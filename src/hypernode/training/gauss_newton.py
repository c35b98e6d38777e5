"""Least squares with many parameters: Gauss-Newton steps by conjugate gradients, with the products of JAX alone."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax.flatten_util import ravel_pytree

from hypernode.training.loop import compiled

#: Iterations of conjugate gradients of a step, and the relative residual at which they end. More would gain less than
#: another step.
CG_ITERATIONS, CG_TOLERANCE = 30, 1e-3
#: Damping of the first step, the least, and its factors after a step that lowers the error or does not.
DAMPING, LEAST_DAMPING, EASIER, HARDER = 1e-5, 1e-9, 1.0 / 3.0, 4.0


def gauss_newton(residual: Callable, errors: Callable, like) -> Callable:
    """A function of (params, samples, enough) that lowers errors, compiled once.

    A step is that of the residuals of a sample. It is taken where it lowers the mean square of all errors.

    Args:
        residual: function of a pytree of float32 parameters and of a sample, of any shape.
        errors: function of the parameters: of every case, one axis.
        like: parameters, for their structure.

    Returns:
        function of the parameters to start from, of the samples, one a step, and of the largest error of a case at
        which no step is taken any more. Its values are the parameters at the end, and the largest error at the start
        and after every step.
    """
    _, unflatten = ravel_pytree(like)
    errors_at = compiled(lambda x: errors(unflatten(x)))
    change_at = compiled(lambda x, *others: _change(lambda y, sample: residual(unflatten(y), sample), x, *others))

    def solve(params, samples, enough):
        x, _ = ravel_pytree(params)
        damping, now = DAMPING, errors_at(x)
        largest = [float(now.max())]
        for sample in samples:
            if largest[-1] <= enough:
                break
            moved = x + change_at(x, sample, damping)
            after = errors_at(moved)
            if jnp.mean(after**2) < jnp.mean(now**2):
                x, now, damping = moved, after, max(EASIER * damping, LEAST_DAMPING)
            else:
                damping *= HARDER
            largest.append(float(now.max()))
        return unflatten(x), largest

    return solve


def _change(residual, x, sample, damping):
    """Change of the parameters that lowers the mean square of the linearised residuals."""
    value, along = jax.linearize(lambda y: residual(y, sample), x)
    back = jax.linear_transpose(along, x)

    def curvature(v):
        return back(along(v))[0] / value.size + damping * v

    gradient = back(value)[0] / value.size
    return jax.scipy.sparse.linalg.cg(curvature, -gradient, maxiter=CG_ITERATIONS, tol=CG_TOLERANCE)[0]
