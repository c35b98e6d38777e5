"""What observations tell of one input of a linear model whose errors are normal."""

import numpy as np
from jaxtyping import Float

#: Standard deviation of a coefficient of which nothing is known, where observations are relative to their size.
_UNKNOWN = 10.0


def posterior_uncertainty(
    prior: float,
    sensitivity: Float[np.ndarray, " observation"],
    covariance: Float[np.ndarray, "observation observation"],
    free: Float[np.ndarray, "observation coefficient"],
) -> float:
    """Standard uncertainty of an input after observations: that of the normal distribution under a condition,

        u^2 = p^2 - p^4 s^T S^-1 s,   S = p^2 s s^T + C + F F^T w^2.

    Args:
        prior: its standard uncertainty p before.
        sensitivity: derivatives s of the observations, relative to their size.
        covariance: C of their errors by anything else.
        free: derivatives F by coefficients of which nothing is known: w is large.
    """
    s = prior * sensitivity
    total = np.outer(s, s) + covariance + _UNKNOWN**2 * free @ free.T
    told = s @ np.linalg.solve(total, s) if prior > 0.0 else 0.0
    return prior * float(np.sqrt(max(1.0 - told, 0.0)))
