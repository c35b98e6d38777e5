"""Noise of frames of a sheet at rest: the displacement without the common motion of all points."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from hypernode.dic.noise.correlation import autocorrelation, best_length, independent_factor, lengths_up_to

#: Mean strain of a sheet at rest over its own uncertainty: chance exceeds it in two frames of ten thousand.
_NO_STRAIN = 4.0
#: Standard deviation without rigid motion and mean gradient, over the level of the same frame's fine noise: what is
#: larger is a deformation that varies over the sheet.
_NO_SHAPE = 1.5
#: Points that a mean gradient is taken from: fewer than 6 x 6 leave little but it.
_FEWEST = 36


def frames_at_rest(
    displacement: Float[np.ndarray, "frame row column 2"],
    level: Float[np.ndarray, "frame 2"],
    length: Float[np.ndarray, " 2"],
) -> list[int]:
    """Frames before the sheet moves, from the first on; frames without any displacement are skipped.

    A sheet is at rest if two conditions hold. Its mean strain is less than four standard uncertainties. Without the
    mean displacement gradient, its displacement scatters at most 1.5 times as much as fine noise. Translations and
    small rotations are allowed, since strain is the symmetric part of the gradient. A rotation whose square is a
    visible strain counts as motion. So does every rotation of a grid whose steps along x and y differ.

    Args:
        displacement: of each frame in any unit, NaN where a point was lost.
        level: of its fine noise, from the differences of the same frames, NaN for a frame without an estimate.
        length: correlation length of the noise of each component, in grid steps.
    """
    factor = np.array([independent_factor(one) for one in length])
    at_rest = []
    for frame, u in enumerate(displacement):
        if not np.isfinite(level[frame]).all():
            if np.nan_to_num(u).any():
                break
            continue
        if not _rests(u, level[frame], factor):
            break
        at_rest.append(frame)
    return at_rest


def static_fit(
    displacement: Float[np.ndarray, "frame row column 2"], frames: Sequence[int]
) -> tuple[Float[np.ndarray, "static 2"], Float[np.ndarray, " 2"]]:
    """Standard deviation of each static frame without rigid motion and mean gradient, and correlation lengths.

    A Gaussian autocorrelation is fitted to the one of all frames along rows and columns, at lags up to a quarter of the
    shorter side.

    Args:
        displacement: of each frame in any unit, NaN where a point was lost.
        frames: static frames, each of at least 36 known points and not zero throughout.

    Returns:
        Level in the unit of the displacement, and lengths in grid steps, 0 for white noise.
    """
    rests = np.stack([without_affine(displacement[f])[0] for f in frames])
    level = np.stack([_deviation(rest) for rest in rests])
    relative = rests / level[:, None, None, :]
    lags = np.arange(1, max(1, min(rests.shape[1:3]) // 4) + 1)
    length = np.zeros(2)
    for component in (0, 1):
        seen, pairs = _correlations(relative[..., component], lags)
        tried = lengths_up_to(lags[-1] / 2.0)
        # Correlations of white noise scatter by one over the root of the number of pairs.
        misfit = np.array([(pairs * (seen - autocorrelation(lags, one)) ** 2).sum() for one in tried])
        length[component] = tried[best_length(misfit)]
    return level, length


def says_something(u: Float[np.ndarray, "row column 2"]) -> bool:
    """Whether a static frame has enough points and at least one displacement other than zero."""
    known = np.isfinite(u).all(axis=-1)
    return bool(known.sum() >= _FEWEST and (np.ptp(u[known], axis=0) > 0.0).all())


def without_affine(
    u: Float[np.ndarray, "row column 2"],
) -> tuple[Float[np.ndarray, "row column 2"], Float[np.ndarray, "2 2"], Float[np.ndarray, " 2"]]:
    """A displacement without its mean and its mean gradient.

    Returns:
        The residual, NaN where a point is lost. The gradient [along column or row, component] per grid step. The
        standard deviations of the gradient along columns and rows, for independent noise of level 1.
    """
    known = np.isfinite(u).all(axis=-1)
    row, column = np.indices(known.shape)
    design = np.stack([np.ones(known.sum()), column[known], row[known]], axis=1)
    fitted = np.linalg.lstsq(design, u[known], rcond=None)[0]
    rest = np.full(u.shape, np.nan)
    rest[known] = u[known] - design @ fitted
    return rest, fitted[1:], np.sqrt(np.diag(np.linalg.inv(design.T @ design))[1:])


def _deviation(rest: Float[np.ndarray, "row column 2"]) -> Float[np.ndarray, " 2"]:
    known = rest[np.isfinite(rest).all(axis=-1)]
    return np.sqrt((known**2).sum(axis=0) / (len(known) - 3))


def _rests(u: np.ndarray, level: np.ndarray, factor: np.ndarray) -> bool:
    if not says_something(u):
        return False
    rest, gradient, spread = without_affine(u)
    if (_deviation(rest) > _NO_SHAPE * level).any():
        return False
    noise = level * factor
    uncertain = np.outer(spread, noise)
    strain = np.array([gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]])
    error = np.array([uncertain[0, 0], uncertain[1, 1], np.hypot(uncertain[0, 1], uncertain[1, 0])])
    return bool((np.abs(strain) < _NO_STRAIN * error).all())


def _correlations(rest: Float[np.ndarray, "static row column"], lags: np.ndarray):
    """(correlation at each lag along rows and columns, number of pairs) of frames of level 1."""
    seen, pairs = [], []
    for lag in lags:
        products = [rest[:, lag:] * rest[:, :-lag], rest[:, :, lag:] * rest[:, :, :-lag]]
        values = np.concatenate([p[np.isfinite(p)] for p in products])
        seen.append(values.mean() if values.size else 0.0)
        pairs.append(values.size)
    return np.array(seen), np.array(pairs)
