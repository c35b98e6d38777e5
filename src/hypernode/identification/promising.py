"""Which of many changes of labels promise something: their slope and about their curvature, without their columns.

The slope of all changes takes one solve a load step, as the solve of an adjoint does. Their curvature is the mean
square of what random residuals pull at each (Hutchinson, A stochastic estimator of the trace of the influence matrix,
1989). A change that would have to be made to less than a small part promises nothing.
"""

import numpy as np
import scipy.sparse
from jaxtyping import Bool, Float

from hypernode.identification import budgets, numerics, priors
from hypernode.identification.seen_test import SeenTest


def promising(
    test: SeenTest,
    states,
    loads: list[scipy.sparse.csr_matrix],
    dear: Float[np.ndarray, " change"],
    held: Float[np.ndarray, "number number"],
) -> Bool[np.ndarray, " change"]:
    """Which changes promise something, where other numbers of the field follow.

    Args:
        states: equilibrium of every step.
        loads: derivative of the nodal forces by the changes, then by the numbers that follow, by step.
        dear: what changes cost beside what they explain.
        held: inverse covariance of those numbers without data.
    """
    count, sigma = len(dear), test.sigma_of(states)
    shared, random = test.shared(states, sigma), np.random.default_rng(0)
    answers = test.answers(states, [load.tocsc()[:, count:] for load in loads])
    J = [answer.over(sigma) for answer in answers]
    weighed = shared.weighed([np.c_[r, j] for r, j in zip(test.residuals(states, sigma), J, strict=True)])
    # What the numbers explain is taken off.
    columns = [np.c_[w[:, 0], random.standard_normal((len(w), budgets.PROBES))] for w in weighed]
    own = held + sum(j.T @ w[:, 1:] for j, w in zip(J, weighed, strict=True))
    explained = np.linalg.solve(own, sum(j.T @ each for j, each in zip(J, columns, strict=True)))
    left = [each - w[:, 1:] @ explained for each, w in zip(columns, weighed, strict=True)]
    slope, *pulled = test.adjoint(states, [load[:, :count] for load in loads], sigma, left).T
    cost = slope + dear + 0.5 * numerics.PROMISED_PART * np.mean(np.square(pulled), axis=0)
    # What contours may pay for a change: four sides of a cell.
    paid, most = 4.0 * priors.CONTOUR_SIDE, budgets.MOST_CHANGES
    return cost < paid if count <= most else cost < min(paid, np.partition(cost, most)[most])
