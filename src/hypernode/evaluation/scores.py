"""Errors of stress fields and of deformation gradients."""

import numpy as np


def relative_error(found, true, weights) -> float:
    """Relative L2 difference of two stress fields [..., cell, i, J], weighted by cell area."""
    w = weights[:, None, None]
    return float(np.sqrt(np.sum(w * (found - true) ** 2) / np.sum(w * true**2)))


def contrast(found, true, weights) -> tuple[float, float]:
    """(L2 error over L2 deviation of the truth from its mean, correlation) of stress fields."""
    w = (weights / weights.sum())[:, None, None]
    deviation = true - np.sum(true * w, axis=-3, keepdims=True)
    found_deviation = found - np.sum(found * w, axis=-3, keepdims=True)
    spread = np.sum(w * deviation**2)
    if spread <= 1e-12 * np.sum(w * true**2):
        return float("nan"), float("nan")
    error = np.sqrt(np.sum(w * (found - true) ** 2) / spread)
    cross = np.sum(w * deviation * found_deviation)
    return float(error), float(cross / np.sqrt(spread * np.sum(w * found_deviation**2)))


def signal_to_noise(F, F_truth):
    """SNR of each step in decibels, equation ``eq:SNR``: sum |F|^2 over sum of the squared error."""
    axes = (1, 2, 3)
    error = np.sum((F - F_truth) ** 2, axis=axes)
    return 10.0 * np.log10(np.sum(F_truth**2, axis=axes) / np.maximum(error, 1e-300))
