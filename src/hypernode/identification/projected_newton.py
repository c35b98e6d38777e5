"""Damped Gauss-Newton steps of a few numbers, of which some have a least value (Bertsekas 1982)."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from hypernode.identification import budgets, numerics


def projected_steps(
    x: Float[np.ndarray, " number"],
    gradient: Float[np.ndarray, " number"],
    curvature: Float[np.ndarray, "number number"],
    lowest: Float[np.ndarray, " number"],
    floor: Float[np.ndarray, " number"],
    least: int = 0,
) -> Iterator[tuple[np.ndarray, float, int]]:
    """(where a step from ``x`` leads, what it should gain, number of its damping), each more damped than the last.

    A number at its least value that would fall stays there, and the others go without it. A coefficient at zero has no
    slope below zero, and the step that a linear model asks of it is as long as it is wrong.

    Args:
        lowest: least value of every number, minus infinity for most.
        floor: added to the diagonal of the curvature, for what data do not tell.
        least: number of the damping of the first step.
    """
    going = np.flatnonzero((x > lowest) | (gradient < 0.0))
    gradient, curvature = gradient[going], curvature[np.ix_(going, going)]
    fractions = numerics.SEARCH_FACTOR ** np.arange(budgets.CLIPPED_TRIALS)
    for number, damping in list(enumerate(numerics.DAMPING_SHARES))[least:]:
        change = -np.linalg.solve(curvature + np.diag(damping * np.diag(curvature) + floor[going]), gradient)
        within = change * min(1.0, numerics.LARGEST_STEP / np.abs(change).max())
        for fraction in fractions:
            changed = x.copy()
            changed[going] += fraction * within
            yield np.maximum(changed, lowest), -0.5 * float(gradient @ change), number
