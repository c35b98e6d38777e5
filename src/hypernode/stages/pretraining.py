"""Stage 7: a heterogeneous material whose stress under the measured deformation is already plausible."""

import jax
import numpy as np

from hypernode.config.methods import Method
from hypernode.training.loop import minimise
from hypernode.training.problem import InverseProblem


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Train P_pred(X_i, t_j) towards its target at every cell.

    The target is P_ave(t_j) (equation ``pre-training1-6``), or the stress of the constrained field.

    Args:
        files: paths, see :meth:`InverseProblem.load`; ``previous`` is the initialised network, if any.
    """
    problem = InverseProblem.load(method, name, files)
    params, apply = problem.trainable()
    cells = len(problem.X)
    count = min(method.pretraining.points or cells, cells)
    # An iteration sees the cells that follow one another, from anywhere on, in an order that is random once and for
    # all: to draw and gather them anew would take a seventh of its time. The order ends as it begins.
    order = np.resize(np.random.default_rng(method.seed).permutation(cells), cells + count)
    target, X = problem.target().ordered(order), problem.X[order]

    def loss(params, key):
        first = jax.random.randint(key, (), 0, cells)
        node_params = apply(params)(jax.lax.dynamic_slice_in_dim(X, first, count)).T
        misfit = target.following(first, count).misfit(problem.node, node_params)
        return misfit + method.prior_weight * problem.node.departure(node_params, problem.centre)

    params, *history = minimise(loss, params, method.pretraining, stage="pre-training", case=name, seed=method.seed)
    problem.save(output, apply(params), history, "pre-trained hyper-network", attributes)
