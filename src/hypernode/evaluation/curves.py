"""Stress-stretch curves at one place of each phase."""

import numpy as np
from jaxtyping import Float

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.probes import equibiaxial_stress, uniaxial_stress
from hypernode.material.field import Material
from hypernode.mechanics.loads import tensile_axis

#: Samples along a curve.
CURVE_POINTS = 21

#: What the locations of the curves belong to, in their order.
LOCATIONS = ("matrix", "inclusion")


def curves(
    material: Material, X: Float[np.ndarray, "location 2"], stretches: Float[np.ndarray, " stretch"], kind: str
) -> Float[np.ndarray, "location stretch 2"]:
    """Normal stresses P_xX and P_yY along the stretch of a kind of load; NaN as in :func:`uniaxial_stress`.

    The curve of a location that is NaN is NaN.
    """
    there = np.isfinite(X).all(axis=1)
    drawn = np.full((len(X), len(stretches), 2), np.nan)
    drawn[there] = _curves_at(material, X[there], stretches, kind)
    return drawn


def _curves_at(material, X, stretches, kind):
    """The same where every location is known."""
    axis = tensile_axis(kind)
    if axis is None:
        P = equibiaxial_stress(material, X, stretches)
        found = np.stack([P[..., 0, 0], P[..., 1, 1]], axis=-1)
    else:
        found = uniaxial_stress(material, X, stretches, axis)
    return np.moveaxis(found, 0, 1)


def curve_errors(found: Float[np.ndarray, "stretch 2"], true: Float[np.ndarray, "stretch 2"]) -> tuple[float, float]:
    """(root mean square error over the range of the true curve, R2) of one location."""
    error = np.sqrt(np.mean((found - true) ** 2))
    spread = np.sum((true - true.mean()) ** 2)
    return float(error / np.ptp(true)), float(1.0 - np.sum((found - true) ** 2) / spread)


def score_curves(found: Material, true: Material | None, places, largest: float, kind: str) -> Judgement:
    """Curves up to the ``largest`` stretch at one place of each phase, with their errors if the truth is known."""
    stretch = np.linspace(1.0, largest, CURVE_POINTS)
    identified = curves(found, places, stretch, kind)
    drawn = Judgement({"curve_location": places, "curve_stretch": stretch, "curve_identified": identified})
    if true is None:
        return drawn
    wanted, summary = curves(true, places, stretch, kind), {}
    for index, phase in enumerate(LOCATIONS):
        if np.isnan(places[index]).any():
            continue
        summary[f"curve_nrmse_{phase}"], summary[f"curve_r2_{phase}"] = curve_errors(identified[index], wanted[index])
    return drawn | Judgement({"curve_true": wanted}, summary)
