"""Stage 7: a heterogeneous material whose stress under the measured deformation is already plausible."""

import jax

from hypernode.config import Method
from hypernode.stages.inverse_problem import InverseProblem
from hypernode.stages.optimisation import minimise


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Train P_pred(X_i, t_j) towards its target at every cell.

    The target is P_ave(t_j) (equation ``pre-training1-6``), or the stress of the constrained field.

    Args:
        files: paths, see :meth:`InverseProblem.load`; ``previous`` is the initialised network.
    """
    problem = InverseProblem.load(method, name, files)
    params, apply = problem.trainable()
    target = problem.target()
    cells = len(problem.X)
    count = min(method.pretraining.points or cells, cells)

    def loss(params, key):
        at = jax.random.choice(key, cells, (count,), replace=False)
        node_params = apply(params)(problem.X[at]).T
        misfit = target.misfit(problem.node, node_params, at)
        return misfit + method.prior_weight * problem.node.departure(node_params, problem.centre)

    params, *history = minimise(loss, params, method.pretraining, stage="pre-training", case=name, seed=method.seed)
    problem.save(output, apply(params), history, "pre-trained hyper-network", attributes)
