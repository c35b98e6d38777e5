"""Whether an identified field shows that displacements are not as noisy as they were believed to be."""

from dataclasses import replace

import numpy as np
import xarray as xr

from hypernode.data.believed_noise import BelievedNoise, NoiseSource
from hypernode.data.measurement import scatter_of_steps
from hypernode.identification.estimate import Estimate


def refuted_noise(found: Estimate, measurement: xr.Dataset) -> BelievedNoise | None:
    """The noise to identify a field with anew, or None where the believed one may be right.

    Noise is too large where a field leaves far less of it. It is too small where frames say so and the field leaves as
    much as they do. Frames are then right about its size, and about how far errors are shared. They may take rough
    deformation for noise, though: where the field leaves less than they tell, noise is what the field leaves. A field
    that leaves more than was believed says nothing by itself, as its law may not follow the sheet.

    Args:
        found: the field, identified with the noise of the measurement.
        measurement: with the noise that was believed.
    """
    observations, strategy = found.problem.observations, found.problem.strategy
    if not observations.by_points:
        return None
    believed, frames = BelievedNoise.read(measurement.attrs), BelievedNoise(NoiseSource.FRAMES)
    scatter, told = _scatter(measurement), np.nan
    if "frames_noise_scatter" in measurement and believed.source is not frames.source:
        told = _scatter(frames.of(measurement))
    # Of points beside interfaces, which a window makes uncertain, less is left than of their noise alone would be.
    left = found.misfits["displacement"] * scatter
    too_large = observations.noisy and left < strategy.noise_refuted * scatter
    if too_large:
        # The numbers that data determine take their part of noise away.
        left /= np.sqrt(1.0 - min(found.effective_parameters / found.problem.observed, strategy.most_taken_away))
        too_large = left < strategy.noise_refuted * scatter
    # What frames do not tell is not a number, and neither larger nor smaller than any.
    elsewhere = told > scatter / strategy.noise_refuted or (too_large and told < strategy.noise_refuted * scatter)
    if elsewhere and left > strategy.frames_confirmed * told:
        return frames
    return replace(believed, factor=believed.factor * left / scatter) if too_large else None


def _scatter(measurement: xr.Dataset) -> float:
    return float(np.sqrt(np.mean(scatter_of_steps(measurement) ** 2)))
