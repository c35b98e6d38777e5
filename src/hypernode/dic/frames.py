"""Which frames of a series become load steps, and how far the sheet is stretched in each."""

import warnings
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.grid import FEWEST_LINES
from hypernode.dic.series import Series
from hypernode.mechanics.loads import RESULTANTS

#: Share of the points of two end lines that must face each other to be compared alone.
_FACING = 0.25


def trimmed(series: Series, ring: int) -> Series:
    """The series without the outermost rings of points."""
    columns, rows = (len(lines) - 2 * ring for lines in (series.x, series.y))
    if min(columns, rows) < FEWEST_LINES:
        folder = series.files[0].parent if series.files else "the series"
        left = f"{max(columns, 0)} x {max(rows, 0)} of {len(series.x)} x {len(series.y)} points"
        raise DicError(
            f"{folder}: edge_ring = {ring} leaves {left}, and a grid has {FEWEST_LINES} x {FEWEST_LINES} at least: set "
            f"edge_ring to {max((min(len(series.x), len(series.y)) - FEWEST_LINES) // 2, 0)} at most, or export points "
            "that lie closer together"
        )
    cut = slice(ring, -ring or None)
    frames = [type(f)(f.number, f.displacement[cut, cut], f.time, f.force) for f in series.frames]
    return replace(series, x=series.x[cut], y=series.y[cut], frames=frames, out_of_plane=0.0, files=(), tilt=0.0)


def mean_gradient(series: Series, i: int, J: int) -> Float[np.ndarray, " frame"]:
    """Mean of the displacement gradient dui/dXJ of every frame, between end lines; NaN where one of them is lost."""
    position = (series.x, series.y)[J]
    means = []
    for frame in series.frames:
        u = frame.displacement[..., i]
        ends = (u[:, 0], u[:, -1]) if J == 0 else (u[0], u[-1])
        known = np.isfinite(ends)
        # Between points that face each other, so that a corner without material shears nothing.
        facing = known.all(axis=0) if known.all(axis=0).mean() >= _FACING else True
        low, high = (end[at & facing].mean() if at.any() else np.nan for end, at in zip(ends, known, strict=True))
        means.append((high - low) / (position[-1] - position[0]))
    return np.array(means)


def mean_stretch(series: Series, load: str) -> Float[np.ndarray, " frame"]:
    """One number a frame that says how far a load has gone: mean stretch along its pull, or 1 + shear, whichever way.

    Of several directions it is that in which the sheet moves most; a general load may shear it as well.
    """
    courses = [mean_gradient(series, i, J) for i, J in RESULTANTS[load]]
    if load == "shear":
        courses = [np.abs(each) for each in courses]
    if load == "general":
        # Symmetric, so that a camera that turned shears nothing.
        courses.append(np.abs(mean_gradient(series, 0, 1) + mean_gradient(series, 1, 0)))
    with warnings.catch_warnings():
        # A course that is lost in every frame is no candidate, and numpy says so as a warning.
        warnings.simplefilter("ignore", RuntimeWarning)
        moved = [np.nanmax(course) - np.nanmin(course) for course in courses]
    return 1.0 + courses[int(np.argmax(np.nan_to_num(moved)))]


def working_stretch(series: Series, load: str, i: int, J: int) -> Float[np.ndarray, " frame"]:
    """One number a frame with which a resultant of a load grows: the mean stretch along it, or 1 + shear.

    Where the sheet is pulled across as well, half of that elongation adds to it: in plane stress and at constant volume
    the stress is 4 mu times their sum, to first order.
    """
    along = 1.0 + mean_gradient(series, i, J)
    across = (1 - i, 1 - i)
    return along + 0.5 * mean_gradient(series, *across) if i == J and across in RESULTANTS[load] else along


def select_frames(test: SpecimenTest, series: Series, times: dict[int, float] | None = None) -> np.ndarray:
    """Numbers of the frames that become load steps.

    Args:
        test: which of its keys selects them.
        series: the frames.
        times: of every frame [s], where they are known.
    """
    if test.frames is not None:
        return np.array(test.frames)
    numbers = [frame.number for frame in series.frames]
    if test.times is not None:
        return _nearest_in_time(test, numbers[1:], times)
    stretch = mean_stretch(series, test.load)
    if test.stretches is None:
        return np.array([numbers[index] for index in _evenly_spaced(stretch, test)])
    largest = max(stretch[np.isfinite(stretch)], default=1.0)
    chosen = []
    for target in test.stretches:
        if target > largest:
            raise DicError(f"{test.folder}: no frame reaches the mean stretch {target:g}; the largest is {largest:.4g}")
        chosen.append(numbers[int(np.nanargmin(np.abs(stretch - target)))])
    return _each_once(test, "stretches", chosen)


def _nearest_in_time(test: SpecimenTest, numbers: list[int], times: dict[int, float] | None) -> np.ndarray:
    if not times:
        raise DicError(f"{test.folder}: the frames have no times: give frame_rate, or choose frames by their numbers")
    known = np.array([times[number] for number in numbers])
    for wanted in test.times:
        if not known.min() <= wanted <= known.max():
            raise DicError(
                f"{test.folder}: no frame is of {wanted:g} s; they are from {known.min():g} to {known.max():g} s"
            )
    return _each_once(test, "times", [numbers[int(np.argmin(np.abs(known - wanted)))] for wanted in test.times])


def _each_once(test: SpecimenTest, key: str, chosen: list[int]) -> np.ndarray:
    if len(set(chosen)) < len(chosen):
        raise DicError(f"{test.folder}: {key} {getattr(test, key)} pick the frames {chosen}: spread them further apart")
    return np.array(chosen)


def _evenly_spaced(stretch: np.ndarray, test: SpecimenTest) -> list[int]:
    """Indices of the frames nearest to ``load_steps`` mean stretches in equal steps up to the largest, each once."""
    if not np.nanmax(stretch[1:], initial=1.0) > 1.0:
        raise DicError(
            f"{test.folder}: in no frame is the sheet longer than in the first, as a {test.load} test makes it: check "
            "load and frames"
        )
    # What follows the largest stretch is not the loading of the test.
    loading = stretch[: int(np.nanargmax(stretch)) + 1]
    targets = np.linspace(1.0, loading[-1], test.load_steps + 1)[1:]
    nearest = {int(np.nanargmin(np.abs(loading - target))) for target in targets}
    return sorted(nearest - {0})
