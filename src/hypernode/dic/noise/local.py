"""Noise of a deforming field from differences along grid lines; the deformation is assumed to be smooth."""

import functools

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls
from scipy.special import ndtr, ndtri

from hypernode.dic.noise.correlation import autocorrelation, best_length, lengths_up_to

#: Fourth difference: zero for displacements up to the third degree, so for strain gradients that vary linearly.
STENCIL = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
_REACH = len(STENCIL) - 1
#: The variance of differences is the sum of the autocovariance at 0 to 4 spacings with these weights.
_LAG_WEIGHTS = np.correlate(STENCIL, STENCIL, "full")[_REACH:] * np.array([1.0, 2.0, 2.0, 2.0, 2.0])
_GAIN = _LAG_WEIGHTS[0]
#: Relative variance of a mean square of n neighbouring differences of white noise, times n.
_SCATTER = 2.0 * float((np.correlate(STENCIL, STENCIL, "full") ** 2).sum()) / _GAIN**2
#: Largest spacing, in lines of the grid: the stencil then spans two thirds of the sheet.
_LINES_A_SPACING = 6
#: Spacings of every grid that is large enough, all of them; larger ones grow by a fifth.
_EVERY_SPACING = 8
_NEXT_SPACING = 1.2
#: Variance of noise is seen to level off, and so is told from a signal, at spacings of three lengths and more.
_SPACINGS_A_LENGTH = 3.0
#: What has details of half the largest spacing, so one and a half times as long as the longest noise, is deformation.
_SPACINGS_A_DETAIL = 2.0
#: Stencils along an axis of 6 x 6 points: fewer have no scale.
_FEWEST = 12
#: Differences beyond this many standard deviations are cut off as those of kinks.
_CUT = 2.5
_KEPT_VARIANCE = 1.0 - 2.0 * _CUT * np.exp(-(_CUT**2) / 2.0) / np.sqrt(2.0 * np.pi) / (2.0 * ndtr(_CUT) - 1.0)
#: Steps of non-negative least squares of seven unknowns, far more than they take.
_MANY = 1000
#: Level of a frame over that of the others, below which deformation took what is noise in it.
_HIDDEN = 0.2
_MAD = 1.0 / ndtri(0.75)


def local_fit(
    displacement: Float[np.ndarray, "frame row column 2"],
    of_length: Float[np.ndarray, " 2"] | None = None,
) -> tuple[Float[np.ndarray, "frame 2"], Float[np.ndarray, " 2"]]:
    """Standard deviation in each frame and correlation length of the noise, from fourth differences along grid lines.

    Let s be the level of the noise and r its autocorrelation. At spacing k the variance of a fourth difference over 70
    is s^2 (70 - 112 r(k) + 56 r(2k) - 16 r(3k) + 2 r(4k)) / 70. Deformation adds a part that grows with the spacing.
    The model is fitted to robust variances at several spacings by their gamma likelihood. Each frame has a noise level,
    and a non-negative contribution of the deformation along each axis. All frames share one correlation length for each
    component.

    Noise smoother than a third of the largest spacing is invisible to this method. This limit is 2.7 steps on 33 to 53
    lines, a twelfth of the lines on fewer, an eighteenth on more. Widely overlapping subsets, lens distortion and
    camera motion cause such noise. If there is no other noise, the level is near 0. Deformation that is rough from
    point to point, such as that of a texture, counts as noise. Correlation lengths of two steps and more are
    overestimated by up to a factor of two if kinks at interfaces exceed the noise.

    Args:
        displacement: of each frame in any unit, NaN where a point was lost.
        of_length: correlation length of each component in grid steps, where it is known.

    Returns:
        Level in the unit of the displacement, NaN for frames with too few points or without any displacement, and
        lengths in grid steps, 0 for white noise.
    """
    level = np.full((len(displacement), 2), np.nan)
    length = np.zeros(2)
    for component in (0, 1):
        seen = {f: _variances(u) for f, u in enumerate(displacement[..., component])}
        seen = {f: table for f, table in seen.items() if len(table)}
        if not seen:
            continue
        widest = max(table[:, 1].max() for table in seen.values())
        tried = lengths_up_to(widest / _SPACINGS_A_LENGTH) if of_length is None else of_length[[component]]
        fits = np.array([[_fit(table, one) for table in seen.values()] for one in tried])
        best = best_length(fits[..., 1].sum(axis=1))
        level[list(seen), component] = fits[best, :, 0]
        length[component] = tried[best]
    return _told(level), length


