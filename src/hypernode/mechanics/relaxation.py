"""Relaxation of a sheet under a force record: what of the force is a matter of time, not of stretch.

Quasi-linear viscoelasticity: every stress of the sheet is

    P(t) = P_e(t) + Σ_k g_k ∫ exp(-(t - s)/τ_k) dP_e(s),

so that P is in equilibrium wherever the elastic P_e is. The displacements are those of the elastic sheet. The recorded
force is the elastic one times a factor that depends on time alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from hypernode.mechanics.record_evidence import explanations_of, spectra_of
from hypernode.mechanics.record_views import Record

#: Samples of the record that the fit sees, at equal times.
SAMPLES = 200
#: Logarithm of the odds from which a sheet is said to relax: 20 to 1.
EVIDENCE = 3.0
#: Frames that a record counts as having where nothing tells their interval.
_FRAMES = 25


@dataclass(frozen=True, kw_only=True)
class Course:
    """A force record over the stretch of its test.

    Attributes:
        time: from the reference state on, increasing [s].
        stretch: mean stretch along the tensile axis.
        force: without what the record reads before the sheet pulls [N].
        steps: times of the load steps [s].
        interval: between frames [s]; left out, that of 25 frames.
        seen: samples whose force may be used; left out, all.
        gain: relative uncertainty of all of its forces together.
    """

    time: Float[np.ndarray, " sample"]
    stretch: Float[np.ndarray, " sample"]
    force: Float[np.ndarray, " sample"]
    steps: Float[np.ndarray, " step"]
    interval: float | None = None
    seen: Bool[np.ndarray, " sample"] | None = None
    gain: float = 0.0

    @property
    def pace(self) -> float:
        """Mean rate of the stretch [1/s]."""
        return float((self.stretch[-1] - self.stretch[0]) / (self.time[-1] - self.time[0]))

    @property
    def sampled(self) -> Record:
        """The record at equal times, with its forces in N."""
        times = np.linspace(self.time[0], self.time[-1], SAMPLES)
        told = np.ones(SAMPLES, bool)
        if self.seen is not None:
            told = np.interp(times, self.time, self.seen.astype(float)) > 1.0 - 1e-9
        return Record(
            times=times,
            stretch=np.maximum(np.interp(times, self.time, self.stretch), 1.0),
            force=np.interp(times, self.time, self.force),
            seen=told,
            interval=self.interval or (times[-1] - times[0]) / (_FRAMES - 1),
            gain=self.gain,
        )


@dataclass(frozen=True, kw_only=True)
class Relaxation:
    """What a force record says of time.

    Attributes:
        times: samples [s].
        factor: recorded over elastic force at those: 1 + Σ g_k on the first, towards 1 in a hold.
        steps: times of the load steps (step,).
        pace: stiffness of which :meth:`at` is 1, over the relaxed one: the mean of the factor over the load steps, of
            all records that were judged together.
        open: of each step, how far other explanations of the record have :meth:`at` otherwise, root mean square with
            their probability (step,).
        odds: logarithm of the evidence for relaxation over that against it.
    """

    times: Float[np.ndarray, " sample"]
    factor: Float[np.ndarray, " sample"]
    steps: Float[np.ndarray, " step"]
    pace: float
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
ELASTIC = Relaxation(times=np.zeros(1), factor=np.ones(1), steps=np.zeros(1), pace=1.0, open=np.zeros(1), odds=-np.inf)


def fit_relaxation(courses: Sequence[Course]) -> list[Relaxation]:
    """Whether a sheet relaxes, how, and how far that is open: of each of its records.

    Elastic and relaxing explanations compete by their evidence. A sheet relaxes from odds of 20 to 1 on, as the most
    probable explanation has it. Below, it counts as elastic. What relaxation would change of it is open then. It weighs
    by the odds, or by how well the best of both follow the record, whichever leaves more.

    Several records are those of one sheet under one load. They have the elastic curve and the relaxation in common, so
    that forces of equal stretch at another pace tell time from elasticity.
    """
    records = [course.sampled for course in courses]
    largest = [np.abs(record.force[record.seen]).max(initial=0.0) for record in records]
    if not min(largest) > 0.0:
        return [ELASTIC] * len(courses)
    records = [record._replace(force=record.force / max(largest)) for record in records]
    found = explanations_of(records)
    relaxing, weights = found.factor[found.relaxes], found.weights
    relaxes = found.odds > EVIDENCE
    factors, directions = np.ones(relaxing.shape[1:]), np.zeros((0, *relaxing.shape[1:]))
    if relaxes and len(records) > 1:
        spectra = spectra_of(records, found)
        likelihood = np.array([each.likelihood for each in spectra])
        relaxing, weights = np.stack([each.factor for each in spectra]), np.exp(likelihood - likelihood.max())
        weights, directions = weights / weights.sum(), spectra[np.argmax(weights)].directions
    if relaxes:
        factors = relaxing[np.argmax(weights)]

    def of_steps(factors) -> Float[np.ndarray, " step"]:
        each = zip(courses, records, factors, strict=True)
        return np.concatenate([np.interp(course.steps, record.times, factor) for course, record, factor in each])

    chosen, others = of_steps(factors), np.array([of_steps(each) for each in relaxing])
    pace = float(chosen.mean())
    moved = [of_steps(factors + each) for each in directions]
    chosen, others = chosen / pace, others / others.mean(axis=1, keepdims=True)
    apart = weights @ (others / chosen - 1.0) ** 2 + sum((each / each.mean() / chosen - 1.0) ** 2 for each in moved)
    odds = found.odds if relaxes else max(found.odds, found.alike)
    chance = 0.5 * (1.0 + np.tanh(0.5 * odds))
    opened = np.sqrt(chance * apart + (1.0 - chance) * (1.0 / chosen - 1.0) ** 2)
    parts = np.split(opened, np.cumsum([len(course.steps) for course in courses])[:-1])
    return [
        Relaxation(times=record.times, factor=factor, steps=course.steps, pace=pace, open=part, odds=found.odds)
        for record, factor, course, part in zip(records, factors, courses, parts, strict=True)
    ]
