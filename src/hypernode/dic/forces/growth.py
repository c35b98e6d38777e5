"""Whether force and stretch go on together: a curve that stands, or skips, is of frames taken at other times."""

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.checks import Finding
from hypernode.dic.forces.matching import Component, PullRecord
from hypernode.dic.frames import first_loading, working_stretch
from hypernode.dic.series import Series
from hypernode.mechanics.loads import BOTH_AXES, tensile_axis

#: Share of the whole stretch and of the largest force by which both change between frames that speak of an order:
#: several times what noise and load cells do.
_TURNS = 0.05
#: Fewest frames of which one may be off the curve of the others.
_OTHERS = 7
#: Share of the whole stretch over which the end of a curve is looked at.
_END = 0.25
#: Growth over that end, over the mean one, below which the force stands. A sheet of rubber at three times its length
#: has three quarters, one that loses its stiffness to damage a third.
_STANDS = 0.1
#: Fewest frames of the end, and before it.
_FEWEST = 3
#: What rubber that is pulled along both axes loses of its slope in a unit of strain, as a logarithm: 4.6 of a
#: neo-Hookean sheet at a strain of a tenth, and up to thrice as much of laws with steep powers. What is beyond that is
#: of another strain.
_RUBBER, _SOFTENS = 4.6, 18.0
#: Standard deviations by which that is told.
_CURVED = 4.0
#: How much less the force grows with the stretch between two frames than before and after them, from which pictures are
#: missing there: one that is missing makes it half. And the scatter of that ratio beyond which it is told.
_SKIPS, _DEVIATIONS = 1.75, 6.0
#: Share of the usual step of the stretch below which a step tells no slope, and fewest steps.
_STEP, _STEPS = 0.25, 6


def growth_findings(test: SpecimenTest, pull: PullRecord, series: Series, part: Component) -> list[Finding]:
    """What is strange about the order of frames, and about the end of a test's first loading, as the record tells."""
    whole = working_stretch(series, test.load, *part)
    numbers, course = first_loading(series, whole)
    told = pull.reached(numbers)
    if not told.any():
        return []
    order = _order(pull, series, whole) if tensile_axis(test.load) == part[0] else []
    numbers, course, force = numbers[told], course[told], pull.forces(numbers[told])
    bend = check_bend(course, force) if test.load in BOTH_AXES and test.displacement_factor is None else []
    pace = [] if pull.image is not None else check_pace(course, force, numbers)
    return order + bend + check_growth(course, force) + (pace or check_alone(course, force, numbers))


def _order(pull: PullRecord, series: Series, course: Float[np.ndarray, " frame"]) -> list[Finding]:
    """What the forces of all frames say of their order."""
    numbers = np.array([frame.number for frame in series.frames])
    told = pull.reached(numbers) & np.isfinite(course)
    return check_order(course[told], pull.forces(numbers[told]), numbers[told]) if told.any() else []


def check_order(
    stretch: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"], numbers: Int[np.ndarray, " frame"]
) -> list[Finding]:
    """The sheet gets no shorter between two frames while its force [N] grows.

    Args:
        stretch: of all frames, in their order.
        force: of the same frames.
        numbers: of the frames, for the message.
    """
    shorter = -np.diff(stretch) > _TURNS * np.ptp(stretch)
    against = np.flatnonzero(shorter & (np.diff(force) > _TURNS * np.abs(force).max(initial=0.0)))
    if not len(against):
        return []
    k = against[0]
    sentence = (
        f"from frame {numbers[k]} to {numbers[k + 1]} the stretch falls from {stretch[k]:.4g} to {stretch[k + 1]:.4g} "
        f"and the force grows from {force[k]:.4g} to {force[k + 1]:.4g} N, as in no sheet: frames may be numbered in "
        "another order than they were taken, as 1, 10, 2 is; or the clocks differ, --set first_frame_time=SECONDS"
    )
    return [Finding(sentence, False)]


