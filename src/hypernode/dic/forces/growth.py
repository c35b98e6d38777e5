"""Whether the force goes on as long as the stretch does: a curve that stands is of frames taken at other times."""

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.checks import Finding
from hypernode.dic.forces.matching import Component, PullRecord
from hypernode.dic.frames import first_loading, working_stretch
from hypernode.dic.series import Series

#: Share of the whole stretch over which the end of a curve is looked at.
_END = 0.25
#: Growth over that end, over the mean one, below which the force stands. A sheet of rubber at three times its length
#: has three quarters, one that loses its stiffness to damage a third.
_STANDS = 0.1
#: Fewest frames of the end, and before it.
_FEWEST = 3


def growth_findings(test: SpecimenTest, pull: PullRecord, series: Series, part: Component) -> list[Finding]:
    """What is strange about the end of a test's first loading, as far as the record tells its force."""
    numbers, course = first_loading(series, working_stretch(series, test.load, *part))
    told = pull.reached(numbers)
    return check_growth(course[told], pull.forces(numbers[told])) if told.any() else []


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
