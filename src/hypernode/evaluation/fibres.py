"""Whether the identified and the true material are stiffest in the same direction."""

import numpy as np
from jaxtyping import Float

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.probes import SMALLEST_ANISOTROPY, preferred_direction
from hypernode.material.field import Material


def angle_between_axes(a: Float[np.ndarray, " cell"], b: Float[np.ndarray, " cell"]) -> Float[np.ndarray, " cell"]:
    """Angle between two undirected axes, 0 to 90 [degrees]."""
    return np.abs((a - b + 90.0) % 180.0 - 90.0)


def score_fibres(found: Material, true: Material, X: Float[np.ndarray, "cell 2"], stretch: float) -> Judgement:
    """Anisotropy and stiffest direction, and their median errors over the cells whose true material has fibres."""
    anisotropy, angle = preferred_direction(found, X, stretch)
    true_anisotropy, true_angle = preferred_direction(true, X, stretch)
    fields = {
        "anisotropy": anisotropy,
        "fibre_angle": angle,
        "anisotropy_true": true_anisotropy,
        "fibre_angle_true": true_angle,
    }
    fibres = true_anisotropy > SMALLEST_ANISOTROPY
    if not fibres.any():
        return Judgement(fields)
    return Judgement(
        fields,
        {
            "fibre_angle_error": float(np.median(angle_between_axes(angle, true_angle)[fibres])),
            "anisotropy_error": float(np.median(np.abs(anisotropy - true_anisotropy)[fibres])),
        },
    )
