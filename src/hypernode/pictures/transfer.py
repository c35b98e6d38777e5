"""What an engine makes of a displacement field: how much of a wave it lets through, and its noise.

A subset fits a polynomial to the displacement by least squares. At its middle it returns the field convolved with a
kernel of its side (Schreier and Sutton, Experimental Mechanics 42 (2002) 303). An affine one averages. A quadratic one
is the filter of Savitzky and Golay, Analytical Chemistry 36 (1964) 1627. An engine comes close, with a side of its own.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8
from scipy.optimize import least_squares

from hypernode.config.correlation import Correlation
from hypernode.config.pictures import Pictures
from hypernode.pictures.correlation import Correlated, correlate
from hypernode.pictures.photograph import recorded
from hypernode.pictures.speckle import Pattern, sprayed

#: Wavelengths over the subset, from where an average lets nothing through to where all kernels are alike.
WAVELENGTHS = (1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 6.0)
#: Amplitude of displacement gradients: below what makes subsets lose their texture, above noise by a hundred.
GRADIENT = 0.08
#: Pixels around the waves, in subsets: the pattern comes from there, and no subset reaches it.
_BORDER = 1
#: A displacement of a fraction of a pixel, at which interpolation between pixels errs about as much as on average.
_FRACTION = 0.37
#: Steps of the fixed point that inverts the displacement: each gains a digit at such gradients.
_STEPS = 16


def average_gain(waves: Float[np.ndarray, " wave"]) -> Float[np.ndarray, " wave"]:
    """What a moving average leaves of a wave's amplitude.

    Args:
        waves: side of the window over the wavelength.
    """
    return np.sinc(waves)


def quadratic_gain(waves: Float[np.ndarray, " wave"]) -> Float[np.ndarray, " wave"]:
    """What the middle of a quadratic fit over a window leaves of a wave's amplitude: kernel (9 - 15 t^2) / 8.

    Args:
        waves: side of the window over the wavelength.
    """
    z = np.pi * np.asarray(waves, dtype=float)
    small = z < 0.05
    z = np.where(small, 1.0, z)
    gain = -1.5 * np.sin(z) / z + 7.5 * (np.sin(z) / z**3 - np.cos(z) / z**2)
    # The series' first two terms; the next is below the ninth digit.
    return np.where(small, 1.0 - (np.pi * np.asarray(waves)) ** 4 / 280.0, gain)


KERNELS = {"average": average_gain, "quadratic": quadratic_gain}


@dataclass(frozen=True, kw_only=True)
class Transfer:
    """What an engine makes of displacement fields.

    Attributes:
        wavelength: of the waves [pixel].
        gain, gain_error: seen over true amplitude, and its standard error.
        kernel: which of the two analytical kernels is nearer, and ``misfit`` of each, root mean square of the gain.
        width, width_error: side of the kernel over the subset, and its standard error.
        noise: standard deviation of displacements of a shifted sheet [pixel].
        noise_length: distance at which the noise's correlation has fallen to 1 / e [pixel]; 0 below the step.
    """

    wavelength: Float[np.ndarray, " wave"]
    gain: Float[np.ndarray, " wave"]
    gain_error: Float[np.ndarray, " wave"]
    kernel: str
    misfit: dict[str, float]
    width: float
    width_error: float
    noise: float
    noise_length: float


def photographed_waves(
    subset: int, side: int, pictures: Pictures
) -> tuple[UInt8[np.ndarray, "frame row column"], Float[np.ndarray, " wave"]]:
    """Pictures of a speckle at rest, shifted by a fraction of a pixel, and with waves along its rows.

    Args:
        subset: side of the subsets that will look at it [pixel].
        side: of the pictures [pixel].

    Returns:
        (the pictures, wavelengths of those from the third on [pixel]).
    """
    border = _BORDER * subset
    size = (side + 2.0 * border,) * 2
    pattern = Pattern.of(sprayed(size, pictures.speckle), size)
    row, column = np.mgrid[:side, :side].astype(float)
    wavelength = subset * np.array(WAVELENGTHS)
    displacements = [lambda X: 0.0 * X, lambda X: np.full_like(X, _FRACTION)]
    displacements += [lambda X, each=each: wave(X, each) for each in wavelength]
    taken = []
    for frame, displacement in enumerate(displacements):
        X = column.copy()
        for _ in range(_STEPS):
            X = column - displacement(X)
        # Rows of a pattern count upward, which is all one to random discs.
        light = pattern.at(np.stack([X.ravel() + border, row.ravel() + border], axis=1)).reshape(side, side)
        grey = pictures.dark + (pictures.bright - pictures.dark) * light
        taken.append(recorded(grey, pictures, frame))
    return np.stack(taken), wavelength


def wave(X: np.ndarray, wavelength: float) -> np.ndarray:
    """Displacement along x of a wave with the gradient that is measured with [pixel]."""
    return GRADIENT * wavelength / (2.0 * np.pi) * np.sin(2.0 * np.pi * X / wavelength)


def measured(settings: Correlation, pictures: Pictures, side: int = 420, threads: int = 1) -> Transfer:
    """Photograph waves, let an engine follow them, and compare with the analytical kernels.

    Raises:
        EngineMissing: the engine's environment is not there.
        PictureError: it gave up.
    """
    taken, wavelength = photographed_waves(settings.subset, side, pictures)
    found = correlate(taken, np.ones((side, side), bool), settings, threads)
    amplitudes = [_amplitude(found, frame + 2, each, settings.subset) for frame, each in enumerate(wavelength)]
    gain, error = np.array(amplitudes).T
    fits = {kernel: _fitted(kernel, settings.subset / wavelength, gain) for kernel in KERNELS}
    nearest = min(fits, key=lambda kernel: fits[kernel][2])
    noise, length = _noise(found, 1)
    width, width_error, _ = fits[nearest]
    return Transfer(
        wavelength=wavelength,
        gain=gain,
        gain_error=error,
        kernel=nearest,
        misfit={kernel: fit[2] for kernel, fit in fits.items()},
        width=width,
        width_error=width_error,
        noise=noise,
        noise_length=length,
    )


def _amplitude(found: Correlated, frame: int, wavelength: float, subset: int) -> tuple[float, float]:
    """(seen over true amplitude of a wave, its standard error)."""
    seen = found.displacement[frame, :, 0]
    known = np.isfinite(seen)
    X, seen = found.column[known].astype(float), seen[known]
    phase = 2.0 * np.pi * X / wavelength
    basis = np.stack([wave(X, wavelength), np.cos(phase), np.ones_like(X)], axis=1)
    factor, *_ = np.linalg.lstsq(basis, seen, rcond=None)
    # Neighbouring subsets share pixels: as many are independent as fit side by side.
    shared = max(subset / found.step, 1.0) ** 2
    variance = np.mean((seen - basis @ factor) ** 2) * np.linalg.inv(basis.T @ basis)[0, 0] * shared
    return float(factor[0]), float(np.sqrt(variance))


def _fitted(kernel: str, ratio: Float[np.ndarray, " wave"], gain: Float[np.ndarray, " wave"]):
    """(side over the subset, its standard error, misfit of the gain) of the kernel nearest to a measured gain."""
    gain_of = KERNELS[kernel]
    fit = least_squares(lambda width: gain_of(width[0] * ratio) - gain, [1.0])
    misfit = float(np.sqrt(np.mean(fit.fun**2)))
    slope = float(np.linalg.norm(fit.jac))
    return float(fit.x[0]), misfit * np.sqrt(len(gain) / (len(gain) - 1.0)) / slope, misfit


def _noise(found: Correlated, frame: int) -> tuple[float, float]:
    """(standard deviation, correlation length) of displacements along the rows that should all be alike [pixel]."""
    columns, rows = np.unique(found.column), np.unique(found.row)
    grid = np.full((len(rows), len(columns)), np.nan)
    place = np.searchsorted(rows, found.row), np.searchsorted(columns, found.column)
    grid[place] = found.displacement[frame, :, 0]
    grid -= np.nanmean(grid)
    variance = np.nanmean(grid**2)
    alike = [1.0]
    for lag in range(1, len(columns)):
        alike.append(float(np.nanmean(grid[:, lag:] * grid[:, :-lag]) / variance))
        if alike[-1] < np.exp(-1.0):
            break
    share = (alike[-2] - np.exp(-1.0)) / (alike[-2] - alike[-1])
    return float(np.sqrt(variance)), float((len(alike) - 2 + share) * found.step)
