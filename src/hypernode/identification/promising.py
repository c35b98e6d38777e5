"""Which of many changes of labels promise something: their slope and about their curvature, without their columns.

The slope of all changes takes one solve a load step, as the solve of an adjoint does. Their curvature is the mean
square of what random residuals pull at each (Hutchinson, A stochastic estimator of the trace of the influence matrix,
1989). A change that would have to be made to less than a small part promises nothing.
"""

import numpy as np
import scipy.sparse
from jaxtyping import Bool, Float

from hypernode.identification.seen_test import SeenTest

#: Random residuals, by which curvatures are known to a fifth.
PROBES = 64
#: Part of a change up to which it promises nothing, were it real.
LEAST_PART = 0.1
#: What contours may pay for a change: four sides of a cell.
PAID = 4.0 * float(np.log(2.0))


def promising(
    test: SeenTest,
    states,
    loads: list[scipy.sparse.csr_matrix],
    dear: Float[np.ndarray, " change"],
    held: Float[np.ndarray, " number"],
) -> Bool[np.ndarray, " change"]:
    """Which changes promise something, where the materials follow.

    Args:
        states: equilibrium of every step.
        loads: derivative of the nodal forces by the changes, then by the numbers of the materials, by step.
        dear: what changes cost beside what they explain.
        held: inverse variance of the numbers of the materials without data.
    """
    count, sigma = len(dear), test.sigma_of(states)
    shared, random = test.shared(states, sigma), np.random.default_rng(0)
    materials = test.answers(states, [load.tocsc()[:, count:] for load in loads])
    each = zip(test.residuals(states, sigma), materials, strict=True)
    known = shared.weighed([np.c_[r, answer.over(sigma)] for r, answer in each])
    columns = [np.c_[each, random.standard_normal((len(each), PROBES))] for each in known]
    pulled = test.adjoint(states, loads, sigma, columns)
    slope, across, probes = np.split(pulled, [1, 1 + len(held)], axis=1)
    own = across[count:] + np.diag(held)
    follow = np.linalg.solve(own, np.c_[across[:count].T, slope[count:]])
    slope = slope[:count, 0] - across[:count] @ follow[:, -1]
    curvature = (probes[:count] ** 2).mean(axis=1) - np.einsum("cn,nc->c", across[:count], follow[:, :-1])
    return slope + dear + 0.5 * LEAST_PART * np.maximum(curvature, 0.0) < PAID
