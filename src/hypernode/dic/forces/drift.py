"""Whether the zero of the load cell is the same after the test as before it."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.checks import Finding
from hypernode.dic.forces.matching import PullRecord


@dataclass(frozen=True, kw_only=True)
class DriftLimits:
    """Where a reading after the test is a drift of the zero, and why there.

    Attributes:
        back: distance of the crosshead from its beginning, over its way, within which it is back.
        more, less: reading over the largest force. No sheet pulls more on its way back than on its first way to the
            same place, and load cells of class 1 leave a hundredth. A sheet that has become longer pushes until it
            buckles.
        rest: share of the largest force below which a force that stands after the test is that of a free sheet.
        samples: fewest that stand.
        scatter: of them over the largest force.
        slow: time of the second half of a fall over that of the first, above which a force has relaxed. An even fall
            has 1; an exponential one has 5.6 until ``scatter``, and this is the mean of both in the logarithm.
    """

    back: float = 0.02
    more: float = 0.03
    less: float = 0.1
    rest: float = 0.3
    samples: int = 5
    scatter: float = 0.01
    slow: float = 2.4


LIMITS = DriftLimits()


def drift_findings(test: SpecimenTest, pull: PullRecord) -> list[Finding]:
    """A sentence where the load cell reads a force after the test that no sheet carries then.

    A ``force_offset_uncertainty`` of as much says that it is known.
    """
    if pull.time is None or len(pull.force) < LIMITS.samples:
        return []
    share, where = drift_of(pull.force, pull.displacement, preloaded=test.force_offset is not None)
    if not where or abs(share) <= test.force_offset_uncertainty:
        return []
    more = "more" if share > 0.0 else "less"
    told = (
        f"{where} the load cell reads {abs(share):.0%} of the largest force {more} than on the way there: its zero "
        "seems to drift"
    )
    way_out = (
        ", and forces are off by up to as much. Take the drift out of the record, or say how well the zero is known, "
        f"--set force_offset_uncertainty={_rounded_up(abs(share))}"
    )
    if pull.displacement is None:
        told = f"{where} the load cell reads {share:.0%} of the largest force: does its zero drift, or does the sheet"
        way_out = (
            " still pull, held, relaxed or torn in part? If it was free, take the drift out of the record; if it still "
            "pulled, end the record with the pull"
        )
    return [Finding(told + way_out, False)]


def _rounded_up(share: float) -> str:
    """A share with two digits that is no less: what is advised is compared with it again."""
    unit = 10.0 ** (math.floor(math.log10(share)) - 1)
    return f"{math.ceil(share / unit) * unit:.2g}"


def drift_of(
    force: Float[np.ndarray, " sample"],
    displacement: Float[np.ndarray, " sample"] | None,
    limits: DriftLimits = LIMITS,
    preloaded: bool = False,
) -> tuple[float, str]:
    """(reading after the test over the largest force, words for when that is); no words where nothing drifts.

    Args:
        force: of the record, which begins with the sheet at rest [N].
        displacement: of the crosshead [mm], where it is recorded.
        limits: what counts as a drift.
        preloaded: whether the zero is known, so that the first force is a preload, which may be released.
    """
    peak, largest = int(np.argmax(force)), float(force.max())
    if not largest > 0.0:
        return 0.0, ""
    if displacement is not None and np.ptp(displacement) > 0.0:
        way = np.abs(displacement - displacement[0]) / np.abs(displacement - displacement[0]).max()
        back = np.flatnonzero(way[peak:] <= limits.back) + peak
        share = float(np.median(force[back] - _first_way(way, force, peak, back))) / largest if len(back) else 0.0
        share = _released(share, force[back], largest) if preloaded else share
        told = share > limits.more or share < -limits.less
        return share, "where the crosshead is back at its beginning" if told else ""
    last = force[peak + 1 :][-max(limits.samples, (len(force) - peak) // 5) :]
    if len(last) < limits.samples or np.ptp(last) > limits.scatter * largest:
        return 0.0, ""
    share = (float(np.median(last)) - float(force[0])) / largest
    share = _released(share, last, largest) if preloaded else share
    told = limits.more < share < limits.rest or -limits.rest < share < -limits.less
    fell = told and not _relaxes(force[peak:], float(np.median(last)), limits)
    return share, "after the test, where the force stands," if fell else ""


def _first_way(way, force, peak: int, back) -> Float[np.ndarray, " sample"]:
    """The force at places of the way back, as it was when the sheet was first there before the peak."""
    before = np.maximum.accumulate(way[: peak + 1])
    first = np.concatenate([[True], np.diff(before) > 0.0])
    return np.interp(way[back], before[first], force[: peak + 1][first])


def _released(share: float, standing, largest: float) -> float:
    """A share below the first force, counted from zero instead: a preload may go, and no more."""
    return share if share > 0.0 or not len(standing) else max(share, min(float(np.median(standing)) / largest, 0.0))


def _relaxes(falling: Float[np.ndarray, " sample"], stands: float, limits: DriftLimits) -> bool:
    """Whether a force, from its peak on, comes to where it stands ever more slowly, as in a sheet that is held."""
    over = (falling - stands) / falling[0]
    half = int(np.flatnonzero(over > 0.5 * over[0])[-1])
    end = int(np.flatnonzero(over > limits.scatter)[-1])
    full = int(np.flatnonzero(over > over[0] - limits.scatter)[-1])
    # A fall between two samples is sudden.
    return end - half > limits.slow * max(half - full, 1)
