"""Whether the zero of the load cell is the same after the test as before it."""

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
        back: distance of the crosshead from its beginning, over its way, within which it is back. An elastic sheet has
            a fiftieth of its force there.
        more, less: reading over the largest force. No sheet pulls more after the test than before it, and load cells of
            class 1 leave a hundredth. A sheet that has become longer pushes until it buckles.
        rest: share of the largest force below which a force that stands after the test is that of a free sheet.
        samples: fewest that stand.
        scatter: of them over the largest force.
    """

    back: float = 0.02
    more: float = 0.03
    less: float = 0.1
    rest: float = 0.3
    samples: int = 5
    scatter: float = 0.01


LIMITS = DriftLimits()


def drift_findings(test: SpecimenTest, pull: PullRecord) -> list[Finding]:
    """A sentence where the load cell reads a force after the test that no sheet carries then.

    A ``force_offset_uncertainty`` of as much says that it is known.
    """
    if pull.time is None or len(pull.force) < LIMITS.samples:
        return []
    share, where = drift_of(pull.force, pull.displacement)
    if not where or abs(share) <= test.force_offset_uncertainty:
        return []
    return [
        Finding(
            f"{where} the load cell reads {share:.0%} of the largest force: its zero seems to drift, and forces are "
            "off by up to as much. Take the drift out of the record, or say how well the zero is known, --set "
            f"force_offset_uncertainty={abs(share):.2g}",
            False,
        )
    ]


def drift_of(
    force: Float[np.ndarray, " sample"],
    displacement: Float[np.ndarray, " sample"] | None,
    limits: DriftLimits = LIMITS,
) -> tuple[float, str]:
    """(reading after the test over the largest force, words for when that is); no words where nothing drifts.

    Args:
        force: of the record, which begins with the sheet at rest [N].
        displacement: of the crosshead [mm], where it is recorded.
        limits: what counts as a drift.
    """
    peak, largest = int(np.argmax(force)), float(force.max())
    if not largest > 0.0:
        return 0.0, ""
    if displacement is not None and np.ptp(displacement) > 0.0:
        way = np.abs(displacement - displacement[0]) / np.abs(displacement - displacement[0]).max()
        back = np.flatnonzero(way[peak:] <= limits.back) + peak
        share = (float(np.median(force[back])) - float(force[0])) / largest if len(back) else 0.0
        told = share > limits.more or share < -limits.less
        return share, "where the crosshead is back at its beginning" if told else ""
    last = force[peak + 1 :][-max(limits.samples, (len(force) - peak) // 5) :]
    if len(last) < limits.samples or np.ptp(last) > limits.scatter * largest:
        return 0.0, ""
    share = (float(np.median(last)) - float(force[0])) / largest
    told = limits.more < share < limits.rest or -limits.rest < share < -limits.less
    return share, "after the test, where the force stands," if told else ""
