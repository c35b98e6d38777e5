"""The deformations of a test; outside them an identified material is extrapolated."""

import numpy as np
from jaxtyping import Float

from hypernode.evaluation.judgement import Judgement


def score_region(F: Float[np.ndarray, "step cell 2 2"]) -> Judgement:
    """Smallest and largest principal stretch over all cells and steps; cells that are not finite are left out."""
    stretches = np.linalg.svd(F[np.isfinite(F).all(axis=(-2, -1))], compute_uv=False)
    return Judgement(
        summary={"smallest_stretch": float(stretches.min()), "largest_stretch": float(stretches.max())},
    )
