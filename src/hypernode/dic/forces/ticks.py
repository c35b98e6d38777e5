"""Records whose clock or whose force is written anew less often than their samples."""

import numpy as np
from jaxtyping import Bool, Float

from hypernode.dic.forces.clock_times import spread

#: Share of the growth from tick to tick that samples of one tick must show to follow one another. All of it were it
#: for a clock that ticks, and nothing for readings of one instant.
_FOLLOW = 0.5
#: Fewest ticks or runs of one reading that show a rule, fewest samples of such a run, and share of runs that must be
#: as long as usual, but for a sample.
_RUNS, _HELD, _ALIKE = 3, 3, 0.8
#: Share of a digit, which is written with three figures, by which jumps of a force may differ from whole numbers of it.
_WHOLE = 0.01


def spread_ticks(time: Float[np.ndarray, " sample"], force: Float[np.ndarray, "sample axis"]):
    """Times of samples [s], evenly from tick to tick where the clock is coarser than the samples.

    Samples of one time whose force does not grow as it does from tick to tick are readings of one instant, and stay.

    Args:
        time: never decreasing [s].
        force: by sample and axis [N].
    """
    begins = np.flatnonzero(np.append(True, np.diff(time) > 0.0))
    ends = np.append(begins[1:], len(time)) - 1
    counts = ends - begins + 1
    if len(begins) < _RUNS + 2 or np.median(counts[1:-1]) < 2.0:
        return time
    pull = force[:, np.argmax(np.ptp(force, axis=0))]
    mean = np.add.reduceat(pull, begins) / counts
    grows, within = 0.5 * (mean[2:] - mean[:-2]), (pull[ends] - pull[begins])[1:-1]
    usual = np.median(counts[1:-1])
    if not within @ grows > _FOLLOW * (1.0 - 1.0 / usual) * (grows @ grows):
        return time
    new = np.array(spread(time.tolist()))
    # A clock that begins at zero does so with the record: if its first tick is shorter, it is rounded.
    return new - new[0] if time[0] == 0.0 else new


def read_anew(force: Float[np.ndarray, "sample axis"]) -> Bool[np.ndarray, " sample"]:
    """Which samples are readings of a load cell that is read less often than samples are written.

    A reading that is written again until the next one is none of these later times. Runs of one value that are not
    equally long are left. So are values of a load cell with few digits, whose force is near them all the time.

    Args:
        force: by sample and axis [N].
    """
    new = np.append(True, (np.diff(force, axis=0) != 0.0).any(axis=1))
    begins = np.flatnonzero(new)
    # A sheet at rest or held is no reading that is written again.
    runs = np.diff(begins)[1:]
    if len(runs) < _RUNS or (usual := np.median(runs)) < _HELD or (np.abs(runs - usual) <= 1.0).mean() < _ALIKE:
        return np.ones(len(force), dtype=bool)
    jumps = np.abs(np.diff(force[begins[1:]], axis=0)).max(axis=1)
    digits = jumps / jumps.min()
    if (np.abs(digits - np.round(digits)) < _WHOLE).all():
        return np.ones(len(force), dtype=bool)
    new[: begins[1]] = True
    new[-1] = True
    return new
