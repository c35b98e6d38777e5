"""The descent of a hyper-network's weights to what explains a test, by damped Gauss-Newton steps."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse.linalg
from jaxtyping import Float

from hypernode.config.methods import Polish
from hypernode.identification.objective import white_residuals
from hypernode.identification.problem import FieldProblem
from hypernode.identification.sensitivities import Jacobian
from hypernode.polishing.objective import LinearObjective, WeightObjective
from hypernode.progress import Progress
from hypernode.verdict import Ending

#: Most iterations of conjugate gradients of a step, and the relative residual at which they end. A step is one of a
#: few; more of them gain more than sharper ones.
CG_ITERATIONS, CG_TOLERANCE = 60, 0.01
#: Fractions of a step that are tried; and damping over the ridge after none of them lowers the cost: the first, the
#: factor from one to the next, and the last.
FRACTIONS = (1.0, 0.4, 0.16)
DAMPING, MOST_DAMPING = 10.0, 1e6


@dataclass(frozen=True)
class Descent:
    """Where a descent of weights ended.

    Attributes:
        weights, states: the weights and their equilibrium in every load step.
        history: displacement misfit over its noise after every step, that of the start first.
        ending: how it ended.
    """

    weights: np.ndarray
    states: list
    history: np.ndarray
    ending: Ending


def descend_weights(objective: WeightObjective, states, settings: Polish, name: str) -> Descent:
    """From the weights of the network before to those of the least cost.

    Args:
        states: equilibrium of every load step at the weights before.
        settings: the method's ``polish`` section, with one iteration at least.
        name: case, for progress.
    """
    problem, ridge = objective.problem, objective.ridge
    weights, damping, ending, history = objective.field.start, 0.0, Ending.OUT_OF_ITERATIONS, []
    misfit = _displacement_misfit(problem, states, None)
    progress = Progress("polishing", name, settings.iterations)
    for _ in range(settings.iterations):
        # Far from the solution the last digit of displacements must not rule.
        at = objective.linearise(weights, states, problem.sigma * max(1.0, misfit))
        history = history or [_displacement_misfit(problem, states, at.linear)]
        cost, found = objective.value(weights, states, at.linear), None
        while found is None and damping <= MOST_DAMPING * ridge:
            found = _line_search(objective, weights, states, at, _step(at, damping), cost)
            if found is None:
                damping = max(DAMPING * damping, DAMPING * ridge)
        if found is None:
            ending = Ending.STAGNATED
            break
        weights, states, after, whole = found
        if whole:
            damping = damping / DAMPING if damping > DAMPING * ridge else 0.0
        misfit = _displacement_misfit(problem, states, at.linear)
        history.append(misfit)
        progress.advance(misfit=misfit, cost=after)
        if cost - after < settings.tolerance * problem.cost_of_noise:
            ending = Ending.CONVERGED
            break
    return Descent(weights, states, np.array(history), ending)


def _displacement_misfit(problem: FieldProblem, states, linear: Jacobian | None) -> float:
    u, _ = white_residuals(problem, states, problem.sigma, linear)
    return float(np.sqrt(np.mean(u**2)))


def _step(at: LinearObjective, damping: float) -> Float[np.ndarray, " weight"]:
    """The change of the weights that the damped quadratic form asks for."""
    shape = (len(at.gradient), len(at.gradient))
    A = scipy.sparse.linalg.LinearOperator(shape, lambda x: at.curvature(x.ravel()) + damping * x.ravel(), dtype=float)
    return scipy.sparse.linalg.cg(A, -at.gradient, rtol=CG_TOLERANCE, maxiter=CG_ITERATIONS)[0]


def _line_search(objective: WeightObjective, weights, states, at: LinearObjective, change, before: float):
    """(weights, states, cost, whether it is all) of the largest fraction of a step that lowers the cost, or None."""
    problem, field = objective.problem, objective.field
    factors = [step.factor for step in at.linear.steps]
    du = at.linear.displacement(field.push(weights, change))
    for fraction in FRACTIONS:
        trial, guesses = weights + fraction * change, []
        for state, d in zip(states, du, strict=True):
            guess = state.u.ravel().copy()
            guess[state.free] += fraction * d
            guesses.append(guess.reshape(-1, 2))
        reached = problem.equilibrium.states(field.params(trial), guesses, factors)
        if reached is not None:
            after = objective.value(trial, reached, at.linear)
            if after < before:
                return trial, reached, after, fraction == FRACTIONS[0]
    return None
