"""Records in the clock of the pictures, as far as keys, the crosshead, and the curve of force and stretch tell it."""

from dataclasses import replace

import numpy as np

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.forces.checks import Finding
from hypernode.dic.forces.clock import ONSET, ClockOffset, agreed_offset, begins_above, check_clock, estimate_offsets
from hypernode.dic.forces.lag import without_lag
from hypernode.dic.forces.matching import Component, PullRecord, best_told
from hypernode.dic.frames import first_loading, working_stretch
from hypernode.dic.series import Series


def on_one_clock(test: SpecimenTest, pulls: dict[Component, PullRecord], series: Series):
    """(the pulls in the clock of the pictures as far as it is told, what is strange about it).

    Raises:
        DicError: the offset is to be estimated, and nothing tells it.
    """
    part = best_told(pulls)
    pull, given = pulls[part], test.force_time_offset
    if pull.image is not None:
        return pulls, []
    numbers, stretch = first_loading(series, working_stretch(series, test.load, *part))
    moved, findings = without_lag(test, pulls, series)
    time = moved[part].times(numbers)
    offsets = estimate_offsets(time, stretch, pull.time, pull.force, pull.displacement)
    if given != "estimate":
        interval = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
        # The curve of a whole pull tells more of the clock than where it begins, and a preload begins nowhere.
        begins = not findings and (test.force_offset is None or not begins_above(pull.time, pull.force, float(time[0])))
        told = [each for each in offsets if begins or each.by != ONSET]
        return moved, findings + check_clock(told, interval, given is not None)
    seconds, sentence = _estimated(pull, offsets)
    clock = pull.clock.later(seconds)
    return {key: replace(each, clock=clock) for key, each in pulls.items()}, [Finding(sentence, False)]


def _estimated(pull: PullRecord, offsets: list[ClockOffset]) -> tuple[float, str]:
    """(estimated offset of the record's clock [s], the sentence that says so)."""
    offset = agreed_offset(offsets)
    if offset is None:
        told = " and ".join(map(str, offsets)) or "neither the crosshead nor the onset of the force tells it"
        raise DicError(f"{pull.record.path}: force_time_offset: estimate: {told}: give the offset in seconds")
    return offset.seconds, f"offset of the force record: {offset}"
