"""The three trainings of a hyper-network: nearly homogeneous, towards a target, towards equilibrium and forces."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.config.methods import POINTWISE
from hypernode.material.laws import node_stress
from hypernode.progress import say
from hypernode.training.few_materials import learn_few_materials
from hypernode.training.gauss_newton import gauss_newton
from hypernode.training.loop import Fit, minimise
from hypernode.training.losses import LOSSES, variation
from hypernode.training.problem import InverseProblem
from hypernode.training.targets import Target

#: Components of the stress in the plane: misfits are means over them, and the squared gap is a sum.
COMPONENTS = 4.0
#: Gauss-Newton steps of one training at most, and the cells that each sees.
NEARER_STEPS, NEARER_CELLS = 20, 400


def initialise(problem: InverseProblem) -> Fit:
    """Begin with the homogenised parameters as the last layer's bias, then fit what little is left."""
    params, apply = problem.trainable()
    method = problem.method

    def loss(params, key):
        return jnp.mean((apply(params)(problem.X) - problem.centre) ** 2)

    fit = minimise(loss, params, method.initialisation, stage="initialisation", case=problem.name, seed=method.seed)
    return fit.of(apply)


def pretrain(problem: InverseProblem) -> Fit:
    """Train P_pred(X_i, t_j) towards its target at every cell.

    The target is P_ave(t_j) (equation ``pre-training1-6``), or the stress of the constrained field. Of a field of few
    materials the network is made from these (:mod:`hypernode.training.few_materials`), and not by a descent.
    """
    target = problem.target()
    if problem.has_field and problem.method.pretraining.iterations:
        fit = learn_few_materials(problem, target)
        if fit is not None:
            return fit
    return _by_descent(problem, target)


def _by_descent(problem: InverseProblem, every: Target) -> Fit:
    """The hyper-network that stochastic gradients lead to.

    A constrained field is there to be reproduced. Where the network misses it by more than a tolerance, in any load
    step, Gauss-Newton steps go on; then it is trained again from other random weights.
    """
    method, settings = problem.method, problem.method.pretraining
    params, apply = problem.trainable()
    cells = len(problem.X)
    count = min(settings.points or cells, cells)
    # An iteration sees the cells that follow one another, from anywhere on, in an order that is random once and for
    # all: to draw and gather them anew would take a seventh of its time. The order ends as it begins.
    order = np.resize(np.random.default_rng(method.seed).permutation(cells), cells + count)
    target, X = every.of(order), problem.X[order]

    def loss(params, key):
        first = jax.random.randint(key, (), 0, cells)
        node_params = apply(params)(jax.lax.dynamic_slice_in_dim(X, first, count)).T
        misfit = target.following(first, count).misfit(problem.node, node_params)
        return misfit + method.prior_weight * problem.node.departure(node_params, problem.centre)

    def trained(params):
        return minimise(loss, params, settings, stage="pre-training", case=problem.name, seed=method.seed)

    if not problem.has_field or settings.iterations == 0:
        return trained(params).of(apply)
    nearer, tried = _nearer(problem, every, params, apply), []
    while len(tried) < settings.rounds and not (tried and tried[-1][0] <= settings.tolerance):
        fit = trained(problem.other_trainable(len(tried))[0] if tried else params)
        params, missed = nearer(fit.params)
        tried.append((missed, fit._replace(params=params)))
    losses = np.concatenate([fit.losses for _, fit in tried])
    best = min(tried, key=lambda each: each[0])[1]
    return Fit(best.params, losses, np.arange(len(losses))).of(apply)


def _nearer(problem: InverseProblem, every: Target, params, apply):
    """Function of trained parameters: those whose network is nearer the field, and by how much it misses it."""
    settings, cells = problem.method.pretraining, len(problem.X)

    def residual(params, sample):
        return every.of(sample).missed(problem.node, apply(params)(problem.X[sample]).T)

    def errors(params):
        return every.errors(problem.node, apply(params)(problem.X).T)

    solve = gauss_newton(residual, errors, params)

    def nearer(params):
        draw = np.random.default_rng(problem.method.seed)
        count = min(NEARER_CELLS, cells)
        samples = (jnp.asarray(draw.choice(cells, count, replace=False)) for _ in range(NEARER_STEPS))
        params, found = solve(params, samples, settings.tolerance)
        said = f"the network misses its field by {found[-1]:.2%} in its worst load step"
        if len(found) > 1:
            said += f", by {found[0]:.2%} before {len(found) - 1} Gauss-Newton steps"
        say("pre-training", problem.name, said)
        return params, found[-1]

    return nearer


def train(problem: InverseProblem) -> Fit:
    """Train the hyper-network on equilibrium and resultants (equation ``main_loss_function``)."""
    method, settings = problem.method, problem.method.training
    params, apply = problem.trainable()
    physics = LOSSES[settings.equilibrium](problem, settings)
    # Losses at points evaluate the stress there themselves.
    steps = 0 if settings.equilibrium in POINTWISE else problem.F.shape[2]
    F = problem.F[:, :, :steps]
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
        P = node_stress(problem.node, F, node_params) if F.size else F
        total = physics(P[:, :, :steps], network, key)
        if method.prior_weight > 0:
            total += method.prior_weight * problem.node.departure(node_params, problem.centre)
        if settings.variation_weight > 0:
            total += settings.variation_weight * contours(P[:, :, steps:])
        if settings.target_weight > 0:
            total += COMPONENTS * settings.target_weight * misfit(node_params)
        return total

    fit = minimise(loss, params, settings, stage="main training", case=problem.name, seed=method.seed)
    return fit.of(apply)