def _told(level: Float[np.ndarray, "frame 2"]) -> Float[np.ndarray, "frame 2"]:
    """Levels, with that of a frame whose deformation took nearly all of it as those of the others tell.

    The median of the same component's, or of both where that has none; a frame without any error would weigh all.
    """
    usual = np.nanmedian(np.where(level > 0.0, level, np.nan), axis=0) if (level > 0.0).any(axis=0).all() else 0.0
    hidden = ~(level > _HIDDEN * usual)
    told, level = np.where(hidden, np.nan, level), np.where(hidden & np.isfinite(level), 0.0, level)
    if np.isnan(told).all():
        return level
    for component in (0, 1):
        others = told if np.isnan(told[:, component]).all() else told[:, component]
        level[level[:, component] == 0.0, component] = np.nanmedian(others)
    return level


def _variances(u: Float[np.ndarray, "row column"]) -> Float[np.ndarray, "spacing 4"]:
    """Rows of (axis, spacing, robust variance of differences over that for white noise of level 1, their number)."""
    rows = []
    for axis in (0, 1):
        lines = np.moveaxis(u, axis, 0)
        for k in _spacings(len(lines)):
            count = len(lines) - _REACH * k
            difference = sum(w * lines[i * k : i * k + count] for i, w in enumerate(STENCIL))
            known = difference[np.isfinite(difference)]
            if known.size < _FEWEST:
                break
            variance = _robust_variance(known) / _GAIN
            if variance > 0.0:
                rows.append((axis, k, variance, known.size))
    return np.array(rows).reshape(-1, 4)


def _spacings(lines: int) -> list[int]:
    """Spacings along an axis of so many lines."""
    largest = min((lines - 1) // _REACH, max(_EVERY_SPACING, lines // _LINES_A_SPACING))
    spacings = list(range(1, min(largest, _EVERY_SPACING) + 1))
    while spacings and _NEXT_SPACING * spacings[-1] <= largest:
        spacings.append(int(np.ceil(_NEXT_SPACING * spacings[-1])))
    return [k for k in spacings if k <= largest]


def _robust_variance(values: Float[np.ndarray, " value"]) -> float:
    """Variance of the normal distribution amid outliers: from the median of magnitudes on, what lies beyond is cut."""
    square = values**2
    variance = _MAD**2 * float(np.median(square))
    for _ in range(50):
        kept = square[square <= _CUT**2 * variance]
        previous, variance = variance, float(kept.mean()) / _KEPT_VARIANCE if kept.size else 0.0
        if abs(variance - previous) <= 1e-3 * previous:
            break
    return variance


def _variance_of(spacing: Float[np.ndarray, " spacing"], length: float) -> Float[np.ndarray, " spacing"]:
    """Variance of fourth differences of noise of level 1 and a length, over that of white noise."""
    lags = np.arange(len(_LAG_WEIGHTS))[:, None] * spacing
    return _LAG_WEIGHTS @ autocorrelation(lags, length) / _GAIN


def _of_deformation(spacing: Float[np.ndarray, " spacing"]) -> list[Float[np.ndarray, " spacing"]]:
    """What deformation adds to the variances, each up to a factor."""
    relative = spacing / spacing.max()
    # Smooth: the fourth derivative times spacing^4, squared.
    smooth = relative**8
    # Kinks: jumps times the spacing, squared, in a share of the stencils that grows with the spacing.
    kinks = relative**3
    return [smooth, kinks, _variance_of(spacing, spacing.max() / _SPACINGS_A_DETAIL)]


@functools.lru_cache(maxsize=1024)
def _columns(axes: tuple[float, ...], spacings: tuple[float, ...], length: float) -> Float[np.ndarray, "spacing part"]:
    """What noise of a length and deformation add to the variances, each up to a factor: the same for many frames."""
    axis, spacing = np.array(axes), np.array(spacings)
    columns = [_variance_of(spacing, length)]
    for one in np.unique(axis):
        here = axis == one
        # Fewer spacings tell fewer shares apart.
        columns += [here * share for share in _of_deformation(spacing)[: here.sum() - 1]]
    return np.stack(columns, axis=1)


def _fit(table: Float[np.ndarray, "spacing 4"], length: float) -> tuple[float, float]:
    """(level, deviance) of noise of a length and what deformation adds, fitted to the variances of a frame."""
    axis, spacing, variance, count = table.T
    matrix = _columns(tuple(axis), tuple(spacing), float(length))
    model = variance
    for _ in range(4):
        weight = np.sqrt(count) / np.maximum(model, 1e-3 * variance)
        weighted = matrix * weight[:, None]
        size = np.linalg.norm(weighted, axis=0)
        share = nnls(weighted / size, variance * weight, maxiter=_MANY)[0] / size
        model = matrix @ share
    ratio = variance / np.maximum(model, 1e-3 * variance)
    deviance = float((2.0 * count / _SCATTER * (ratio - 1.0 - np.log(ratio))).sum())
    return float(np.sqrt(share[0])), deviance
