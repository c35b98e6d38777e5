"""How well elastic and relaxing sheets explain force records, whatever their zero, their clock, and their preload.

An explanation is a sum of elastic curves with positive factors, the clock's shift, and, where it relaxes, one or two
relaxation times with their share. The evidence is a sum over explanations. Records of one sheet that is pulled at
several paces have the curve and the relaxation in common, and errors of their own.
"""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.optimize import least_squares, nnls

from hypernode.mechanics.record_views import (
    FIT_ITERATIONS,
    SHIFTS,
    Record,
    View,
    noise_of,
    parts_of,
    times_of,
    views_of,
)

#: Share of the relaxed stiffness that relaxes: less than the first changes no force by more than a load cell errs.
SHARES = (0.2, 0.4, 0.8)
#: Standard deviation of the shift of a clock in frames.
SHIFT_SPREAD = 1.5
#: Standard deviation of the share that relaxes in one time, where all of them are free.
FREE_SHARE = 0.4
#: Distance from its bound at which a descent begins.
_INSIDE = 1e-6
#: Share of the largest factor of a curve from which it counts as one of the sheet's.
_COUNTS = 1e-4


class Explanations(NamedTuple):
    """Every explanation, elastic ones and those that relax.

    Attributes:
        likelihood: logarithm of the probability of the record, with that of the shift of its clock.
        prior: logarithm of the share of the elastic, or of the relaxing ones, that each stands for.
        factor: recorded over elastic force, of every record.
        spectrum: share that relaxes in each of the times; nothing where the sheet is elastic.
        shifts: of the clock of every record [s].
        times: relaxation times [s].
    """

    likelihood: Float[np.ndarray, " explanation"]
    prior: Float[np.ndarray, " explanation"]
    factor: Float[np.ndarray, "explanation record sample"]
    spectrum: Float[np.ndarray, "explanation time"]
    shifts: Float[np.ndarray, "explanation record"]
    times: Float[np.ndarray, " time"]

    @property
    def relaxes(self) -> Bool[np.ndarray, " explanation"]:
        """Which relax."""
        return self.spectrum.any(axis=1)

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


def explanations_of(records: Sequence[Record]) -> Explanations:
    """Every explanation of the records of one sheet."""
    times, noises, blocks = times_of(*records), [noise_of(record) for record in records], []
    spectra, prior = _spectra(len(times))
    for frames in itertools.product(SHIFTS, repeat=len(records)):
        shifts = [shift * record.interval for shift, record in zip(frames, records, strict=True)]
        views = views_of(records, noises, shifts, times)
        parts, target = parts_of(views)
        clock = -0.5 * sum((shift / SHIFT_SPREAD) ** 2 for shift in frames)
        matrices = parts[0] + np.tensordot(spectra, parts[1:], 1)
        fits = [nnls(matrix, target, maxiter=FIT_ITERATIONS) for matrix in matrices]
        curves, rest = (np.array(each) for each in zip(*fits, strict=True))
        factor = np.stack([view.factor(curves, spectra) for view in views], axis=1)
        blocks.append((clock - 0.5 * rest**2, prior, factor, spectra, np.tile(shifts, (len(spectra), 1))))
    return Explanations(*(np.concatenate(each) for each in zip(*blocks, strict=True)), times)


def _spectra(count: int) -> tuple[Float[np.ndarray, "explanation time"], Float[np.ndarray, " explanation"]]:
    """(shares that relax in each time, logarithm of the prior): none, and one or two times."""
    units = 0.5 * np.eye(count)
    pairs = [units[a] + units[b] for a, b in itertools.combinations_with_replacement(range(count), 2)]
    spectra = [share * pair for pair in pairs for share in SHARES]
    return np.array([np.zeros(count), *spectra]), np.array([0.0, *(-np.log(len(spectra)) for _ in spectra)])


class Spectrum(NamedTuple):
    """A relaxing explanation in which every time has a share of its own.

    Attributes:
        likelihood: logarithm of the probability of the records, of the shifts of their clocks, and of the shares.
        factor: recorded over elastic force, of every record.
        directions: derivatives of the factor by independent directions of the shares of unit standard deviation.
    """

    likelihood: float
    factor: Float[np.ndarray, "record sample"]
    directions: Float[np.ndarray, "direction record sample"]


def spectra_of(records: Sequence[Record], begin: Explanations) -> list[Spectrum]:
    """Under every shift of the clocks, the most probable explanation once every time has a share of its own.

    One record hardly tells a share. Records of several paces tell it finer than explanations differ.

    Args:
        records: of one sheet.
        begin: :func:`explanations_of` them.
    """
    noises, found = [noise_of(record) for record in records], []
    likelihood, intervals = (begin.likelihood + begin.prior), [record.interval for record in records]
    for shifts in np.unique(begin.shifts, axis=0):
        own = np.flatnonzero((begin.shifts == shifts).all(axis=1) & begin.relaxes)
        views = views_of(records, noises, shifts, begin.times)
        spectrum = _spectrum(views, begin.spectrum[own[np.argmax(likelihood[own])]])
        clock = -0.5 * np.sum((shifts / intervals / SHIFT_SPREAD) ** 2)
        found.append(spectrum._replace(likelihood=spectrum.likelihood + clock))
    return found


def _spectrum(views: list[View], first: Float[np.ndarray, " time"]) -> Spectrum:
    """That of records under one shift of each clock, from a first one on."""
    parts, target = parts_of(views)
    curves, unit = parts.shape[2], np.eye(len(first))
    prior = np.concatenate([np.zeros((len(first), curves)), unit / FREE_SHARE], axis=1)

    def missed(x):
        model = (parts[0] + np.tensordot(x[curves:], parts[1:], 1)) @ x[:curves]
        return np.concatenate([model - target, prior @ x])

    def slope(x):
        by_curve = parts[0] + np.tensordot(x[curves:], parts[1:], 1)
        return np.concatenate([np.concatenate([by_curve, (parts[1:] @ x[:curves]).T], axis=1), prior])

    curve = nnls(parts[0] + np.tensordot(first, parts[1:], 1), target, maxiter=FIT_ITERATIONS)[0]
    best = least_squares(missed, np.concatenate([curve, first]) + _INSIDE, slope, bounds=(0.0, np.inf))
    curve, spectrum = best.x[:curves], best.x[curves:]
    free = np.concatenate([curve > _COUNTS * curve.max(), np.ones(len(first), bool)])
    J = slope(best.x)[:, free]
    variances, ways = np.linalg.eigh(np.linalg.pinv(J.T @ J, hermitian=True)[-len(first) :, -len(first) :])
    by_share = np.stack([[view.factor(curve, each) - 1.0 for view in views] for each in unit])
    directions = np.tensordot(np.sqrt(np.maximum(variances, 0.0))[:, None] * ways.T, by_share, 1)
    return Spectrum(-best.cost, np.stack([view.factor(curve, spectrum) for view in views]), directions)
