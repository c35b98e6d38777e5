"""Stage 7: a heterogeneous material under which the measured deformation has a uniform stress."""

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.config import Method
from hypernode.material import node_stress
from hypernode.stages.inverse_problem import InverseProblem
from hypernode.stages.optimisation import minimise


def run(method: Method, name: str, parents: list[str], output: str, attributes: dict) -> None:
    """Train P_pred(X_i, t_j) towards P_ave(t_j) at every cell (equation ``pre-training1-6``).

    Args:
        parents: measurement, interpolant, homogenised and initialised files.
    """
    problem = InverseProblem.load(method, name, *parents[:3])
    params, apply = problem.trainable(parents[3])
    target = jnp.asarray(np.moveaxis(problem.loading.P_average, 0, -1)[..., None], jnp.float32)
    known = jnp.asarray(problem.loading.target_weight, jnp.float32)
    cells = len(problem.X)
    count = min(method.pretraining.points or cells, cells)

    def loss(params, key):
        at = jax.random.choice(key, cells, (count,), replace=False)
        node_params = apply(params)(problem.X[at]).T
        P = node_stress(problem.node, problem.F[..., at], node_params)
        misfit = jnp.mean(known * ((P - target) / problem.scale[:, None]) ** 2)
        return misfit + method.prior_weight * problem.node.departure(node_params, problem.centre)

    params, *history = minimise(loss, params, method.pretraining, stage="pre-training", case=name, seed=method.seed)
    problem.save(output, apply(params), history, "uniform-stress hyper-network", attributes, parents)
