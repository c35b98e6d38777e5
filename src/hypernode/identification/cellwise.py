"""Derivatives of a law that an identification asks of every cell, compiled once for the law."""

import functools

import jax
import jax.numpy as jnp

from hypernode.mechanics.point_law import PointLaw

#: Nodal forces of a bilinear cell.
CELL_FORCES = 8


@functools.cache
def cell_sensitivity(law: PointLaw):
    """d(nodal forces)/d(parameters) (cell, 8, parameter).

    A function of nodal displacements (cell, 4, 2), parameters (cell, parameter), gradients and weights of cells.
    """

    def sensitivity(u, params, gradient, weight):
        def nodal(params):
            F = jnp.eye(2)[:, :, None] + jnp.einsum("ai,qaJ->iJq", u, gradient)
            return jnp.einsum("q,qaJ,iJq->ai", weight, gradient, law.stress(F, params[:, None])).ravel()

        # One pass a parameter, or one a nodal force, whichever are fewer.
        return (jax.jacfwd if len(params) <= CELL_FORCES else jax.jacrev)(nodal)(params)

    return jax.jit(jax.vmap(sensitivity))


@functools.cache
def log_stress(law: PointLaw):
    """Logarithm of the size of the stress (cell,), every step over its scale, and its derivative by the parameters.

    A function of parameters (cell, parameter), of a deformation gradient [i, J, step] and of the scale.
    """

    def of_cell(params, F, scale):
        P = law.stress(F, params[:, None]) / scale
        return 0.5 * jnp.log(jnp.sum(P**2))

    return jax.jit(jax.vmap(jax.value_and_grad(of_cell), (0, None, None)))