def check_bend(stretch: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"]) -> list[Finding]:
    """The force [N] of a sheet that is pulled along both axes loses its slope no faster than an elastic sheet's does.

    Args:
        stretch: of the frames of one loading, the reference first.
        force: of the same frames.
    """
    e = stretch - stretch[0]
    if len(e) < 2 * _FEWEST or not (e[-1] > 0.0 and force[-1] > force[0]):
        return []
    e = e / e[-1]
    terms = np.stack([e, e**2, e**3], axis=1)
    factors, _, rank, _ = np.linalg.lstsq(terms, force - force[0], rcond=None)
    left = force - force[0] - terms @ factors
    spread = np.linalg.pinv(terms.T @ terms) * (left @ left) / max(len(e) - 3, 1)
    # Slopes at both ends, and what the scatter leaves open of them.
    at = np.array([[1.0, 0.0, 0.0], [1.0, 2.0, 3.0]])
    first, last = at @ factors
    error = _CURVED * np.sqrt(np.diag(at @ spread @ at.T))
    if rank < 3 or first <= error[0]:
        return []
    pulled = stretch[-1] - stretch[0]
    lost = np.log((first - error[0]) / max(last + error[1], _STANDS * first)) / pulled
    if lost <= _SOFTENS:
        return []
    sentence = (
        f"until a stretch of {stretch[-1]:.4g} the slope of the force falls to {max(last / first, 0.0):.0%} of the "
        f"first one, as rubber has it at a strain {lost / _RUBBER:.2g} times as large: displacements may be in another "
        "unit than positions, --set displacement_factor=10, or the sheet yields or relaxes; --set "
        "displacement_factor=1 says that they are right"
    )
    return [Finding(sentence, False)]


def check_growth(stretch: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"]) -> list[Finding]:
    """The force [N] grows over the last quarter of the stretch.

    Args:
        stretch: of the frames of one loading, the reference first.
        force: of the same frames.
    """
    if len(stretch) < 2 * _FEWEST or not (force[-1] > force[0] and stretch[-1] > stretch[0]):
        return []
    begin = stretch[-1] - _END * (stretch[-1] - stretch[0])
    end = stretch >= begin
    if end.sum() < _FEWEST or (~end).sum() < _FEWEST or np.ptp(stretch[end]) == 0.0:
        return []
    slope = np.polyfit(stretch[end], force[end], 1)[0]
    mean = (force.max() - force[0]) / (stretch[-1] - stretch[0])
    if slope > _STANDS * mean:
        return []
    low, high = force[end].min(), force[end].max()
    sentence = (
        f"while the stretch goes on from {begin:.4g} to {stretch[-1]:.4g}, the force stays between {low:.4g} and "
        f"{high:.4g} N: a sheet that yields or tears, grips that slip, or frames that were taken earlier than is said; "
        "check frame_rate (--frame-rate) and first_frame_time"
    )
    return [Finding(sentence, False)]


def check_alone(
    stretch: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"], numbers: Int[np.ndarray, " frame"]
) -> list[Finding]:
    """No single frame is far off the smooth curve of force [N] and stretch that all others make.

    Args:
        stretch: of the frames of one loading, the reference first.
        force: of the same frames.
        numbers: of the frames, for the message.
    """
    if len(stretch) < _OTHERS or np.ptp(stretch) == 0.0:
        return []
    at = (stretch - stretch.min()) / np.ptp(stretch)
    off, scatter = np.zeros(len(at)), np.zeros(len(at))
    for k in range(1, len(at) - 1):
        others = np.delete(np.arange(len(at)), k)
        curve = np.polynomial.Polynomial.fit(at[others], force[others], 3)
        off[k] = force[k] - curve(at[k])
        scatter[k] = np.sqrt(np.sum((force[others] - curve(at[others])) ** 2) / (len(others) - 4))
    k = int(np.argmax(np.abs(off)))
    if np.abs(off[k]) <= max(_TURNS * np.abs(force).max(), _DEVIATIONS * scatter[k]):
        return []
    sentence = (
        f"the force at frame {numbers[k]}, {force[k]:.4g} N at the stretch {stretch[k]:.4g}, is off the smooth curve "
        f"of all others by {off[k]:.2g} N: the file may be of another picture, or the force a spike; leave the frame "
        "out, --set 'frames=[...]', or number it as it was taken"
    )
    return [Finding(sentence, False)]


def check_pace(
    stretch: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"], numbers: Int[np.ndarray, " frame"]
) -> list[Finding]:
    """The force [N] grows with the stretch between any two frames about as it does before and after them.

    No sheet has a lower slope between two frames only. Pictures that were dropped there make it so: from then on the
    record is read as many frames too early.

    Args:
        stretch: of the frames of one loading, the reference first.
        force: of the same frames, by their times.
        numbers: of the frames, for the message.
    """
    step, rise = np.diff(stretch), np.diff(force)
    if len(step) < _STEPS or (step <= _STEP * np.median(step)).any() or (rise <= 0.0).any():
        return []
    slope = np.log(rise / step)
    # One reading that is off makes a step lower and its neighbour steeper: the usual slope around is a median.
    around = [np.median(np.delete(slope[max(k - 2, 0) : k + 3], min(k, 2))) for k in range(1, len(slope) - 1)]
    less = np.array(around) - slope[1:-1]
    k = int(np.argmax(less))
    # A step that stands out bends the curve on both of its sides as well.
    others = np.delete(less, slice(max(k - 1, 0), k + 2))
    scatter = np.sqrt(np.mean(others**2)) if len(others) > 1 else np.inf
    if less[k] < max(np.log(_SKIPS), _DEVIATIONS * scatter) or abs(slope[k + 2] - slope[k]) > 0.5 * less[k]:
        return []
    before, after, times = numbers[k + 1], numbers[k + 2], float(np.exp(less[k]))
    sentence = (
        f"between frames {before} and {after} the stretch goes on by {times:.2g} times as much for the force as before "
        f"and after: the camera may have dropped {max(round(times) - 1, 1)} pictures there. Number the files after it "
        "by as many more, or name pictures in the record, a column Image"
    )
    return [Finding(sentence, False)]
