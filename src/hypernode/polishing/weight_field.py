"""The field of material parameters that a hyper-network makes of its weights, and its derivative."""

import jax
import jax.numpy as jnp
import numpy as np
from flax import nnx
from jax.flatten_util import ravel_pytree
from jaxtyping import Float

from hypernode.networks.weights import split_trainable


class WeightField:
    """Weights of a hyper-network, in one vector and in double precision, and the parameters they give every cell.

    A cell's parameters are those of a :class:`~hypernode.material.node_law.NodeLaw`: the level, which is zero, and what
    the network says at the cell's centre.

    Attributes:
        start: the weights of the network as it is.

    Args:
        network: the hyper-network.
        X: cell centres in its unit (cell, 2).
    """

    def __init__(self, network: nnx.Module, X: Float[np.ndarray, "cell 2"]):
        params, apply = split_trainable(network)
        start, unravel = ravel_pytree(jax.tree.map(lambda each: each.astype(jnp.float64), params))
        points = jnp.asarray(X, jnp.float64)

        def field(weights):
            node_params = apply(unravel(weights))(points)
            return jnp.concatenate([jnp.zeros((len(points), 1)), node_params], axis=1)

        self.start = np.asarray(start)
        self._types, self._unravel, self._apply = params, unravel, apply
        self._field = jax.jit(field)
        self._push = jax.jit(lambda weights, change: jax.jvp(field, (weights,), (change,))[1])
        self._pull = jax.jit(lambda weights, by_params: jax.vjp(field, weights)[1](by_params)[0])

    def params(self, weights: Float[np.ndarray, " weight"]) -> Float[np.ndarray, "cell parameter"]:
        """Parameters of every cell."""
        return np.asarray(self._field(weights))

    def push(self, weights, change: Float[np.ndarray, " weight"]) -> Float[np.ndarray, " cell*parameter"]:
        """First-order change of the parameters, flattened."""
        return np.asarray(self._push(weights, change)).ravel()

    def pull(self, weights, by_params: Float[np.ndarray, " cell*parameter"]) -> Float[np.ndarray, " weight"]:
        """The derivative by the weights of what has the derivative ``by_params`` by the flattened parameters."""
        shape = self._field.eval_shape(weights).shape
        return np.asarray(self._pull(weights, by_params.reshape(shape)))

    def network(self, weights: Float[np.ndarray, " weight"]) -> nnx.Module:
        """The hyper-network with these weights, in the precision in which it is stored."""
        values = self._unravel(jnp.asarray(weights))
        return self._apply(jax.tree.map(lambda value, stored: value.astype(stored.dtype), values, self._types))

    def stored(self, weights: Float[np.ndarray, " weight"]) -> Float[np.ndarray, " weight"]:
        """The weights as they are once they have been stored."""
        precision = {each.dtype for each in jax.tree.leaves(self._types)}
        return np.asarray(weights).astype(precision.pop()).astype(float)
