"""Damped Gauss-Newton steps of a few numbers, of which some have a least value (Bertsekas 1982)."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from hypernode.identification.settings import Strategy


def projected_steps(
    x: Float[np.ndarray, " number"],
    gradient: Float[np.ndarray, " number"],
    curvature: Float[np.ndarray, "number number"],
    lowest: Float[np.ndarray, " number"],
    floor: Float[np.ndarray, " number"],
    strategy: Strategy,
) -> Iterator[tuple[np.ndarray, float]]:
    """Where steps from ``x`` lead, from the whole one to shorter and more damped ones, and what each should gain.

    A number at its least value that would fall stays there, and the others go without it: coefficients that are none
    have no slope below zero, and the step that a linear model asks of them is as long as it is wrong.

    Args:
        lowest: least value of every number, minus infinity for most.
        floor: added to the diagonal of the curvature, for what data do not tell.
    """
    going = np.flatnonzero((x > lowest) | (gradient < 0.0))
    gradient, curvature = gradient[going], curvature[np.ix_(going, going)]
    fractions = strategy.fraction ** np.arange(strategy.clipped_trials)
    for damping in strategy.phase_damping:
        change = -np.linalg.solve(curvature + np.diag(damping * np.diag(curvature) + floor[going]), gradient)
        within = change * min(1.0, strategy.largest_step / np.abs(change).max())
        for fraction in fractions:
            changed = x.copy()
            changed[going] += fraction * within
            yield np.maximum(changed, lowest), -0.5 * float(gradient @ change)
