"""Which frames of a series become load steps, and how far the sheet is stretched in each."""

import numpy as np

from hypernode.config.specimens import Specimen
from hypernode.dic.errors import DicError
from hypernode.dic.series import Series

#: The tensile axis of each load that a specimen may have.
AXIS = {"clamped_x": 0, "clamped_y": 1}


def trimmed(series: Series, ring: int) -> Series:
    """The series without the outermost rings of points."""
    if min(len(series.x), len(series.y)) <= 2 * ring + 2:
        raise DicError(f"edge_ring = {ring} leaves no grid of {len(series.x)} x {len(series.y)} points")
    cut = slice(ring, -ring or None)
    frames = [type(f)(f.number, f.displacement[cut, cut]) for f in series.frames]
    return Series(series.x[cut], series.y[cut], frames)


def mean_stretch(series: Series, axis: int) -> np.ndarray:
    """Mean stretch along the tensile axis of every frame, between end lines; NaN where one of them is lost."""
    position = (series.x, series.y)[axis]
    means = []
    for frame in series.frames:
        u = frame.displacement[..., axis]
        ends = (u[:, 0], u[:, -1]) if axis == 0 else (u[0], u[-1])
        low, high = (end[np.isfinite(end)].mean() if np.isfinite(end).any() else np.nan for end in ends)
        means.append(1.0 + (high - low) / (position[-1] - position[0]))
    return np.array(means)


def select_frames(specimen: Specimen, series: Series) -> np.ndarray:
    """Numbers of the frames that become load steps."""
    if specimen.frames is not None:
        return np.array(specimen.frames)
    stretch = mean_stretch(series, AXIS[specimen.load])
    numbers = [frame.number for frame in series.frames]
    if specimen.stretches is None:
        return np.array([numbers[index] for index in _evenly_spaced(stretch, specimen)])
    largest = max(stretch[np.isfinite(stretch)], default=1.0)
    chosen = []
    for target in specimen.stretches:
        if target > largest:
            raise DicError(
                f"{specimen.folder}: no frame reaches the mean stretch {target:g}; the largest is {largest:.4g}"
            )
        chosen.append(numbers[int(np.nanargmin(np.abs(stretch - target)))])
    if len(set(chosen)) < len(chosen):
        raise DicError(
            f"{specimen.folder}: stretches {specimen.stretches} pick the frames {chosen}: spread them further apart"
        )
    return np.array(chosen)


def _evenly_spaced(stretch: np.ndarray, specimen: Specimen) -> list[int]:
    """Indices of the frames nearest to ``load_steps`` mean stretches in equal steps up to the largest, each once."""
    if not np.nanmax(stretch[1:], initial=1.0) > 1.0:
        raise DicError(f"{specimen.folder}: in no frame is the sheet longer than in the first: check load and frames")
    # What follows the largest stretch is not the loading of the test.
    loading = stretch[: int(np.nanargmax(stretch)) + 1]
    targets = np.linspace(1.0, loading[-1], specimen.load_steps + 1)[1:]
    nearest = {int(np.nanargmin(np.abs(loading - target))) for target in targets}
    return sorted(nearest - {0})
