"""Stage 6: a hyper-network that gives the homogenised parameters everywhere."""

import jax.numpy as jnp

from hypernode.config.methods import Method
from hypernode.training.loop import minimise
from hypernode.training.problem import InverseProblem


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Begin with the homogenised parameters as the last layer's bias, then fit what little is left.

    Args:
        files: paths, see :meth:`InverseProblem.load`.
    """
    problem = InverseProblem.load(method, name, files)
    params, apply = problem.trainable()

    def loss(params, key):
        return jnp.mean((apply(params)(problem.X) - problem.centre) ** 2)

    params, *history = minimise(
        loss, params, method.initialisation, stage="initialisation", case=name, seed=method.seed
    )
    problem.save(output, apply(params), history, "initialised hyper-network", attributes)
