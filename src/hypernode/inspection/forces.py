"""The forces of all frames, whether or not the import accepts them, and how the clocks agree."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.checks import check_end
from hypernode.dic.forces.clock import ClockOffset, agreed_offset, estimate_offsets
from hypernode.dic.forces.dialects import PULL
from hypernode.dic.forces.lag import without_lag
from hypernode.dic.forces.magnitude import crosshead_agrees
from hypernode.dic.forces.matching import Component, PullRecord, best_told, pulls_of
from hypernode.dic.forces.record import ForceRecord
from hypernode.dic.frame_clock import FrameClock
from hypernode.dic.frames import first_loading, mean_gradient, working_stretch
from hypernode.dic.series import Series
from hypernode.mechanics.loads import RESULTANTS, tensile_axis


@dataclass(frozen=True)
class Course:
    """One force of the frames that the record reaches.

    Attributes:
        part: component (i, J): the force along i on sections normal to J.
        numbers: of the frames.
        stretch: mean stretch along the force, or 1 + shear.
        force: in N.
    """

    part: Component
    numbers: Int[np.ndarray, " frame"]
    stretch: Float[np.ndarray, " frame"]
    force: Float[np.ndarray, " frame"]


def courses(
    test: SpecimenTest, series: Series, record: ForceRecord, clock: FrameClock | None
) -> tuple[list[Course], list[ClockOffset]]:
    """(forces of the frames by component, estimates of the offset of the record's clock).

    Args:
        test: with its load, and the offsets of force and clock.
        series: the frames, without the rings that are dropped.
        record: of the machine.
        clock: when the frames were taken; None where nothing tells, and nothing needs to.
    """
    parts = [part for part in RESULTANTS[test.load] if record.axes == (PULL,) or "xy"[part[0]] in record.axes]
    if record.axes == (PULL,) and len(parts) > 1:
        return [], []
    numbers = [frame.number for frame in series.frames]
    pulls = pulls_of(test, record, parts, clock, numbers)
    offsets = _offsets(test, series, pulls)
    found = agreed_offset(offsets) if test.force_time_offset == "estimate" else None
    if found is not None:
        pulls = pulls_of(test, record, parts, clock.later(found.seconds), numbers)
    pulls, _ = without_lag(test, pulls, series)
    return [_course(series, part, pull) for part, pull in pulls.items()], offsets


def going_on(test: SpecimenTest, series: Series, record: ForceRecord, clock: FrameClock | None, sides) -> list[str]:
    """Sentences on forces that grow on after the last frame, where no crosshead shows that frames are of their times.

    Args:
        test: with its load.
        series: the frames.
        record: of the machine.
        clock: when the frames were taken; None where nothing tells.
        sides: of the sheet along x and y [mm]; None where they are not known.
    """
    if clock is None or record.image is not None or record.time is None:
        return []
    axis = tensile_axis(test.load)
    if sides is not None and axis is not None:
        part, numbers = (axis, axis), [frame.number for frame in series.frames]
        pull = pulls_of(test, record, [part], clock, numbers)[part]
        if crosshead_agrees(test, pull, series, part, sides):
            return []
    end = float(clock.at(series.frames[-1].number))
    return list(dict.fromkeys(each.sentence for force in record.force.T for each in check_end(end, record.time, force)))


def _offsets(test: SpecimenTest, series: Series, pulls: dict[Component, PullRecord]) -> list[ClockOffset]:
    """Estimates from the largest force; none where the record numbers its pictures."""
    if not pulls:
        return []
    part = best_told(pulls)
    pull = pulls[part]
    if pull.image is not None:
        return []
    # What follows the first loading says nothing more of the clocks.
    numbers, stretch = first_loading(series, working_stretch(series, test.load, *part))
    return estimate_offsets(pull.times(numbers), stretch, pull.time, pull.force, pull.displacement)


def _course(series: Series, part: Component, pull: PullRecord) -> Course:
    numbers = np.array([frame.number for frame in series.frames])
    reached = pull.reached(numbers)
    force = pull.forces(numbers[reached]) if reached.any() else np.empty(0)
    return Course(part, numbers[reached], 1.0 + mean_gradient(series, *part)[reached], force)
