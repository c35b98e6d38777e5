"""How well elastic and relaxing sheets explain a force record, whatever its zero, its clock, and its preload.

An explanation is a sum of elastic curves with positive factors, the clock's shift, and, where it relaxes, one or two
relaxation times with their share. Zero, preload, and the rest of the clock are errors of normal size: they belong to
the covariance, with the record's own noise. The evidence is a sum over explanations.
"""

import itertools
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.optimize import nnls

from hypernode.mechanics.elastic_curves import elastic_curves

#: Relaxation times, as shares of the record. A faster one is over at once, and a slower one has hardly begun.
TIMES = np.geomspace(0.02, 1.0, 6)
#: Share of the relaxed stiffness that relaxes: less than the first changes no force by more than a load cell errs.
SHARES = (0.2, 0.4, 0.8)
#: Shifts of the clock in frames, and their standard deviation: forces of a neighbouring frame are a common mistake.
SHIFTS, SHIFT_SPREAD = (-3, -2, -1, 0, 1, 2, 3), 1.5
#: Standard deviations of the zero over the largest force, and of the stretch that the reference has already.
ZERO, PRELOAD = 0.1, 0.02
#: Error of the curve between frames over the largest force: the stretch is interpolated there.
RESOLUTION = 3e-4
#: Columns that say less than this share of the first are no part of a smooth record.
_SMALLEST_SINGULAR = 1e-3
#: Iterations that one non-negative fit may take.
_FIT_ITERATIONS = 10_000
#: Share of the largest force below which a ratio of forces is not taken.
_NO_FORCE = 1e-3


class Record(NamedTuple):
    """A record at equal steps of time.

    Attributes:
        times: samples [s].
        stretch: mean stretch along the tensile axis.
        force: over the largest.
        seen: which samples of the force may be used.
        interval: between frames [s].
    """

    times: Float[np.ndarray, " sample"]
    stretch: Float[np.ndarray, " sample"]
    force: Float[np.ndarray, " sample"]
    seen: Bool[np.ndarray, " sample"]
    interval: float

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return self.times[-1] - self.times[0]

    def shifted(self, shift: float) -> Float[np.ndarray, " sample"]:
        """Stretch of the sheet at what the record calls a time, if it is late by so much [s]."""
        then = self.times - shift
        pace = max(np.polyfit(self.times[-5:], self.stretch[-5:], 1)[0], 0.0)
        beyond = pace * np.maximum(then - self.times[-1], 0.0)
        return np.maximum(np.interp(then, self.times, self.stretch) + beyond, 1.0)


class Explanations(NamedTuple):
    """Every explanation, elastic ones and those that relax.

    Attributes:
        likelihood: logarithm of the probability of the record, with that of the shift of its clock.
        prior: logarithm of the share of the elastic, or of the relaxing ones, that each stands for.
        factor: recorded over elastic force.
        relaxes: which relax.
    """

    likelihood: Float[np.ndarray, " explanation"]
    prior: Float[np.ndarray, " explanation"]
    factor: Float[np.ndarray, "explanation sample"]
    relaxes: Bool[np.ndarray, " explanation"]

    @property
    def odds(self) -> float:
        """Logarithm of the evidence for relaxation over that against it."""
        each = [np.logaddexp.reduce((self.likelihood + self.prior)[k]) for k in (self.relaxes, ~self.relaxes)]
        return float(each[0] - each[1])

    @property
    def alike(self) -> float:
        """The same of the best explanations: 0 where both follow the record as well."""
        return float(self.likelihood[self.relaxes].max() - self.likelihood[~self.relaxes].max())

    @property
    def weights(self) -> Float[np.ndarray, " relaxing"]:
        """Probability of each that relaxes, if any does."""
        logs = (self.likelihood + self.prior)[self.relaxes]
        return np.exp(logs - np.logaddexp.reduce(logs))


def memory(
    elastic: Float[np.ndarray, "*column sample"], step: float, tau: float
) -> Float[np.ndarray, "*column sample"]:
    """∫ exp(-(t - s)/τ) d(elastic) for samples at equal steps of time, linear between them."""
    decay = np.exp(-step / tau)
    total = (1.0 - decay) * tau / step * np.diff(elastic, prepend=elastic[..., :1])
    # The sum of decay^k over k samples before, of twice as many in each turn.
    back = 1
    while back < total.shape[-1]:
        total[..., back:] += decay**back * total[..., :-back]
        back *= 2
    return total


def _columns(record: Record, shift: float):
    """(elastic forces, their derivatives by stretch, the stretch) under a shift of the clock, (sample, curve)."""
    stretch = record.shifted(shift)
    curves = np.stack(list(elastic_curves(stretch, max(stretch.max(), 1.0 + 1e-6)).values()), axis=-1)
    return curves[0], curves[1], stretch


