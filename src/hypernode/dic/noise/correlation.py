"""Noise that neighbouring points share: its autocorrelation, and the equivalent level of independent noise."""

import numpy as np
from jaxtyping import Float

#: Distance between lengths that are tried: in grid steps up to one, relative beyond. What a frame can tell is coarser.
_LENGTH_STEP = 0.05
#: What a length must better the fit of white noise by, in chi square: three standard deviations.
_NOT_WHITE = 9.0


def autocorrelation(lag, length: float):
    """Correlation of the noise of points that are ``lag`` grid steps apart: exp(-lag^2 / (4 length^2)).

    This is the autocorrelation of white noise after smoothing by a Gaussian of standard deviation ``length`` [grid
    steps]. Length 0 is white noise.
    """
    lag = np.asarray(lag, dtype=float)
    return np.exp(-(lag**2) / (4.0 * length**2)) if length > 0.0 else (lag == 0.0).astype(float)


def independent_factor(length: float) -> float:
    """Ratio of two noise levels with the same power at long wavelengths: independent noise over correlated noise.

    It is the square root of the autocorrelation summed over all lags of the plane, since this sum is the spectral
    density at zero. For a Gaussian the sum over the plane is the square of the sum along a line.
    """
    reach = np.arange(1, int(np.ceil(12.0 * length)) + 1)
    return float(1.0 + 2.0 * autocorrelation(reach, length).sum())


def lengths_up_to(largest: float) -> Float[np.ndarray, " length"]:
    """Trial correlation lengths [grid steps], starting with 0."""
    short = np.arange(0.0, 1.0, _LENGTH_STEP)
    long = np.exp(np.arange(0.0, np.log(max(largest, 1.0)) + 1e-9, _LENGTH_STEP))
    return np.concatenate([short, long])[np.concatenate([short, long]) <= largest + 1e-9]


def best_length(chi_square: Float[np.ndarray, " length"]) -> int:
    """Index of the best length. It is 0, white noise, unless another length fits significantly better."""
    best = int(np.argmin(chi_square))
    return best if chi_square[0] - chi_square[best] > _NOT_WHITE else 0
