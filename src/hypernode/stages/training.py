"""Stage 8: the material under which the measured deformation is in equilibrium with the forces."""

from functools import partial

import jax.numpy as jnp

from hypernode.config.methods import Method
from hypernode.material.laws import node_stress
from hypernode.training.loop import minimise
from hypernode.training.losses import LOSSES, variation
from hypernode.training.problem import InverseProblem


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Train the hyper-network on equilibrium and resultants (equation ``main_loss_function``).

    Args:
        files: paths, see :meth:`InverseProblem.load`; ``previous`` is the network of the last stage before, if any.
    """
    problem = InverseProblem.load(method, name, files)
    params, apply = problem.trainable()
    settings = method.training
    physics = LOSSES[settings.equilibrium](problem, settings)
    F, steps = problem.F, problem.F.shape[2]
    if settings.variation_weight > 0:
        mean_F, contours = variation(problem)
        F = jnp.concatenate([F, mean_F], axis=2)
    if settings.target_weight > 0:
        misfit = partial(problem.target().misfit, problem.node)

    def loss(params, key):
        """Equilibrium and forces, and what decides where they do not."""
        network = apply(params)
        node_params = network(problem.X).T
        # All deformations in one go: the neural ODEs are most of what there is to compile.
        P = node_stress(problem.node, F, node_params)
        total = physics(P[:, :, :steps], network, key)
        total += method.prior_weight * problem.node.departure(node_params, problem.centre)
        if settings.variation_weight > 0:
            total += settings.variation_weight * contours(P[:, :, steps:])
        if settings.target_weight > 0:
            # Summed over the components, as the squared gap is.
            total += 4.0 * settings.target_weight * misfit(node_params)
        return total

    params, *history = minimise(loss, params, settings, stage="main training", case=name, seed=method.seed)
    problem.save(output, apply(params), history, "identified material", attributes)
