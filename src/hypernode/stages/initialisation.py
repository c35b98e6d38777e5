"""Stage 6: a hyper-network that gives the homogenised parameters everywhere."""

import jax.numpy as jnp

from hypernode.config import Method
from hypernode.networks.weights import split_trainable
from hypernode.stages.inverse_problem import InverseProblem
from hypernode.stages.optimisation import minimise

#: Factor on the random kernel of the last layer: small, so that the start is nearly homogeneous,
#: and not zero, so that gradients reach the layers below.
LAST_KERNEL = 0.01


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Set the last layer's bias to the homogenised parameters, then fit what little is left.

    Args:
        files: paths, see :meth:`InverseProblem.load`.
    """
    problem = InverseProblem.load(method, name, files)
    network = problem.new_network(method.seed + 1)
    last = network.layers[-1]
    last.bias[...] = problem.centre
    last.kernel[...] = LAST_KERNEL * last.kernel[...]
    params, apply = split_trainable(network)

    def loss(params, key):
        return jnp.mean((apply(params)(problem.X) - problem.centre) ** 2)

    params, *history = minimise(
        loss, params, method.initialisation, stage="initialisation", case=name, seed=method.seed
    )
    problem.save(output, apply(params), history, "initialised hyper-network", attributes)
