"""Errors of a stress field against another, weighted by the area of the cells."""

import numpy as np
from jaxtyping import Float


def relative_error(
    found: Float[np.ndarray, "... cell 2 2"],
    true: Float[np.ndarray, "... cell 2 2"],
    weights: Float[np.ndarray, " cell"],
) -> float:
    """Relative L2 difference of two stress fields; NaN if the weighted ``true`` vanishes."""
    w = weights[:, None, None]
    size = np.sum(w * true**2)
    return float(np.sqrt(np.sum(w * (found - true) ** 2) / size)) if size > 0.0 else float("nan")


def contrast(
    found: Float[np.ndarray, "... cell 2 2"],
    true: Float[np.ndarray, "... cell 2 2"],
    weights: Float[np.ndarray, " cell"],
) -> tuple[float, float]:
    """(L2 error over L2 deviation of the truth from its mean, correlation); NaN for a uniform truth."""
    w = (weights / weights.sum())[:, None, None]
    deviation = true - np.sum(true * w, axis=-3, keepdims=True)
    found_deviation = found - np.sum(found * w, axis=-3, keepdims=True)
    spread = np.sum(w * deviation**2)
    if spread <= 1e-12 * np.sum(w * true**2):
        return float("nan"), float("nan")
    error = np.sqrt(np.sum(w * (found - true) ** 2) / spread)
    cross = np.sum(w * deviation * found_deviation)
    return float(error), float(cross / np.sqrt(spread * np.sum(w * found_deviation**2)))
