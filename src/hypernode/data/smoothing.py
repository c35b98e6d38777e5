"""Smoothing spline along an edge, with kinks where an interface between materials crosses it.

A curve is the likelier the less it is bent, and a kink is bent without bound. One weight of roughness for a whole edge
then follows a kink too little and the noise elsewhere too much. So a kink that the values show is taken out of the
roughness. Between two points it lies anywhere: two hinges, one at each, make every kink between them. Where an
inclusion crosses the edge there are two of about the same size, of which neither shows alone: they are sought together.
"""

import functools
import math

import numpy as np
import scipy.linalg
import scipy.special
from jaxtyping import Float

#: Bounds of the roughness's weight, over those at which the smoothest and the roughest mode are halved.
WEIGHTS = 1e-4, 1e4
#: Errors of a mode that are below this share of the noise are left out.
SMALLEST_ERROR = 0.1
#: Standard deviations that chance does not reach anywhere along an edge but once in 700 edges.
NEVER = 3.0
#: Fall of minus twice the likelihood within which another place of a kink is as good: two standard deviations squared.
PLACED = 4.0
#: Highest peaks of a lone kink's gain at which one of two is looked for.
PEAKS = 4
#: Places of kinks beyond which no more are looked for.
MOST = 6
#: Weights that are looked at together, and how often again between the neighbours of the likeliest: to a thousandth.
GRID, FINER = 41, 2


def roughness(x: Float[np.ndarray, " point"]) -> Float[np.ndarray, "point point"]:
    """Matrix of the integral of the squared second derivative of the natural cubic spline through values at ``x``.

    Q R^-1 Q^T of Green and Silverman, Nonparametric Regression and Generalized Linear Models (1994), section 2.1.
    """
    h = np.diff(x)
    n = len(x)
    Q, R = np.zeros((n, n - 2)), np.zeros((n - 2, n - 2))
    inner = np.arange(n - 2)
    Q[inner, inner], Q[inner + 1, inner], Q[inner + 2, inner] = 1 / h[:-1], -1 / h[:-1] - 1 / h[1:], 1 / h[1:]
    R[inner, inner] = (h[:-1] + h[1:]) / 3
    R[inner[:-1], inner[1:]] = R[inner[1:], inner[:-1]] = h[1:-1] / 6
    return Q @ scipy.linalg.solve(R, Q.T, assume_a="pos")


@functools.cache
def _modes(x: tuple[float, ...]):
    """(roughness, shape) of the modes of an edge, smoothest first, and hinges at its inner points in the bent modes.

    Every step and component has the same.
    """
    bending, modes = np.linalg.eigh(roughness(np.array(x)))
    # Straight lines are not bent at all.
    bending[:2] = 0.0
    points = np.array(x)
    hinges = np.maximum(points[:, None] - points[None, 1:-1], 0.0) / np.ptp(points)
    return bending, modes, hinges, modes[:, 2:].T @ hinges


def smoothed(x: Float[np.ndarray, " point"], values: Float[np.ndarray, " point"], noise: float):
    """The smoothing spline of noisy values along an edge, with the weight of roughness under which they are likeliest.

    It is the posterior mean, if curves are the likelier the less they are bent (Wahba, Spline Models for Observational
    Data, 1990). Kinks that explain more than chance, anywhere along the edge, bend it freely. ``errors`` are the root
    of the posterior covariance.

    Args:
        x: increasing positions.
        noise: standard deviation of the values.

    Returns:
        (values (point,), errors (point, mode)).
    """
    if noise == 0.0 or len(x) < 3:
        errors = noise * np.eye(len(x))
        return values, errors[:, errors.any(axis=0)]
    return _smoothed(tuple(x), tuple(values), float(noise))


@functools.lru_cache(maxsize=1024)
def _smoothed(x: tuple[float, ...], values: tuple[float, ...], noise: float):
    """The same: an identification asks for every edge again with every mesh and law."""
    bending, modes, hinges, in_modes = _modes(x)
    bent, amounts = bending[2:], modes[:, 2:].T @ np.array(values) / noise
    kinks: list[int] = []
    log_weight, unlikely, gains = _likeliest(bent, amounts, in_modes, kinks)
    while len(kinks) < MOST and gains.size and gains.max() > 0.0:
        more = [*kinks, int(np.argmax(gains))]
        if unlikely - _likeliest(bent, amounts, in_modes, more)[1] >= _limit(len(x), 1):
            kinks = more[:-1] + _places(gains)
        elif (pair := _pair(bent, amounts, in_modes, kinks, gains, unlikely - _limit(len(x), 2))) is not None:
            kinks = [*kinks, *pair]
        else:
            break
        log_weight, unlikely, gains = _likeliest(bent, amounts, in_modes, kinks)
    weight = np.exp(log_weight)
    if not kinks:
        share = 1.0 / (1.0 + weight * bending)
        kept = share > SMALLEST_ERROR**2
        return _kept(modes @ (share * (modes.T @ values)), noise * modes[:, kept] * np.sqrt(share[kept]))
    columns = np.column_stack([modes, hinges[:, _hinges(kinks)]])
    costs = np.concatenate([weight * bending, np.zeros(columns.shape[1] - len(x))])
    covariance = columns @ np.linalg.solve(columns.T @ columns + np.diag(costs), columns.T)
    share, shapes = np.linalg.eigh(covariance)
    kept = share > SMALLEST_ERROR**2
    return _kept(covariance @ values, noise * shapes[:, kept] * np.sqrt(share[kept]))


