"""Which frames of a series become load steps, and how far the sheet is stretched in each."""

import warnings
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.grid import FEWEST_LINES
from hypernode.dic.loadings import Loading, every_loading, loadings
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
    frames = [replace(f, displacement=f.displacement[cut, cut]) for f in series.frames]
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

    Where the sheet is pulled across as well, half of that elongation adds to it. In plane stress and at constant volume
    the stress is 4 mu times their sum, to first order.
    """
    along = 1.0 + mean_gradient(series, i, J)
    across = (1 - i, 1 - i)
    return along + 0.5 * mean_gradient(series, *across) if i == J and across in RESULTANTS[load] else along


def select_frames(
    test: SpecimenTest,
    series: Series,
    times: dict[int, float] | None = None,
    unheard: Mapping[int, str] = MappingProxyType({}),
) -> np.ndarray:
    """Numbers of the frames that become load steps: by their stretches, only those of one loading.

    Args:
        test: which of its keys selects them.
        series: the frames.
        times: of every frame [s], where they are known.
        unheard: number of each frame that has no force -> why.

    Raises:
        DicError: nothing that fits what is asked for.
    """
    if test.frames is not None:
        silent = next((number for number in test.frames if number in unheard), None)
        if silent is not None:
            raise DicError(f"{test.folder}: frame {silent} has no force: {unheard[silent]}: leave it out of frames")
        return np.array(test.frames)
    numbers = [frame.number for frame in series.frames]
    if test.times is not None:
        return _nearest_in_time(test, [number for number in numbers[1:] if number not in unheard], times)
    stretch = mean_stretch(series, test.load)
    loading = loading_of(test, stretch)
    usable = np.isfinite(stretch) & ~np.isin(numbers, list(unheard))
    usable[: loading.start + 1], usable[loading.peak + 1 :] = False, False
    places = np.flatnonzero(usable)
    if not stretch[places].max(initial=1.0) > 1.0:
        raise DicError(
            f"{test.folder}: in no frame "
            + ("with a force " if unheard else "")
            + f"is the sheet longer than in the first, as a {test.load} test makes it: check load and frames"
        )
    if test.stretches is None:
        targets = np.linspace(1.0, stretch[places].max(), test.load_steps + 1)[1:]
        return np.array([numbers[k] for k in sorted({_nearest(places, stretch, target) for target in targets})])
    for target in test.stretches:
        if target > stretch[places].max():
            raise DicError(
                f"{test.folder}: no frame reaches the mean stretch {target:g}; the largest is "
                f"{stretch[places].max():.4g}"
            )
    return _each_once(test, "stretches", [numbers[_nearest(places, stretch, target)] for target in test.stretches])


def _nearest(places, stretch, target: float) -> int:
    """Of places of frames, that with the stretch nearest to a target."""
    return int(places[int(np.argmin(np.abs(stretch[places] - target)))])


def loading_of(test: SpecimenTest, stretch: Float[np.ndarray, " frame"]) -> Loading:
    """The loading that a test is taken to be: the last, or that of its number.

    Raises:
        DicError: there are not as many.
    """
    found = loadings(stretch)
    if test.loading == "last":
        return found[-1]
    if test.loading > len(found):
        raise DicError(f"{test.folder}: loading = {test.loading}, and the sheet is pulled {len(found)} times")
    return found[test.loading - 1]


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


def first_loading(series: Series, course: Float[np.ndarray, " frame"]) -> tuple[np.ndarray, np.ndarray]:
    """(numbers of the reference and of the frames of the first loading, as far as their course is known; their course).

    A smaller loading before it, and its unloading, are another branch of the curve.
    """
    numbers = np.array([frame.number for frame in series.frames])
    at, first = np.arange(len(course)), loadings(course)[0]
    seen = np.isfinite(course) & ((at == 0) | (at >= first.start)) & (at <= first.peak)
    return numbers[seen], course[seen]


def several_loadings(test: SpecimenTest, series: Series, chosen: np.ndarray) -> str:
    """A sentence where the sheet is pulled more than once, or load steps lie in no loading or in two; else empty.

    Args:
        test: which loading is meant.
        series: the frames.
        chosen: numbers of the load steps.
    """
    stretch = mean_stretch(series, test.load)
    found, numbers = loadings(stretch), [frame.number for frame in series.frames]
    spans = [(numbers[each.start], numbers[each.peak]) for each in found]
    within = [any(start < number <= peak for number in chosen) for start, peak in spans]
    outside = [int(n) for n in chosen if not any(start < n <= peak for start, peak in spans)]
    if len(found) > 1 and sum(within) == 1 and not outside:
        listed = ", ".join(f"{k} from frame {start} to {peak}" for k, (start, peak) in enumerate(spans, start=1))
        smaller = len(every_loading(stretch)) - len(found)
        beside = f", and {smaller} times by less than half as far" if smaller else ""
        return (
            f"the sheet is pulled {len(found)} times ({listed}){beside}: number {within.index(True) + 1} is used; "
            "loading: N uses another"
        )
    if sum(within) > 1 or (outside and any(within)):
        return (
            "the load steps are of several loadings, or of loading and unloading at once, which differ in most "
            "materials: choose them within one"
        )
    return ""
