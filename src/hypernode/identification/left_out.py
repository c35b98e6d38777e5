"""Prediction of the largest load steps from the others: a test of the law outside the fitted range.

A wrong law may follow every step of a test with errors of alternating sign. It fails when it is extrapolated from the
smaller steps to the largest one.

The field is not identified again. The field that some of the data give is near the one that all gave, and follows
from one Newton step (Giordano et al., A Swiss army infinitesimal jackknife, 2019). With whitened residuals w and their
Jacobian J, rows k left out, and H the curvature of the objective without them,

    w_k + J_k H^-1 J_k^T w_k   has the covariance   I + J_k H^-1 J_k^T

by noise and by how uncertain the field is without these data. Of a field of phases the materials follow.
"""

from dataclasses import asdict, dataclass

import numpy as np

from hypernode.identification.estimate import Estimate


@dataclass(frozen=True)
class LeftOut:
    """Prediction errors of load steps that were left out.

    Attributes:
        steps: their numbers, the largest one of every load case.
        observed: how many displacements they have.
        displacement: root mean square error of their displacements over what is expected of it, one by chance. If the
            misfit of the other steps exceeds noise, the same excess is expected here.
        force: the same of their forces, whose correlation counts; None without forces.
    """

    steps: list[int]
    observed: int
    displacement: float
    force: float | None

    def stored(self) -> dict:
        """As attributes of a file hold it."""
        return asdict(self)


def largest_steps(load_case, size) -> list[int]:
    """The largest step of every load case that has more than one.

    Args:
        load_case: load case of every step (step,).
        size: load of every step (step,).
    """
    steps = [np.flatnonzero(load_case == case) for case in np.unique(load_case)]
    return [int(each[np.argmax(size[each])]) for each in steps if len(each) > 1]


def predict_left_out(found: Estimate) -> LeftOut | None:
    """Predict the largest step of every load case from all others.

    None where a test has one step a load case, or nothing in it is left to chance.
    """
    problem, objective = found.problem, found.objective
    loading, strategy = problem.observations.loading, problem.strategy
    steps = largest_steps(loading.load_case, loading.t)
    if found.linear is None or problem.certain or not steps:
        return None
    linear = found.linear
    displacements, forces = objective.residuals(found.states, linear.sigma, linear)
    white = np.concatenate([displacements, forces])
    left = linear.of_steps(steps)
    is_force = np.arange(len(white)) >= len(displacements)
    observed, resultants = np.flatnonzero(left & ~is_force), np.flatnonzero(left & is_force)

    def curvature(change):
        predicted = linear.product(change)
        predicted[left] = 0.0
        return linear.adjoint(predicted)

    columns = np.zeros((len(white), 2 + len(resultants)))
    columns[left, 0] = white[left]
    # The trace of what displacements add to their own variance, from one vector of random signs (Hutchinson).
    columns[observed, 1] = np.random.default_rng(0).choice([-1.0, 1.0], len(observed))
    columns[resultants, 2 + np.arange(len(resultants))] = 1.0
    solved = found.answers(curvature).solve_columns(
        linear.adjoint(columns), strategy.trace_tolerance, strategy.sample_iterations
    )
    change = linear.product(solved)
    error = white + change[:, 0]
    added = float(columns[:, 1] @ change[:, 1])
    fitted = np.sqrt(np.mean(displacements[~left[: len(displacements)]] ** 2))
    usual = max(problem.observations.scatter, float(fitted))
    expected = usual**2 * len(observed) + max(added, 0.0)
    force = None
    if len(resultants):
        covariance = change[resultants, 2:]
        covariance = np.eye(len(resultants)) + (covariance + covariance.T) / 2
        squared = error[resultants] @ np.linalg.solve(covariance, error[resultants])
        force = float(np.sqrt(squared / len(resultants)))
    misfit = float(np.sqrt(np.sum(error[observed] ** 2) / expected))
    return LeftOut(steps, len(observed), misfit, force)
