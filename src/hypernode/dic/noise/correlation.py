"""Noise that is alike at neighbouring points: its autocorrelation, and the independent noise it amounts to."""

import numpy as np
from jaxtyping import Float

#: Distance between lengths that are tried: in grid steps up to one, relative beyond. What a frame can tell is coarser.
_LENGTH_STEP = 0.05
#: What a length must better the fit of white noise by, in chi square: three standard deviations.
_NOT_WHITE = 9.0


def autocorrelation(lag, length: float):
    """Correlation of noise at points a number of grid steps apart: exp(-lag^2 / (4 length^2)).

    That of white noise smoothed by a Gaussian of standard deviation ``length``, in grid steps; white where it is 0.
    """
    lag = np.asarray(lag, dtype=float)
    return np.exp(-(lag**2) / (4.0 * length**2)) if length > 0.0 else (lag == 0.0).astype(float)


def independent_factor(length: float) -> float:
    """Level of independent noise with the same power at long wavelengths, over the level of noise of a length.

    The square root of the sum of the autocorrelation over all lags of the plane: its spectral density at zero over that
    of white noise. A Gaussian's sum over the plane is the square of its sum along a line.
    """
    reach = np.arange(1, int(np.ceil(12.0 * length)) + 1)
    return float(1.0 + 2.0 * autocorrelation(reach, length).sum())


def lengths_up_to(largest: float) -> Float[np.ndarray, " length"]:
    """The correlation lengths that are tried, from 0, in grid steps."""
    short = np.arange(0.0, 1.0, _LENGTH_STEP)
    long = np.exp(np.arange(0.0, np.log(max(largest, 1.0)) + 1e-9, _LENGTH_STEP))
    return np.concatenate([short, long])[np.concatenate([short, long]) <= largest + 1e-9]


def best_length(chi_square: Float[np.ndarray, " length"]) -> int:
    """Index of the length that fits best; 0, white noise, unless another fits better beyond chance."""
    best = int(np.argmin(chi_square))
    return best if chi_square[0] - chi_square[best] > _NOT_WHITE else 0
