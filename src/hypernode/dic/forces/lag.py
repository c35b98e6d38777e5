"""A lag between the clocks that the curve of force and stretch tells beyond doubt, and the record without it."""

from dataclasses import replace

import numpy as np

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.checks import LIMITS, Finding
from hypernode.dic.forces.matching import Component, PullRecord, Silence
from hypernode.dic.forces.pairing import STANDS, Pairing, pairing_of
from hypernode.dic.frames import first_loading, working_stretch
from hypernode.dic.series import Series

#: Standard deviations of a lag from which it is taken out: how the force begins speaks for it as well.
_DEVIATIONS = 3.0
#: Share of the lag for which the force stands at least: the rest is what it takes to rise beyond :data:`STANDS`.
_STANDS_FOR = 0.5
#: Share of the largest force over which its first rate is taken.
_ONSET = 0.1
#: Share of what the curve has at rest that the first picture shows of a preload.
_SHOWN = 0.8


def without_lag(
    test: SpecimenTest, pulls: dict[Component, PullRecord], series: Series
) -> tuple[dict[Component, PullRecord], list[Finding]]:
    """(the pulls in the clock of the frames, a sentence where it was moved).

    A record that is late stands while the sheet is stretched already, and then begins at once. A sheet that is
    stretched in its first picture has a force there, and the configuration says that it is none of the load cell's
    zero. The force of the same elongation from rest is earlier in the record. A material that is soft at first begins
    gradually. Tests with two forces are left alone, and so is a force that is late against its own crosshead.

    Args:
        test: which of its keys tell the clock, and the zero.
        pulls: by component, in the clock as the configuration has it.
        series: the frames.
    """
    given = test.force_time_offset is not None or test.first_frame_time != 0.0
    if given or len(pulls) != 1:
        return pulls, []
    ((part, pull),) = pulls.items()
    if pull.image is not None or pull.clock is None or test.load == "shear":
        return pulls, []
    paired = pairing_of(test, pull, series, part)
    if paired.with_crosshead or not paired.told(_DEVIATIONS):
        return pulls, []
    numbers, course = first_loading(series, working_stretch(series, test.load, *part))
    time = pull.times(numbers)
    begin, pace = float(time[0]), float((course[-1] - course[0]) / (time[-1] - time[0]))
    late = paired.seconds > 0.0
    if not (_stands_then_begins(pull, begin, paired) if late else _preloaded(test, pull, begin, paired)):
        return pulls, []
    begin, why = begin + paired.seconds, "the record does not reach, once its clock is moved"
    beyond = (Silence(begin, float(pull.time[0]), why), Silence(float(pull.time[-1]), np.inf, why))
    moved = replace(
        pull,
        clock=pull.clock.later(paired.seconds),
        silences=(*pull.silences, *beyond),
        preload=max(-paired.seconds * pace, 0.0),
    )
    return {part: moved}, [Finding(_sentence(paired, late), False)]


def _sentence(paired: Pairing, late: bool) -> str:
    frames = abs(paired.seconds / paired.interval)
    if late:
        what = f"the force stands while the sheet is stretched already: the record is {frames:.2g} frames late"
    else:
        what = f"the sheet is stretched in its first picture by as much as in {frames:.2g} frames of the test"
    taken = f"forces are read {abs(paired.seconds):.3g} s {'later' if late else 'earlier'}"
    keys = f"--set force_time_offset={paired.seconds:.3g} says that it is so, and 0 reads them as the clock has it"
    return f"{what}, and {taken}; {keys}"


def _stands_then_begins(pull: PullRecord, begin: float, paired: Pairing) -> bool:
    """Whether the force stands from the first frame on [s], and begins at no less than half of its mean rate."""
    during = pull.time >= begin
    time, force = pull.time[during], pull.force[during]
    peak = int(np.argmax(force))
    time, force = time[: peak + 1], force[: peak + 1] - np.interp(begin, pull.time, pull.force)
    if peak < 3 or not force[-1] > 0.0:
        return False
    low, high = (int(np.argmax(force > share * force[-1])) for share in (STANDS, STANDS + _ONSET))
    if time[low] - begin < _STANDS_FOR * paired.seconds or not low < high < peak:
        return False
    first = (force[high] - force[low]) / (time[high] - time[low])
    return first >= LIMITS.least_sharpness * (force[-1] - force[low]) / (time[-1] - time[low])


def _preloaded(test: SpecimenTest, pull: PullRecord, begin: float, paired: Pairing) -> bool:
    """Whether the first frame [s] has the force that the curve has there, and the zero is said to be known."""
    shown = float(np.interp(begin, pull.time, pull.force))
    return test.force_offset is not None and shown >= _SHOWN * paired.zero > 0.0
