"""What the course of the forces that are missed says of its cause.

A wrong zero adds one force to every step. Pictures that belong to other forces add the rate of the force. A law that
stiffens otherwise misses a share that grows with the stretch. Every step tells the level, so that a common share is
never missed. What has none of these courses is scatter.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.measurement import mean_of_ends

#: Courses that a force may be missed by.
ZERO, PAIRING, LAW, SCATTER = "zero", "pairing", "law", "scatter"
#: Steps from which a course is told from scatter: the level, the course, and two that remain.
FEWEST = 4
#: Logarithm of the odds against scatter from which a course is seen: 20 to 1.
SEEN = 3.0
#: Share of the largest force below which a step says little: the zero alone may be as much.
SMALLEST = 0.03


@dataclass(frozen=True)
class Channel:
    """One force of one load case.

    Attributes:
        force: measured, positive in tension, by step.
        missed: measured less identified force.
        stretch: edge stretch of the step.
        time: of the step, or its number where no time is known.
    """

    force: Float[np.ndarray, " step"]
    missed: Float[np.ndarray, " step"]
    stretch: Float[np.ndarray, " step"]
    time: Float[np.ndarray, " step"]


def channels(measurement: xr.Dataset, identified: Float[np.ndarray, "step edge 2"]) -> list[Channel]:
    """Every force that was measured in steps enough.

    Args:
        measurement: opened file.
        identified: outward force on each edge.
    """
    measured, case = measurement["edge_force"].values, measurement["load_case"].values
    time = measurement["time"].values if "time" in measurement else np.arange(len(case), dtype=float)
    found = []
    for number in np.unique(case):
        for axis, i in np.ndindex(2, 2):
            pull, less = (mean_of_ends(F[case == number], axis, i) for F in (measured, measured - identified))
            known = np.isfinite(less)
            if known.sum() < FEWEST:
                continue
            force, missed, steps = pull[known], less[known], np.flatnonzero(case == number)[known]
            told = np.abs(force) > SMALLEST * np.abs(force).max()
            if told.sum() >= FEWEST:
                stretch = measurement["stretch"].values[steps]
                found.append(Channel(force[told], missed[told], stretch[told], time[steps][told]))
    return found


def courses(channel: Channel) -> dict[str, Float[np.ndarray, " step"]]:
    """What each cause adds to a force, over that force, without what is common to all steps."""
    rate = np.gradient(channel.force, channel.time)
    shares = {ZERO: 1.0 / channel.force, PAIRING: rate / channel.force, LAW: channel.stretch}
    return {name: share - share.mean() for name, share in shares.items()}


def probabilities(channel: Channel, known: float) -> dict[str, float]:
    """How probable each cause is of what one force is missed by, if one of them is the cause.

    The logarithm of the odds against scatter is n/2 ln(scatter before / after) - 1/2 ln n (Schwarz 1978). A course that
    is not seen is none.

    Args:
        known: relative uncertainty of a force that is scatter of the record.
    """
    y = channel.missed / channel.force
    y = y - y.mean()
    count, floor = len(y), known**2
    before, odds = float(np.mean(y**2)) + floor, {SCATTER: 0.0}
    for name, course in courses(channel).items():
        square = float(course @ course)
        # A course that is the same in all steps cannot be told.
        if square > 1e-12 * count:
            after = float(np.mean((y - course * (course @ y) / square) ** 2)) + floor
            gain = 0.5 * count * np.log(before / after) - 0.5 * np.log(count)
            odds |= {name: gain} if gain > SEEN else {}
    largest = max(odds.values())
    weights = {name: float(np.exp(value - largest)) for name, value in odds.items()}
    return {name: weight / sum(weights.values()) for name, weight in weights.items()}


def amplitude(channel: Channel, name: str) -> float:
    """How much of a cause is missed: the zero as a force, the lag as a time, the law as a share for all of the test."""
    course, y = courses(channel)[name], channel.missed / channel.force
    slope = float(course @ y) / float(course @ course)
    return slope * float(channel.stretch.max() - 1.0) if name == LAW else slope