def _memories(record: Record, columns):
    step = record.times[1] - record.times[0]
    return [memory(columns.T, step, share * record.duration).T for share in TIMES]


def noise_of(record: Record) -> tuple[float, float]:
    """(deviation over the largest force, correlation time [s]) of what no smooth curve of the record explains."""
    library = [_columns(record, shift * record.interval)[0] for shift in SHIFTS]
    library += [*_memories(record, _columns(record, 0.0)[0]), np.ones((len(record.times), 1))]
    matrix = np.column_stack(library)[record.seen]
    norms = np.maximum(np.linalg.norm(matrix, axis=0), np.finfo(float).tiny)
    directions, size, _ = np.linalg.svd(matrix / norms, full_matrices=False)
    directions = directions[:, size > _SMALLEST_SINGULAR * size[0]]
    force = record.force[record.seen]
    rest = force - directions @ (directions.T @ force)
    level = np.sqrt(rest @ rest / max(len(rest) - directions.shape[1], 1))
    alike = (rest[1:] @ rest[:-1]) / max(rest @ rest, np.finfo(float).tiny)
    step = record.times[1] - record.times[0]
    return float(level), float(-step / np.log(np.clip(alike, 1e-6, 0.99)))


def explanations_of(record: Record) -> Explanations:
    """Every explanation of a record, the elastic ones first for each shift of its clock."""
    noise, found = noise_of(record), []
    for shift in SHIFTS:
        found += _of_shift(record, shift, noise)
    likelihood, prior, factor, relaxes = zip(*found, strict=True)
    return Explanations(np.array(likelihood), np.array(prior), np.array(factor), np.array(relaxes))


def _of_shift(record: Record, shift: int, noise: tuple[float, float]):
    """(likelihood, prior, factor, whether it relaxes) of the explanations with one shift."""
    columns, slopes, stretch = _columns(record, shift * record.interval)
    memories = _memories(record, columns)
    force = record.force[record.seen]
    factors = nnls(columns[record.seen], force, maxiter=_FIT_ITERATIONS)[0]
    white = _whitening(record, stretch, slopes @ factors, noise)
    # One triangle stands for all samples.
    matrices = [columns, *memories, record.force[:, None]]
    triangle = np.linalg.qr(white @ np.column_stack(matrices)[record.seen], mode="r")
    *parts, target = np.split(triangle, np.cumsum([columns.shape[1]] * (len(TIMES) + 1)), axis=1)
    clock = -0.5 * (shift / SHIFT_SPREAD) ** 2

    def explained(matrix):
        curve, rest = nnls(matrix, target[:, 0], maxiter=_FIT_ITERATIONS)
        return curve, clock - 0.5 * rest**2

    found = [(explained(parts[0])[1], 0.0, np.ones(len(record.times)), False)]
    pairs = list(itertools.combinations_with_replacement(range(len(TIMES)), 2))
    for (a, b), share in itertools.product(pairs, SHARES):
        curve, likelihood = explained(parts[0] + 0.5 * share * (parts[1 + a] + parts[1 + b]))
        lasting = columns @ curve
        passing = 0.5 * share * (memories[a] + memories[b]) @ curve
        factor = np.full(len(lasting), 1.0 + share)
        told = lasting > _NO_FORCE * lasting.max()
        factor[told] = 1.0 + passing[told] / lasting[told]
        found.append((likelihood, -np.log(len(pairs) * len(SHARES)), factor, True))
    return found


def _whitening(record: Record, stretch, slope, noise: tuple[float, float]):
    """Inverse root of the covariance of the seen samples: noise, curve between frames, zero, clock, preload.

    Args:
        stretch: of every sample.
        slope: derivative of the force by it.
        noise: of :func:`noise_of`.
    """
    level, correlation = noise
    seen, times = record.seen, record.times[record.seen]
    apart = np.abs(times[:, None] - times)
    covariance = level**2 * np.exp(-apart / correlation) + RESOLUTION**2 * np.exp(-apart / record.interval)
    # Between two shifts the clock is anywhere.
    clock = slope * np.gradient(stretch, record.times) * 0.5 * record.interval
    for error in (np.full(len(stretch), ZERO), clock, PRELOAD * slope * stretch):
        covariance += np.outer(error[seen], error[seen])
    # What rounding leaves of the largest variance, so that readings that are no forces have a factor too.
    least = 1e-10 * max(1.0, float(covariance.diagonal().max()))
    return np.linalg.inv(np.linalg.cholesky(covariance + least * np.eye(len(times))))
