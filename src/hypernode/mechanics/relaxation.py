"""Relaxation of a sheet under a force record: what of the force is a matter of time, not of stretch.

Quasi-linear viscoelasticity: every stress of the sheet is

    P(t) = P_e(t) + Σ_k g_k ∫ exp(-(t - s)/τ_k) dP_e(s),

so that P is in equilibrium wherever the elastic P_e is. The displacements are those of the elastic sheet. The recorded
force is the elastic one times a factor that depends on time alone.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from hypernode.mechanics.record_evidence import Record, explanations_of

#: Samples of the record that the fit sees, at equal times.
SAMPLES = 200
#: Logarithm of the odds from which a sheet is said to relax: 20 to 1.
EVIDENCE = 3.0
#: Frames that a record counts as having where nothing tells their interval.
_FRAMES = 25


@dataclass(frozen=True, kw_only=True)
class Relaxation:
    """What a force record says of time.

    Attributes:
        times: samples [s].
        factor: recorded over elastic force at those: 1 + Σ g_k on the first, towards 1 in a hold.
        steps: times of the load steps, at whose mean pace the sheet counts as elastic (step,).
        open: of each step, how far other explanations of the record have :meth:`at` otherwise, root mean square with
            their probability (step,).
        odds: logarithm of the evidence for relaxation over that against it.
    """

    times: Float[np.ndarray, " sample"]
    factor: Float[np.ndarray, " sample"]
    steps: Float[np.ndarray, " step"]
    open: Float[np.ndarray, " step"]
    odds: float

    @property
    def spread(self) -> float:
        """Relative uncertainty of the stiffness: what is open of the steps, root mean square."""
        return float(np.sqrt(np.mean(self.open**2)))

    @property
    def found(self) -> bool:
        """Whether the sheet relaxes."""
        return bool((self.factor != 1.0).any())

    @property
    def pace(self) -> float:
        """Mean of the factor over the steps: the stiffness at the pace of the test over the relaxed one."""
        return float(np.interp(self.steps, self.times, self.factor).mean())

    def at(self, time: Float[np.ndarray, " step"]) -> Float[np.ndarray, " step"]:
        """Recorded force over that of an elastic sheet as stiff as this one is at the pace of the test."""
        if len(self.times) == 1:
            return np.ones(len(time))
        return np.interp(time, self.times, self.factor) / self.pace

    def open_at(self, time: Float[np.ndarray, " step"]) -> Float[np.ndarray, " step"]:
        """Uncertainty of :meth:`at`, which is known at the load steps."""
        return np.zeros(len(time)) if len(self.times) == 1 else np.interp(time, self.steps, self.open)

    def sampled(self) -> tuple[Float[np.ndarray, " sample"], Float[np.ndarray, " sample"]]:
        """(times, factor) at as many samples whatever the record, so that those of several tests are one array."""
        if len(self.times) == SAMPLES:
            return self.times, self.factor
        return np.linspace(self.times[0], self.times[0] + 1.0, SAMPLES), np.ones(SAMPLES)


#: A sheet of whose record nothing is a matter of time, as far as one can or wants to know.
ELASTIC = Relaxation(times=np.zeros(1), factor=np.ones(1), steps=np.zeros(1), open=np.zeros(1), odds=-np.inf)


def fit_relaxation(
    time: Float[np.ndarray, " sample"],
    stretch: Float[np.ndarray, " sample"],
    force: Float[np.ndarray, " sample"],
    steps: Float[np.ndarray, " step"],
    *,
    interval: float | None = None,
    seen: Bool[np.ndarray, " sample"] | None = None,
) -> Relaxation:
    """Whether a record relaxes, how, and how far that is open.

    Elastic and relaxing explanations compete by their evidence. A sheet relaxes from odds of 20 to 1 on, as the most
    probable explanation has it. Below, it counts as elastic. What relaxation would change of it is open then. It weighs
    by the odds, or by how well the best of both follow the record, whichever leaves more.

    Args:
        time: from the reference state on, increasing [s].
        stretch: mean stretch along the tensile axis.
        force: without what the record reads before the sheet pulls [N].
        steps: times of the load steps [s].
        interval: between frames [s]; left out, that of 25 frames.
        seen: samples whose force may be used; left out, all.
    """
    times = np.linspace(time[0], time[-1], SAMPLES)
    at = np.interp(times, time, force)
    told = np.ones(SAMPLES, bool) if seen is None else np.interp(times, time, seen.astype(float)) > 1.0 - 1e-9
    largest = np.abs(at[told]).max(initial=0.0)
    if not largest > 0.0:
        return ELASTIC
    interval = interval or (times[-1] - times[0]) / (_FRAMES - 1)
    course = np.maximum(np.interp(times, time, stretch), 1.0)
    found = explanations_of(Record(times, course, at / largest, told, interval))
    relaxing, weights = found.factor[found.relaxes], found.weights
    relaxes = found.odds > EVIDENCE
    factor = relaxing[np.argmax(weights)] if relaxes else np.ones(SAMPLES)
    chosen = Relaxation(times=times, factor=factor, steps=steps, open=np.zeros(len(steps)), odds=found.odds)
    each = np.array(
        [Relaxation(times=times, factor=other, steps=steps, open=chosen.open, odds=0.0).at(steps) for other in relaxing]
    )
    apart = weights @ (each / chosen.at(steps) - 1.0) ** 2
    odds = found.odds if relaxes else max(found.odds, found.alike)
    chance = 1.0 / (1.0 + np.exp(-odds))
    elastic = (1.0 / chosen.at(steps) - 1.0) ** 2
    return Relaxation(
        times=times,
        factor=factor,
        steps=steps,
        open=np.sqrt(chance * apart + (1.0 - chance) * elastic),
        odds=found.odds,
    )