def _kept(*arrays):
    """The arrays, which nobody may change: they are asked for again."""
    for each in arrays:
        each.flags.writeable = False
    return arrays


def _limit(points: int, kinks: int) -> float:
    """Gain that some kinks together have by chance, anywhere along an edge, once in 700 edges."""
    anywhere = math.comb(max(points - 3, kinks), kinks)
    return float(scipy.special.chdtri(2 * kinks, scipy.special.ndtr(-NEVER) / anywhere))


def _pair(bent, amounts, hinges, kinks: list[int], gains, least: float) -> list[int] | None:
    """Places of two more kinks of which neither shows alone, as where an inclusion crosses the edge; None if none do.

    Args:
        bent, amounts, hinges, kinks: of :func:`_likeliest`.
        gains: of each further kink alone.
        least: minus twice the likelihood that the pair has to reach.
    """
    peaks = np.flatnonzero((gains >= np.append(gains[1:], 0.0)) & (gains >= np.append(0.0, gains[:-1])) & (gains > 0.0))
    found = None
    for first in peaks[np.argsort(-gains[peaks])][:PEAKS]:
        beside = _likeliest(bent, amounts, hinges, [*kinks, int(first)])[2]
        second = int(np.argmax(beside))
        before = _likeliest(bent, amounts, hinges, [*kinks, second])[2]
        pair = [*_places(before), *_places(beside)]
        unlikely = _likeliest(bent, amounts, hinges, [*kinks, int(np.argmax(before)), second])[1]
        if unlikely <= least:
            least, found = unlikely, list(dict.fromkeys(pair))
    return found


def _places(gains: Float[np.ndarray, " place"]) -> list[int]:
    """Where a kink may be: at the best place, and at those beside it that are within two standard deviations."""
    low = high = int(np.argmax(gains))
    least = gains[low] - PLACED
    while low > 0 and gains[low - 1] >= least:
        low -= 1
    while high < len(gains) - 1 and gains[high + 1] >= least:
        high += 1
    return list(range(low, high + 1))


def _hinges(kinks: list[int]) -> list[int]:
    """Numbers of the hinges of kinks, which lie behind the inner point of their number."""
    return sorted({hinge for kink in kinks for hinge in (kink, kink + 1)})


def _likeliest(bent, amounts, hinges, kinks: list[int]):
    """(logarithm of the likeliest weight, minus twice the likelihood there, the most that each further kink gains).

    Args:
        bent: roughness of the bent modes.
        amounts: of these modes in the values, over the noise.
        hinges: the same of a hinge at every inner point.
        kinks: that bend the edge already.
    """
    known = hinges[:, _hinges(kinks)]

    def whitened(log_weights):
        root = np.sqrt(1.0 + 1.0 / (np.exp(log_weights)[:, None] * bent))
        free = np.linalg.qr(known / root[:, :, None])[0]
        rest = (amounts / root)[:, :, None]
        return root, free, (rest - free @ (free.mT @ rest))[:, :, 0]

    def unlikely(log_weights):
        root, _, rest = whitened(log_weights)
        return np.sum(2.0 * np.log(root) + rest**2, axis=1)

    # The likelihood may have more than one peak: the highest on a grid, then its top on finer ones.
    coarse = around = np.linspace(*np.log([WEIGHTS[0] / bent[-1], WEIGHTS[1] / bent[0]]), GRID)
    values = at = unlikely(coarse)
    for _ in range(FINER):
        best = int(np.argmin(at))
        around = np.linspace(around[max(best - 1, 0)], around[min(best + 1, GRID - 1)], GRID)
        at = unlikely(around)
    best = int(np.argmin(at))
    # A kink allows a larger weight: its gain is over the likeliest without it.
    each = zip(values[::4], *whitened(coarse[::4]), strict=True)
    gains = np.max([values.min() - value + _gains(hinges, *white) for value, *white in each], axis=0)
    gains[kinks] = 0.0
    return around[best], float(at[best]), gains


def _gains(hinges, root, free, rest):
    """By how much the squares of the rest fall where hinges at two neighbouring points join."""
    white = hinges / root[:, None]
    white = white - free @ (free.T @ white)
    load, square = white.T @ rest, (white**2).sum(axis=0)
    a, b, c = square[:-1], (white[:, :-1] * white[:, 1:]).sum(axis=0), square[1:]
    determinant = a * c - b**2
    p, q = load[:-1], load[1:]
    gain = c * p**2 - 2.0 * b * p * q + a * q**2
    told = determinant > 1e-9 * np.maximum(a * c, np.finfo(float).tiny)
    return np.divide(gain, determinant, out=np.zeros_like(gain), where=told)
