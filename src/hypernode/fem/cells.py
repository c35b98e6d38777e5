"""What cells of finite elements answer, compiled once for a law and not anew for every mesh."""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

#: Numbers of cells to which those of small meshes are filled up, so that meshes of other sizes share what is compiled.
SIZES = 64, 256


def filled(cells: int) -> np.ndarray:
    """Numbers of cells, the last one again until there are as many as one of ``SIZES``, or as they are."""
    size = next((size for size in SIZES if cells <= size), cells)
    return np.minimum(np.arange(size), cells - 1)


@functools.lru_cache(maxsize=16)
def cell_forces(stress: Callable, names: tuple[str, ...]):
    """(nodal forces (cell, 8), those and their derivative (cell, 8, 8)) of cells with a law of stress.

    Arguments are nodal displacements (cell, 8), gradients (cell, quad, 4, 2), weights (cell, quad) and parameters.
    """

    def forces_of(P, gradient, weight):
        return jnp.einsum("q,qaJ,qiJ->ai", weight, gradient, P).ravel()

    def deformation(u, gradient):
        return jnp.eye(2) + jnp.einsum("ai,qaJ->qiJ", u.reshape(4, 2), gradient)

    def forces(u, gradient, weight, *values):
        P = jax.vmap(lambda F: stress(F, dict(zip(names, values, strict=True))))(deformation(u, gradient))
        return forces_of(P, gradient, weight)

    def tangent(u, gradient, weight, *values):
        """By the chain rule through F: four derivatives at a quadrature point, not eight of the whole cell."""

        def stress_at(F):
            P = stress(F, dict(zip(names, values, strict=True)))
            return P, P

        A, P = jax.vmap(jax.jacfwd(stress_at, has_aux=True))(deformation(u, gradient))
        stiffness = jnp.einsum("q,qaJ,qiJkL,qbL->aibk", weight, gradient, A, gradient)
        return forces_of(P, gradient, weight), stiffness.reshape(8, 8)

    return jax.jit(jax.vmap(forces)), jax.jit(jax.vmap(tangent))
