"""Relaxation of a sheet under a force record: what of the force is a matter of time, not of stretch.

Quasi-linear viscoelasticity: every stress of the sheet is

    P(t) = P_e(t) + Σ_k g_k ∫ exp(-(t - s)/τ_k) dP_e(s),

so that P is in equilibrium wherever the elastic P_e is. The displacements are those of the elastic sheet. The recorded
force is the elastic one times a factor that depends on time alone.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls
from scipy.signal import lfilter

#: Samples of the record that the fit sees, at equal times.
SAMPLES = 400
#: Relaxation times, as shares of the record. A slower one cannot be told from an elastic sheet.
TIMES = np.geomspace(0.01, 0.2, 10)
#: Iterations that one non-negative fit may take.
FIT_ITERATIONS = 10_000
#: Alternations between the elastic curve and the shares of the relaxation times.
ALTERNATIONS = 30
#: A plainer description is kept as long as its misfit is below this multiple of the fullest one's, or below
#: this share of the largest force, which no load cell resolves.
WORTH_IT, RESOLUTION = 1.5, 1e-3


def _elastic_columns(stretch: Float[np.ndarray, " sample"]) -> dict[str, Float[np.ndarray, " sample"]]:
    """Forces in uniaxial tension of the isotropic energies, up to their factors."""
    first = stretch - stretch**-2
    return {"I1": first, "I1_squared": (stretch**2 + 2.0 / stretch - 3.0) * first, "I2": 1.0 - stretch**-3}


def _memory(elastic: Float[np.ndarray, "*column sample"], step: float, tau: float):
    """∫ exp(-(t - s)/τ) d(elastic) for samples at equal steps of time, linear between them."""
    decay = np.exp(-step / tau)
    return lfilter([(1.0 - decay) * tau / step], [1.0, -decay], np.diff(elastic, prepend=elastic[..., :1]))


@dataclass(frozen=True)
class Relaxation:
    """What a force record says of time.

    Attributes:
        terms: energies of the elastic curve.
        times: samples [s].
        factor: recorded over elastic force at those: 1 + Σ g_k on the first, towards 1 in a hold.
        misfit: root mean square of what is left over, over the largest force.
        steps: times of the load steps, at whose mean pace the sheet counts as elastic (step,).
    """

    terms: tuple[str, ...]
    times: Float[np.ndarray, " sample"]
    factor: Float[np.ndarray, " sample"]
    misfit: float
    steps: Float[np.ndarray, " step"]

    @property
    def pace(self) -> float:
        """Mean of the factor over the steps: the stiffness at the pace of the test over the relaxed one."""
        return float(np.interp(self.steps, self.times, self.factor).mean())

    def at(self, time: Float[np.ndarray, " step"]) -> Float[np.ndarray, " step"]:
        """Recorded force over that of an elastic sheet as stiff as this one is at the pace of the test."""
        if len(self.times) == 1:
            return np.ones(len(time))
        return np.interp(time, self.times, self.factor) / self.pace

    def sampled(self) -> tuple[Float[np.ndarray, " sample"], Float[np.ndarray, " sample"]]:
        """(times, factor) at as many samples whatever the record, so that those of several tests are one array."""
        if len(self.times) == SAMPLES:
            return self.times, self.factor
        return np.linspace(self.times[0], self.times[0] + 1.0, SAMPLES), np.ones(SAMPLES)


#: A sheet of whose record nothing is a matter of time, as far as one can or wants to know.
ELASTIC = Relaxation((), np.zeros(1), np.ones(1), 0.0, np.zeros(1))


def _fit(times, elastic, target, relaxing: bool):
    """(elastic curve, relaxing part) by turns: the curve for given shares, the shares for a given curve."""
    step = times[1] - times[0]
    columns = np.stack(list(elastic.values()), axis=1)
    memories = np.stack([_memory(columns.T, step, share * (times[-1] - times[0])) for share in TIMES])
    shares = np.zeros(len(TIMES))
    for _ in range(ALTERNATIONS if relaxing else 1):
        curve = nnls(columns + np.einsum("k,kcs->sc", shares, memories), target, maxiter=FIT_ITERATIONS)[0]
        if relaxing:
            parts = np.column_stack([columns @ curve, np.einsum("c,kcs->sk", curve, memories)])
            found = nnls(parts, target, maxiter=FIT_ITERATIONS)[0]
            # Without an elastic part there would be nothing to which the shares relate.
            shares = found[1:] / max(found[0], 1e-3 * found.sum(), 1e-300)
    return columns @ curve, np.einsum("k,c,kcs->s", shares, curve, memories)


def fit_relaxation(
    time: Float[np.ndarray, " sample"],
    stretch: Float[np.ndarray, " sample"],
    force: Float[np.ndarray, " sample"],
    steps: Float[np.ndarray, " step"],
) -> Relaxation:
    """The plainest elastic curve and relaxation that explain a record.

    At a constant rate, a curve that flattens may be relaxation or an energy of I2. What decides is how well the
    whole record is followed: elastic without and with I2, then relaxing without and with I2, the first that comes
    near the last.

    Args:
        time: from the reference state on, increasing [s].
        stretch: mean stretch along the tensile axis.
        force: without what the record reads before the sheet pulls [N].
        steps: times of the load steps [s].
    """
    times = np.linspace(time[0], time[-1], SAMPLES)
    target = np.interp(times, time, force)
    columns = _elastic_columns(np.interp(times, time, stretch))
    plain = {key: columns[key] for key in ("I1", "I1_squared")}
    tried = []
    for relaxing in (False, True):
        for elastic in (plain, columns):
            curve, rest = _fit(times, elastic, target, relaxing)
            factor = 1.0 + np.divide(rest, curve, out=np.zeros(SAMPLES), where=curve > 1e-6 * curve.max())
            misfit = np.sqrt(np.mean((curve + rest - target) ** 2)) / np.abs(target).max()
            tried.append(Relaxation(tuple(elastic), times, factor, float(misfit), steps))
    enough = max(WORTH_IT * tried[-1].misfit, RESOLUTION)
    return next((each for each in tried if each.misfit <= enough), tried[-1])
