"""Monotone scalar functions as the flow of a neural ordinary differential equation.

The weights of a neural ODE are another network's output, so this is a pure function of an array of
weights and not a module. Weights come first and points last, ``weights[k, ..., point]``: the sums
over the few neurons are unrolled and every operation runs over contiguous points.
"""

from collections.abc import Sequence
from itertools import pairwise

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

#: Largest slope of f times a step for which one RK4 step is increasing. Its derivative is linear in each of the
#: slopes at the four stages, so its minimum over slopes within +-s is at a corner; it is positive to s = 1.59.
LARGEST_SLOPE = 1.5
#: Weights [out][in] of one layer.
Matrix = list[list[Float[Array, "..."]]]


def layer_sizes(hidden: Sequence[int]) -> tuple[int, ...]:
    """Layer sizes [1, *hidden, 1] of the right-hand side."""
    return (1, *hidden, 1)


def weight_count(hidden: Sequence[int]) -> int:
    """Number of weights of the bias-free right-hand side with these hidden widths."""
    return sum(a * b for a, b in pairwise(layer_sizes(hidden)))


def unflatten(weights: Float[Array, "k ..."], hidden: Sequence[int]) -> list[Matrix]:
    """Weights [layer][out][in] of the right-hand side from the flat ones, each an array of its own.

    Reverse mode then adds up each of them by itself. Of slices of one array it would add up whole arrays that are
    zero but for the slice, which takes twice as long as everything else together.
    """
    each = iter(jnp.squeeze(part, 0) for part in jax.lax.split(weights, (1,) * len(weights), axis=0))
    return [[[next(each) for _ in range(a)] for _ in range(b)] for a, b in pairwise(layer_sizes(hidden))]


def slope_bound(matrices: Sequence[Matrix]) -> Float[Array, "..."]:
    """Upper bound of |df/dh|: the product of the layers' absolute weights, as tanh has slope one at most."""
    bound = [1.0]
    for matrix in matrices:
        bound = [sum(jnp.abs(weight) * b for weight, b in zip(row, bound, strict=True)) for row in matrix]
    return bound[0]


def right_hand_side(h: Float[Array, "..."], matrices: Sequence[Matrix]) -> Float[Array, "..."]:
    """f(h): tanh between bias-free layers, linear last; f(0) = 0 because there are no biases."""
    layer = [h]
    for depth, matrix in enumerate(matrices):
        layer = [sum(weight * value for weight, value in zip(row, layer, strict=True)) for row in matrix]
        if depth < len(matrices) - 1:
            layer = [jnp.tanh(value) for value in layer]
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
    matrices = unflatten(weights, hidden)
    dt = 1.0 / steps
    excess = jnp.maximum(1.0, slope_bound(matrices) * dt / LARGEST_SLOPE)
    matrices[-1] = [[weight / excess for weight in row] for row in matrices[-1]]

    shape = jnp.broadcast_shapes(h.shape, weights.shape[1:])

    @jax.checkpoint
    def step(h, _):
        """One step of RK4."""
        # Reverse mode sums what a weight does in the four stages before it sums over the axes that share the weight.
        wide = [[[jnp.broadcast_to(weight, shape) for weight in row] for row in matrix] for matrix in matrices]
        k1 = right_hand_side(h, wide)
        k2 = right_hand_side(h + 0.5 * dt * k1, wide)
        k3 = right_hand_side(h + 0.5 * dt * k2, wide)
        k4 = right_hand_side(h + dt * k3, wide)
        return h + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), None

    return jax.lax.scan(step, h, None, length=steps)[0]
