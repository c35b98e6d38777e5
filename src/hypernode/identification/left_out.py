"""Prediction of the largest load steps from the others: a test of the law outside the fitted range.

A wrong law may follow every step of a test with errors of alternating sign. It fails when it is extrapolated from the
smaller steps to the largest one.

The field is not identified again. The field that some of the data give is near the one that all gave, and follows
from one Newton step (Giordano et al., A Swiss army infinitesimal jackknife, 2019). With whitened residuals w and their
Jacobian J, rows k left out, and H the curvature of the objective without them,

    e = w_k + J_k H^-1 J_k^T w_k   has the covariance   C = I + J_k H^-1 J_k^T

by noise and by how uncertain the field is without these data. A term that only the largest step tells makes one
direction of C very uncertain. So e is split: C^-1 e is what is left once the field follows the step, and that is judged
with all other residuals. The rest is what the field has to change for it. Its square over C is by chance the number of
directions that the step tells, the trace of J_k (H + J_k^T J_k)^-1 J_k^T (docs/decisions/0195).

Of a field of phases the materials follow.
"""

from dataclasses import asdict, dataclass

import numpy as np

from hypernode.fem.gradient import deformation_gradient
from hypernode.identification import budgets, numerics
from hypernode.identification.estimate import Estimate


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """Prediction errors of load steps that were left out.

    Attributes:
        steps: their numbers, the largest one of every load case.
        observed: how many displacements they have.
        directions: how many directions of the field they tell.
        displacement: what the field has to change to follow their displacements, over what is expected, one by chance.
            If the misfit of the other steps exceeds noise, the same excess is expected here.
        deformation: of that change of their displacements, root mean square over the sheet, over the largest of the
            test; None of pictures.
        force: misfit of their forces over what is expected, whose correlation counts; None without forces.
    """

    steps: list[int]
    observed: int
    directions: float
    displacement: float
    deformation: float | None
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
    loading = problem.observations.loading
    steps = largest_steps(loading.load_case, loading.t)
    if found.linear is None or problem.certain or not steps:
        return None
    linear = found.linear
    displacements, forces = objective.residuals(found.states, linear.sigma, linear)
    white = np.concatenate([displacements, forces])
    left = linear.of_steps(steps)
    is_force = np.arange(len(white)) >= len(displacements)
    observed, resultants = np.flatnonzero(left & ~is_force), np.flatnonzero(left & is_force)

    columns = np.zeros((len(white), 1 + len(resultants)))
    columns[left, 0] = white[left]
    columns[resultants, 1 + np.arange(len(resultants))] = 1.0
    change = _followed(found, left, columns)
    error = white + change[:, 0]
    # What the displacements of these steps change, and random signs for how much they tell (Hutchinson's trace).
    columns = np.zeros((len(white), 1 + budgets.SIGNS))
    columns[observed, 0] = error[observed]
    columns[observed, 1:] = np.random.default_rng(0).choice([-1.0, 1.0], (len(observed), budgets.SIGNS))
    told = _followed(found, resultants, columns)[observed]
    directions = max(float(np.mean(np.sum(columns[observed, 1:] * told[:, 1:], axis=0))), 1.0)
    squared = float((error[observed] - told[:, 0]) @ told[:, 0])
    fitted = np.sqrt(np.mean(displacements[~left[: len(displacements)]] ** 2))
    usual = max(problem.observations.scatter, float(fitted))
    force = None
    if len(resultants):
        covariance = change[resultants, 1:]
        covariance = np.eye(len(resultants)) + (covariance + covariance.T) / 2
        force = error[resultants] @ np.linalg.solve(covariance, error[resultants])
        force = float(np.sqrt(force / len(resultants)))
    return LeftOut(
        steps=steps,
        observed=len(observed),
        directions=directions,
        displacement=float(np.sqrt(max(squared, 0.0) / directions)) / usual,
        deformation=_deformation(found, steps, change[observed, 0]),
        force=force,
    )


def _followed(found: Estimate, rows, columns):
    """How residuals answer where some of them pull at the field that all but these rows tell (residual, column)."""
    linear = found.linear

    def curvature(change):
        predicted = linear.product(change)
        predicted[rows] = 0.0
        return linear.adjoint(predicted)

    pulled = linear.adjoint(columns)
    accuracy = numerics.TRACE_TOLERANCE, budgets.SAMPLE_ITERATIONS
    return linear.product(found.answers(curvature).solve_columns(pulled, *accuracy))


def _deformation(found: Estimate, steps: list[int], change) -> float | None:
    """Deformation of a change of the observed displacements of some steps, over the largest of the test."""
    observations, largest = found.problem.observations, []
    if not observations.by_points:
        return None
    boundaries = [observations.boundaries[step] for step in steps]
    parts = np.split(change, np.cumsum([len(boundary.observed) for boundary in boundaries])[:-1])
    for boundary, part in zip(boundaries, parts, strict=True):
        u = np.zeros(observations.grid.nodes.size)
        u[boundary.observed] = found.linear.sigma * boundary.relative * part
        H = deformation_gradient(observations.grid, u.reshape(1, -1, 2))[0] - np.eye(2)
        largest.append(np.sqrt(np.mean(np.sum(H**2, axis=(1, 2)))))
    return float(max(largest) / np.linalg.norm(observations.mean_F - np.eye(2)[:, :, None], axis=(0, 1)).max())
