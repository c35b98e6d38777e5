"""Which law a phase follows, its parameters, and how sure they are."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.export.curves import Curves, stacked
from hypernode.export.fitting import Fit, fit, law_components
from hypernode.export.laws import LAWS, ExportedLaw


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A law fitted to a phase.

    Attributes:
        law: which.
        params: its parameters.
        deviation: standard deviation of each: that of refits to the posterior samples, or without them that of the fit.
        misfit: relative root mean square misfit of the stress.
        criterion: Schwarz's (1978), chi^2 + (number of parameters) ln (number of stresses); smaller is better.
    """

    law: ExportedLaw
    params: Float[np.ndarray, " parameter"]
    deviation: Float[np.ndarray, " parameter"]
    misfit: float
    criterion: float


def candidates(curves: list[Curves]) -> list[list[Candidate]]:
    """Every law fitted to every phase, the best of a phase first."""
    by_law = [_fitted(law, curves) for law in LAWS]
    return [sorted(found, key=lambda each: each.criterion) for found in zip(*by_law, strict=True)]


def _fitted(law: ExportedLaw, curves: list[Curves]) -> list[Candidate]:
    """A law fitted to every phase from all its starts, of which the best counts."""
    F, stress, noise, stiffness = stacked(curves)
    starts = [law.starts(each) for each in stiffness]
    phase = np.repeat(np.arange(len(curves)), [len(each) for each in starts])
    found = fit(law, F[phase], stress[phase], noise[phase], np.concatenate(starts), stiffness[phase])
    best = [np.flatnonzero(phase == k)[np.argmin(found.squares[phase == k])] for k in range(len(curves))]
    return [_candidate(law, each, found, index) for each, index in zip(curves, best, strict=True)]


def _candidate(law: ExportedLaw, curves: Curves, found: Fit, index: int) -> Candidate:
    params = found.params[index]
    missed = law_components(law, curves.F, params) - curves.stress
    return Candidate(
        law=law,
        params=_half_turn(law, params),
        deviation=_deviation(curves, found.squares[index], found.jacobian[index, : curves.stress.size]),
        misfit=float(np.linalg.norm(missed) / np.linalg.norm(curves.stress)),
        criterion=float(found.squares[index]) + len(params) * math.log(curves.stress.size),
    )


def _half_turn(law: ExportedLaw, params):
    """The same with the angle of fibres from -90 to 90 degrees: they have no head."""
    turned = params.copy()
    if "fibre_angle" in law.names:
        at = law.names.index("fibre_angle")
        turned[at] = (turned[at] + 90.0) % 180.0 - 90.0
    return turned


def _deviation(curves: Curves, squares: float, jacobian) -> Float[np.ndarray, " parameter"]:
    """Standard deviation of the parameters, to first order."""
    scale = np.linalg.norm(jacobian, axis=0)
    scale[scale == 0.0] = 1.0
    inverse = np.linalg.pinv(jacobian / scale, rcond=np.sqrt(np.finfo(float).eps)) / scale[:, None]
    if len(curves.deviations) > 1:
        return (inverse @ (curves.deviations / curves.noise).reshape(len(curves.deviations), -1).T).std(axis=1, ddof=1)
    freedom = max(len(jacobian) - len(scale), 1)
    return np.sqrt(np.diag(inverse @ inverse.T) * max(1.0, float(squares) / freedom))
