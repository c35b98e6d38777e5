"""What observations tell of one input of a linear model whose errors are normal."""

import numpy as np
from jaxtyping import Float
from scipy.linalg import null_space


def posterior_uncertainty(
    prior: float,
    sensitivity: Float[np.ndarray, " observation"],
    covariance: Float[np.ndarray, "observation observation"],
    free: Float[np.ndarray, "observation coefficient"],
) -> float:
    """Standard uncertainty of an input after observations: that of the normal distribution under a condition,

        u^2 = p^2 (1 - t^T (t t^T + N^T C N)^+ t),   t = p N^T s,   N^T F = 0.

    Args:
        prior: its standard uncertainty p before.
        sensitivity: derivatives s of the observations by it.
        covariance: C of their errors by anything else.
        free: derivatives F by coefficients of which nothing is known: what these change tells nothing.
    """
    rest = null_space(free.T)
    if not rest.shape[1]:
        return prior
    told = prior * rest.T @ sensitivity
    # Observations without errors, or an input that is known, leave directions without variance.
    inverse = np.linalg.pinv(np.outer(told, told) + rest.T @ covariance @ rest, hermitian=True)
    return prior * float(np.sqrt(max(1.0 - told @ inverse @ told, 0.0)))
