"""Increasing scalar functions that may stand for dPsi/dI of one term, with their weights from outside.

The neural ODE is the paper's; the others are what the literature uses in its place, on the same terms: the
derivative of an input-convex network (Amos et al. 2017; As'ad et al. 2022) and the sum of powers and
exponentials of a constitutive network (Linka and Kuhl 2023). Every function vanishes at zero. Weights come
first and points last, as in :mod:`hypernode.networks.neural_ode`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from hypernode.networks import neural_ode
from hypernode.networks.terms import POTENTIAL_NAMES

#: Largest argument of an exponential: beyond it the function goes on as a straight line.
LARGEST_EXPONENT = 8.0


@dataclass(frozen=True)
class Potential:
    """One kind of increasing function.

    Attributes:
        weight_count: hidden widths -> number of weights.
        slope: (h, weights[k, ...], hidden widths, RK4 steps) -> value at h, increasing in h.
    """

    weight_count: Callable[[Sequence[int]], int]
    slope: Callable[..., Float[Array, "..."]]


def _convex_count(hidden: Sequence[int]) -> int:
    count, before = 0, 0
    for width in hidden:
        count, before = count + width * (2 + before), width
    return count + before


def _convex_network(h, weights, hidden):
    """Input-convex network: softplus of (any weight) h + bias + (positive weights) times the layer before.

    The output is a positive sum of the last layer: an input or a bias of its own would add to the slope a
    constant, which a term has already, and nothing.
    """
    weight = iter(weights)
    values = []
    for width in hidden:
        totals = [next(weight) * h + next(weight) for _ in range(width)]
        values = [
            jax.nn.softplus(total + sum(jax.nn.softplus(next(weight)) * value for value in values)) for total in totals
        ]
    return sum(jax.nn.softplus(next(weight)) * value for value in values)


def _convex_slope(h, weights, hidden, steps):
    """Derivative of the network at h, less the one at 0."""

    def slope(h):
        return jax.jvp(lambda h: _convex_network(h, weights, hidden), (h,), (jnp.ones_like(h),))[1]

    shape = jnp.broadcast_shapes(h.shape, weights.shape[1:])
    return slope(jnp.broadcast_to(h, shape)) - slope(jnp.zeros(shape, h.dtype))


def _exponential(x):
    """exp(x) - 1, continued by its tangent beyond :data:`LARGEST_EXPONENT`."""
    inside = jnp.minimum(x, LARGEST_EXPONENT)
    return jnp.exp(inside) * (1.0 + jnp.maximum(x - LARGEST_EXPONENT, 0.0)) - 1.0


def _constitutive_slope(h, weights, hidden, steps):
    """Derivative of a sum of h^2, exp(a h) and exp(b h^2) with positive factors, less its value at 0."""
    square, plain, rate, bell, width = (jax.nn.softplus(weights[k]) for k in range(5))
    return square * h + plain * _exponential(rate * h) + bell * h * (1.0 + _exponential(width * h**2))


#: Kinds that a configuration may name, in the order of :data:`~hypernode.networks.terms.POTENTIAL_NAMES`.
POTENTIALS = {
    "node": Potential(neural_ode.weight_count, neural_ode.flow),
    "icnn": Potential(_convex_count, _convex_slope),
    "cann": Potential(lambda hidden: 5, _constitutive_slope),
}
assert tuple(POTENTIALS) == POTENTIAL_NAMES, "the names that the configuration offers are those of the potentials"
