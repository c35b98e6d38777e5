"""Monotone scalar functions as the flow of a neural ordinary differential equation.

The weights of a neural ODE are another network's output, so this is a pure function of an array of
weights and not a module. Weights come first and points last, ``weights[k, ..., point]``: a layer is one product and
one sum over its few neurons, and every operation runs over contiguous points (docs/decisions/0160).
"""

from collections.abc import Sequence
from itertools import pairwise

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

#: Largest slope of f times a step for which one RK4 step is increasing. Its derivative is linear in each of the
#: slopes at the four stages, so its minimum over slopes within +-s is at a corner; it is positive to s = 1.59.
LARGEST_SLOPE = 1.5
#: Weights of one layer.
Matrix = Float[Array, "out in ..."]


def layer_sizes(hidden: Sequence[int]) -> tuple[int, ...]:
    """Layer sizes [1, *hidden, 1] of the right-hand side."""
    return (1, *hidden, 1)


def weight_count(hidden: Sequence[int]) -> int:
    """Number of weights of the bias-free right-hand side with these hidden widths."""
    return sum(a * b for a, b in pairwise(layer_sizes(hidden)))


def unflatten(weights: Float[Array, "k ..."], hidden: Sequence[int]) -> list[Matrix]:
    """Weights of every layer of the right-hand side from the flat ones, row by row."""
    sizes = list(pairwise(layer_sizes(hidden)))
    parts = jax.lax.split(weights, [a * b for a, b in sizes], axis=0)
    return [part.reshape(b, a, *weights.shape[1:]) for part, (a, b) in zip(parts, sizes, strict=True)]


def slope_bound(matrices: Sequence[Matrix]) -> Float[Array, "..."]:
    """Upper bound of |df/dh|: the product of the layers' absolute weights, as tanh has slope one at most."""
    bound = jnp.ones_like(matrices[0][0])
    for matrix in matrices:
        bound = jnp.sum(jnp.abs(matrix) * bound, axis=1)
    return bound[0]


def right_hand_side(h: Float[Array, "..."], matrices: Sequence[Matrix]) -> Float[Array, "..."]:
    """f(h): tanh between bias-free layers, linear last; f(0) = 0 because there are no biases.

    Axes of the weights behind out and in are as many as those of h.
    """
    first, *others = matrices
    layer = first[:, 0] * h
    for matrix in others:
        layer = jnp.sum(matrix * jnp.tanh(layer), axis=1)
    return layer[0]


def flow(
    h: Float[Array, "..."], weights: Float[Array, "k ..."], hidden: Sequence[int], steps: int
) -> Float[Array, "..."]:
    """h(1) of dh/dtau = f(h), h(0) = h (equation ``NODE_potential``), by RK4 in equal steps.

    Trajectories of a scalar ODE do not cross, so h(1) is an increasing function of h(0) that
    passes through zero. So that the discrete flow is one as well, f is scaled down where its slope might
    exceed :data:`LARGEST_SLOPE` over one step. Each step is rematerialised in the backward pass:
    recomputing the few neurons is cheaper than the memory traffic of storing them.

    Args:
        h: initial values.
        weights: flat weights [k, ...], broadcastable against ``h``.
        hidden: hidden widths of the right-hand side.
        steps: number of RK4 steps.
    """
    shape = jnp.broadcast_shapes(h.shape, weights.shape[1:])
    # As many axes as the result, so that those behind out and in line up with h.
    weights = jnp.expand_dims(weights, tuple(range(1, 2 + len(shape) - weights.ndim)))
    *matrices, last = unflatten(weights, hidden)
    dt = 1.0 / steps
    matrices.append(last / jnp.maximum(1.0, slope_bound([*matrices, last]) * dt / LARGEST_SLOPE))

    @jax.checkpoint
    def step(h, _):
        """One step of RK4."""
        k1 = right_hand_side(h, matrices)
        k2 = right_hand_side(h + 0.5 * dt * k1, matrices)
        k3 = right_hand_side(h + 0.5 * dt * k2, matrices)
        k4 = right_hand_side(h + dt * k3, matrices)
        return h + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), None

    return jax.lax.scan(step, jnp.broadcast_to(h, shape), None, length=steps)[0]
