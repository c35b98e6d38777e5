"""How uncertain a constrained field says it is, and whether the truth lies as far from it as that."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.probes import indicator
from hypernode.material.files import material_of, posterior_material


def sample_spread(samples: Float[np.ndarray, "posterior_sample cell"]) -> Float[np.ndarray, " cell"]:
    """Standard deviation of each cell over the posterior samples."""
    return samples.std(axis=0, ddof=1)


def coverage(error: Float[np.ndarray, " cell"], spread: Float[np.ndarray, " cell"], spreads: float = 2.0) -> float:
    """Share of the cells whose error is within so many standard deviations; 0.954 of a Gaussian are within two."""
    return float(np.mean(np.abs(error) <= spreads * spread))


@dataclass(frozen=True)
class Samples:
    """The indicator of stiffness of a constrained field and of its posterior samples, in the unit of stress."""

    best: Float[np.ndarray, " cell"]
    values: Float[np.ndarray, "posterior_sample cell"]

    @classmethod
    def of(cls, constrained: xr.Dataset, X: Float[np.ndarray, "cell 2"], kind: str, stretch: float) -> "Samples | None":
        """Those of an opened file of a constrained field at the cell centres; None where it has no samples.

        Args:
            kind, stretch: of the load, as in :func:`~hypernode.evaluation.probes.indicator`.
        """
        posterior = posterior_material(constrained)
        if posterior is None:
            return None
        values = indicator(posterior, np.tile(X, (constrained.sizes["posterior_sample"], 1)), kind, stretch)
        return cls(indicator(material_of(constrained), X, kind, stretch), values.reshape(-1, len(X)))

    @property
    def deviations(self) -> Float[np.ndarray, "posterior_sample cell"]:
        """Of the samples from the field, over its median."""
        return (self.values - self.best) / np.nanmedian(self.best)


def score_spread(samples: Samples, true: Float[np.ndarray, " cell"] | None) -> Judgement:
    """Spread of the indicator of stiffness over the posterior samples, and its coverage of the true one."""
    spread = sample_spread(samples.values)
    summary = {"spread": float(np.sqrt(np.mean(spread**2) / np.mean(samples.best**2)))}
    if true is not None:
        summary["within_two_spreads"] = coverage(samples.best - true, spread)
    return Judgement({"trace_P_spread": spread}, summary)
