"""Pictures that grow or shrink as a whole, as those of a sheet that nears the camera do.

A sheet whose picture is larger by the factor 1 + g is seen at (1 + g) (X + u). What is held across keeps its length.
What carries no force keeps its size. Both tell g. Of free sides under load no displacement tells it.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.camera_motion import repeats_of
from hypernode.dic.errors import DicError
from hypernode.dic.forces.matching import Component, PullRecord
from hypernode.dic.frames import mean_gradient, mean_stretch
from hypernode.dic.series import Series
from hypernode.mechanics.loads import CONSTRAINED, RESULTANTS, tensile_axis

#: Growth from which it is one. A sheet that moves by 0.3 mm towards a camera at a distance of one metre has as much.
_LEAST = 3e-4
#: Growth over the elongation of the sheet from which it matters: twice the uncertainty of a force.
_MATTERS = 0.02
#: Standard deviations by which it is told, and how much two growths that are one may differ, over their mean.
_DEVIATIONS, _APART = 4.0, 0.5
#: Fewest points of a line, and share of it that is measured.
_FEWEST, _MEASURED = 8, 0.5
#: Force over what a sheet of this growth would carry, below which it carries none. The softest toes of tissue carry a
#: fifth where the strain is even in both directions.
_CARRIES = 0.1


def grown_ends(test: SpecimenTest, series: Series) -> str:
    """A question where both held ends get longer across the pull, as no sheet that is pulled does; else empty.

    Lines beside a clamp get shorter, as the sheet between the clamps does. Fibres do not change that.
    """
    axis = tensile_axis(test.load)
    if test.camera_growth is not None or axis is None or not _held_across(test, axis):
        return ""
    elongation = mean_stretch(series, test.load) - 1.0
    if not np.nanmax(elongation, initial=0.0) > 0.0:
        return ""
    at = int(np.nanargmax(elongation))
    found = [_growth(line, place) for line, place in _ends(series, at, axis)]
    told = _one(found)
    if told is None or told < _MATTERS * elongation[at]:
        return ""
    return (
        f"both ends that are held get longer across the pull, by {told:.2%} in frame {series.frames[at].number}, while "
        f"the sheet gets longer by {elongation[at]:.2%}: does it come nearer to the camera? --set camera_growth=ends "
        "takes as much out of every frame, and --set camera_growth=0 says that the ends do get longer"
    )


def grown_at_rest(test: SpecimenTest, series: Series, pulls: Mapping[Component, PullRecord]) -> str:
    """A question where frames without a force show a sheet that is larger in both directions alike; else empty.

    Args:
        test: with its load.
        series: the frames.
        pulls: record of each force.
    """
    if test.camera_growth is not None or "shear" in test.load:
        return ""
    numbers = np.array([frame.number for frame in series.frames])
    reached = np.all([pull.reached(numbers) for pull in pulls.values()], axis=0)
    reached[0] = False
    if not reached.any():
        return ""
    shares = []
    for pull in pulls.values():
        force = np.abs(pull.forces(numbers[reached]))
        shares.append(force / force.max() if force.any() else force)
    share = np.full(len(numbers), np.inf)
    share[reached] = np.max(shares, axis=0)
    largest = max(np.nanmax(mean_gradient(series, i, J)[reached], initial=0.0) for i, J in RESULTANTS[test.load])
    for at in np.flatnonzero(share < 1.0) if largest > 0.0 else ():
        growth = _one([_growth(*each) for axis in (0, 1) for each in _sides(series, at, axis)])
        if growth is not None and growth > _MATTERS * largest and share[at] < _CARRIES * growth / largest:
            return (
                f"in frame {numbers[at]} the sheet is larger by {growth:.2%} in both directions, and carries "
                f"{share[at]:.1%} of the largest force: is it nearer to the camera than in the first? --set "
                f"camera_growth={growth:.3g} takes as much out of every later frame, --set 'frames=[...]' leaves out "
                "those that are larger, and --set camera_growth=0 says that it is as large"
            )
    return ""


def without_growth(test: SpecimenTest, series: Series) -> Series:
    """The series as a camera sees it whose pictures do not grow, after ``camera_growth``.

    The growth is a number that every frame after the first has, or that of its ends which are held across.

    Raises:
        DicError: no end is held across, or neither is measured in a frame.
    """
    if not test.camera_growth:
        return series
    axis = tensile_axis(test.load)
    by_ends = test.camera_growth == "ends"
    if by_ends and (axis is None or not _held_across(test, axis)):
        raise DicError(
            f"{test.folder}: camera_growth = ends, and a {test.load} test has no ends that are held across: load of a "
            "pull that has (clamped_x, clamped_y), or camera_growth as a number"
        )
    # About the centre of the field, on which the camera looks.
    X = np.stack(np.meshgrid(series.x, series.y), axis=-1) - 0.5 * np.array([series.x[-1], series.y[-1]])
    frames = series.frames[:1]
    for at, frame in enumerate(series.frames[1:], start=1):
        growth = _mean_of_ends(test, series, at, axis) if by_ends else test.camera_growth
        frames.append(replace(frame, displacement=(X + frame.displacement) / (1.0 + growth) - X))
    return replace(series, frames=frames)


def _mean_of_ends(test: SpecimenTest, series: Series, at: int, axis: int) -> float:
    """The growth of a frame by those of its ends that are measured."""
    slopes = np.array([_growth(line, place)[0] for line, place in _ends(series, at, axis)])
    if not np.isfinite(slopes).any():
        raise DicError(
            f"{test.folder}: camera_growth = ends, and less than half of either end is measured in frame "
            f"{series.frames[at].number}: leave it out (frames), or give camera_growth as a number"
        )
    return float(np.nanmean(slopes))


def _held_across(test: SpecimenTest, axis: int) -> bool:
    low = ("left", "bottom")[axis]
    return (low, 1 - axis) in CONSTRAINED[test.load]


def _ends(series: Series, at: int, axis: int):
    """Displacements across the pull along both end lines of a frame, with their places."""
    u = np.moveaxis(series.frames[at].displacement[..., 1 - axis], 1 - axis, 0)
    return [(u[end], (series.y, series.x)[axis]) for end in (0, -1)]


def _sides(series: Series, at: int, axis: int):
    """Displacements along an axis on two lines along it, in the middle and at a quarter of the other side."""
    u = np.moveaxis(series.frames[at].displacement[..., axis], axis, 0)
    return [(u[len(u) // 2], (series.x, series.y)[axis]), (u[len(u) // 4], (series.x, series.y)[axis])]


def _growth(line: Float[np.ndarray, " point"], place: Float[np.ndarray, " point"]) -> tuple[float, float]:
    """(slope of a line's displacements along it, its standard deviation); NaN where too little is measured."""
    known = np.isfinite(line)
    if known.sum() < max(_FEWEST, _MEASURED * len(line)):
        return np.nan, np.nan
    offset, value = place[known] - place[known].mean(), line[known] - line[known].mean()
    slope = (offset @ value) / (offset @ offset)
    off = value - slope * offset
    repeats = min(repeats_of(off), len(off) / 4.0)
    variance = off @ off / (len(off) - 2.0 * repeats) * repeats / (offset @ offset)
    return float(slope), float(np.sqrt(variance))


def _one(found: list[tuple[float, float]]) -> float | None:
    """The growth that all lines have; None where they differ, or chance makes as much."""
    slopes, errors = np.array(found).T
    mean = float(slopes.mean())
    if not np.isfinite(mean) or mean < _LEAST or (slopes < _DEVIATIONS * errors).any():
        return None
    return mean if np.abs(slopes - mean).max() <= max(_APART * mean, _DEVIATIONS * errors.max()) else None
