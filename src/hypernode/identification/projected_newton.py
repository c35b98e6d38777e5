"""Damped Gauss-Newton steps of a few numbers, of which some have bounds (Bertsekas 1982)."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from hypernode.identification import budgets, numerics


def projected_steps(
    x: Float[np.ndarray, " number"],
    gradient: Float[np.ndarray, " number"],
    curvature: Float[np.ndarray, "number number"],
    bounds: Float[np.ndarray, "2 number"],
    floor: Float[np.ndarray, " number"],
    least: int = 0,
) -> Iterator[tuple[np.ndarray, float, int]]:
    """(where a step from ``x`` leads, what it should gain, number of its damping), each more damped than the last.

    A number at a bound that would pass it stays there, and the others go without it. A coefficient at zero has no
    slope below zero, and the step that a linear model asks of it is as long as it is wrong.

    Args:
        bounds: least and largest value of every number, infinite for most.
        floor: added to the diagonal of the curvature, for what data do not tell.
        least: number of the damping of the first step.
    """
    going = np.flatnonzero(np.where(gradient < 0.0, x < bounds[1], x > bounds[0]))
    gradient, curvature = gradient[going], curvature[np.ix_(going, going)]
    fractions = numerics.SEARCH_FACTOR ** np.arange(budgets.CLIPPED_TRIALS)
    for number, damping in list(enumerate(numerics.DAMPING_SHARES))[least:]:
        change = -np.linalg.solve(curvature + np.diag(damping * np.diag(curvature) + floor[going]), gradient)
        within = change * min(1.0, numerics.LARGEST_STEP / np.abs(change).max())
        for fraction in fractions:
            changed = x.copy()
            changed[going] += fraction * within
            yield np.clip(changed, *bounds), -0.5 * float(gradient @ change), number
