"""Force records as one least-squares problem for the elastic curve of a sheet and for what of it relaxes.

Zero, gain, preload, and the rest of the clock are errors of normal size: they belong to the covariance, with the
record's own noise.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.optimize import nnls

from hypernode.mechanics.elastic_curves import elastic_curves

#: Relaxation times, as shares of the record. A faster one is over at once, and a slower one has hardly begun.
TIMES = np.geomspace(0.02, 1.0, 6)
#: Shifts of the clock in frames: forces of a neighbouring frame are a common mistake.
SHIFTS = (-3, -2, -1, 0, 1, 2, 3)
#: Standard deviations of the zero over the largest force, and of the stretch that the reference has already.
ZERO, PRELOAD = 0.1, 0.02
#: Error of the curve between frames over the largest force: the stretch is interpolated there.
RESOLUTION = 3e-4
#: Columns that say less than this share of the first are no part of a smooth record.
_SMALLEST_SINGULAR = 1e-3
#: Iterations that one non-negative fit may take.
FIT_ITERATIONS = 10_000
#: Share of the largest force below which a ratio of forces is not taken.
_NO_FORCE = 1e-3


class Record(NamedTuple):
    """A record at equal steps of time.

    Attributes:
        times: samples [s].
        stretch: mean stretch along the tensile axis.
        force: over the largest, of all records.
        seen: which samples of the force may be used.
        interval: between frames [s].
        gain: uncertainty of all forces by one factor.
    """

    times: Float[np.ndarray, " sample"]
    stretch: Float[np.ndarray, " sample"]
    force: Float[np.ndarray, " sample"]
    seen: Bool[np.ndarray, " sample"]
    interval: float
    gain: float

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


def _columns(record: Record, shift: float, largest: float | None = None):
    """(elastic forces, their derivatives by stretch, the stretch) under a shift of the clock, (sample, curve).

    Args:
        shift: of the record's clock [s].
        largest: stretch at which the forces are 1; left out, that of the record.
    """
    stretch = record.shifted(shift)
    curves = np.stack(list(elastic_curves(stretch, largest or _largest(stretch)).values()), axis=-1)
    return curves[0], curves[1], stretch


def _largest(*stretches) -> float:
    return max(1.0 + 1e-6, *(stretch.max() for stretch in stretches))


def _memories(record: Record, columns, times) -> Float[np.ndarray, "time sample curve"]:
    """What the elastic forces leave after each relaxation time."""
    step = record.times[1] - record.times[0]
    return np.stack([memory(columns.T, step, tau).T for tau in times])


def times_of(*records: Record) -> Float[np.ndarray, " time"]:
    """Relaxation times from the first share of the shortest record to the last of the longest, as far apart [s]."""
    shortest, longest = (pick(record.duration for record in records) for pick in (min, max))
    count = len(TIMES) + int(np.ceil(np.log(longest / shortest) / np.log(TIMES[1] / TIMES[0]) - 1e-9))
    return np.geomspace(TIMES[0] * shortest, TIMES[-1] * longest, count)


def noise_of(record: Record) -> tuple[float, float]:
    """(deviation over the largest force, correlation time [s]) of what no smooth curve of the record explains."""
    library = [_columns(record, shift * record.interval)[0] for shift in SHIFTS]
    library += [*_memories(record, _columns(record, 0.0)[0], times_of(record)), np.ones((len(record.times), 1))]
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


class View(NamedTuple):
    """A record under one shift of its clock.

    Attributes:
        columns: elastic forces (sample, curve).
        memories: what they leave after each relaxation time (time, sample, curve).
        triangle: of columns, memories and the recorded force, whitened: it stands for all samples that are seen.
    """

    columns: Float[np.ndarray, "sample curve"]
    memories: Float[np.ndarray, "time sample curve"]
    triangle: Float[np.ndarray, "row column"]

    def factor(
        self, curve: Float[np.ndarray, "*explanation curve"], spectrum: Float[np.ndarray, "*explanation time"]
    ) -> Float[np.ndarray, "*explanation sample"]:
        """Recorded over elastic force, of one explanation or of many."""
        lasting = curve @ self.columns.T
        left = np.sum(np.moveaxis(spectrum, -1, 0)[..., None] * (curve @ np.swapaxes(self.memories, 1, 2)), axis=0)
        told = lasting > _NO_FORCE * lasting.max(axis=-1, keepdims=True)
        undivided = np.broadcast_to(spectrum.sum(axis=-1, keepdims=True), lasting.shape)
        return 1.0 + np.where(told, left / np.where(told, lasting, 1.0), undivided)


def views_of(
    records: Sequence[Record],
    noises: Sequence[tuple[float, float]],
    shifts: Sequence[float],
    times: Float[np.ndarray, " time"],
) -> list[View]:
    """Records of one sheet under one shift of each clock, with curves that are 1 at one stretch.

    Args:
        records: of the sheet.
        noises: :func:`noise_of` each.
        shifts: of each clock [s].
        times: relaxation times [s].
    """
    largest = _largest(*(record.shifted(shift) for record, shift in zip(records, shifts, strict=True)))
    return [_view(*each, times, largest) for each in zip(records, noises, shifts, strict=True)]


def _view(record: Record, noise: tuple[float, float], shift: float, times, largest: float) -> View:
    columns, slopes, stretch = _columns(record, shift, largest)
    memories = _memories(record, columns, times)
    factors = nnls(columns[record.seen], record.force[record.seen], maxiter=FIT_ITERATIONS)[0]
    white = _whitening(record, stretch, columns @ factors, slopes @ factors, noise)
    matrices = [columns, *memories, record.force[:, None]]
    return View(columns, memories, np.linalg.qr(white @ np.column_stack(matrices)[record.seen], mode="r"))


def parts_of(views: Sequence[View]) -> tuple[Float[np.ndarray, "part row curve"], Float[np.ndarray, " row"]]:
    """(elastic forces, and what they leave after each time; recorded forces) of all views, whitened."""
    triangle = np.vstack([view.triangle for view in views])
    if len(views) > 1:
        triangle = np.linalg.qr(triangle, mode="r")
    curves = views[0].columns.shape[1]
    return np.moveaxis(triangle[:, :-1].reshape(len(triangle), -1, curves), 1, 0), triangle[:, -1]


def _whitening(record: Record, stretch, force, slope, noise: tuple[float, float]):
    """Inverse root of the covariance of the seen samples: noise, curve between frames, zero, clock, preload, gain.

    Args:
        stretch: of every sample.
        force: that an elastic sheet has there.
        slope: derivative of the force by it.
        noise: of :func:`noise_of`.
    """
    level, correlation = noise
    seen, times = record.seen, record.times[record.seen]
    apart = np.abs(times[:, None] - times)
    covariance = level**2 * np.exp(-apart / correlation) + RESOLUTION**2 * np.exp(-apart / record.interval)
    # Between two shifts the clock is anywhere.
    clock = slope * np.gradient(stretch, record.times) * 0.5 * record.interval
    for error in (np.full(len(stretch), ZERO), clock, PRELOAD * slope * stretch, record.gain * force):
        covariance += np.outer(error[seen], error[seen])
    # What rounding leaves of the largest variance, so that readings that are no forces have a factor too.
    least = 1e-10 * max(1.0, float(covariance.diagonal().max()))
    return np.linalg.inv(np.linalg.cholesky(covariance + least * np.eye(len(times))))
