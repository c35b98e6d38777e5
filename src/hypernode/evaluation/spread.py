"""How uncertain a constrained field says it is, and whether the truth lies as far from it as that."""

import numpy as np
from jaxtyping import Float

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.probes import indicator
from hypernode.material.field import Material


def sample_spread(samples: Float[np.ndarray, "posterior_sample cell"]) -> Float[np.ndarray, " cell"]:
    """Standard deviation of each cell over the posterior samples."""
    return samples.std(axis=0, ddof=1)


def coverage(error: Float[np.ndarray, " cell"], spread: Float[np.ndarray, " cell"], spreads: float = 2.0) -> float:
    """Share of the cells whose error is within so many standard deviations; 0.954 of a Gaussian are within two."""
    return float(np.mean(np.abs(error) <= spreads * spread))


def score_spread(
    posterior: Material, samples: int, best: Material, X: Float[np.ndarray, "cell 2"], kind: str, stretch: float, true
) -> Judgement:
    """Spread of the indicator of stiffness over the posterior samples, and its coverage of the truth.

    Args:
        posterior: all samples as one material, positions once for each.
        samples: how many they are.
        best: the constrained field itself.
        X: cell centres.
        kind, stretch: of the load, as in :func:`~hypernode.evaluation.probes.indicator`.
        true: the true material, or None.
    """
    values = indicator(posterior, np.tile(X, (samples, 1)), kind, stretch)
    spread = sample_spread(values.reshape(-1, len(X)))
    middle = indicator(best, X, kind, stretch)
    summary = {"spread": float(np.sqrt(np.mean(spread**2) / np.mean(middle**2)))}
    if true is not None:
        summary["within_two_spreads"] = coverage(middle - indicator(true, X, kind, stretch), spread)
    return Judgement({"trace_P_spread": spread}, summary)
