"""Signal-to-noise ratio of deformation gradients."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from hypernode.evaluation.judgement import Judgement

#: Signal-to-noise ratio [dB] beyond which there is no noise to speak of.
EXACT = 200.0


def signal_to_noise(
    F: Float[np.ndarray, "step cell 2 2"], F_truth: Float[np.ndarray, "step cell 2 2"]
) -> Float[np.ndarray, " step"]:
    """SNR of each step in decibels, equation ``eq:SNR``: sum |F|^2 over sum of the squared error."""
    axes = (1, 2, 3)
    error = np.sum((F - F_truth) ** 2, axis=axes)
    return 10.0 * np.log10(np.sum(F_truth**2, axis=axes) / np.maximum(error, 1e-300))


def score_noise(fields: Mapping[str, Float[np.ndarray, "step cell 2 2"]], F_truth) -> Judgement:
    """Signal-to-noise ratio of each named deformation gradient, averaged over the steps with noise."""
    ratios = {f"snr_{label}": signal_to_noise(F, F_truth) for label, F in fields.items()}
    return Judgement(ratios, {key: float(ratio.mean()) for key, ratio in ratios.items() if ratio.max() < EXACT})
