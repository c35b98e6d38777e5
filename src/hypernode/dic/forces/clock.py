"""The clock of a record against that of the pictures, from what both saw of one motion."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.dic.forces.checks import LIMITS, Finding, ForceLimits
from hypernode.dic.loadings import Loading, loadings

#: Offsets that are tried, in a frame interval.
_LAGS = 10
#: Shares of the largest force between which its onset is a straight line.
_ONSET = (0.05, 0.1)
#: Correlation that is given to an offset at which one of the two does not move.
_UNSEEN = -1.0
#: What an estimate was told from that compares where force and stretch begin.
ONSET = "onset of force"


@dataclass(frozen=True)
class ClockOffset:
    """How far the record's clock is ahead of the frames', once their known times are taken away.

    Attributes:
        seconds: record's time less the frames' [s].
        uncertainty: its standard deviation [s].
        by: what it was told from.
        agreement: correlation of the two courses there.
    """

    seconds: float
    uncertainty: float
    by: str
    agreement: float = 1.0

    def __str__(self) -> str:
        return f"{self.seconds:+.2g} s, uncertain by {self.uncertainty:.1g} s (from the {self.by})"


def estimate_offsets(
    frame_time: Float[np.ndarray, " frame"],
    stretch: Float[np.ndarray, " frame"],
    time: Float[np.ndarray, " sample"],
    force: Float[np.ndarray, " sample"],
    displacement: Float[np.ndarray, " sample"] | None,
    limits: ForceLimits = LIMITS,
) -> list[ClockOffset]:
    """The offset of the record: from the crosshead's motion where it moves, and from the onset of the force.

    A record that begins under way shows the crosshead at one pace only, and its force begins with a value.

    Args:
        frame_time: in the record's clock as it is believed to be, increasing [s].
        stretch: mean stretch, 1 at the first frame, the reference.
        time, force, displacement: the record [s, N, mm].
        limits: below which sharpness the onset of the force tells nothing.

    Returns:
        The estimates that there are, the better one first.
    """
    if len(frame_time) < 3 or not np.ptp(stretch) > 0.0:
        return []
    onset = _from_onset(frame_time, stretch, time, force, limits)
    moves = displacement is not None and np.ptp(displacement) > 0.0
    rates = _from_rates(frame_time, stretch, time, displacement) if moves else None
    return [each for each in (rates, onset) if each is not None]


def _from_rates(frame_time, stretch, time, displacement) -> ClockOffset | None:
    """Largest cross-correlation of the rates of stretch and displacement between frames.

    None where the crosshead is at rest at every offset that is tried. Before the reference the sheet is at rest, before
    the record the machine is: this pins a pull at one pace.
    """
    interval = float(np.median(np.diff(frame_time)))
    # Half of the test, and no further than there are frames, of which some may be far apart.
    reach = max(min(0.5 * (frame_time[-1] - frame_time[0]), len(frame_time) * interval), 3.0 * interval)
    rest = frame_time[0] - interval * np.arange(np.ceil(reach / interval), 0, -1)
    at = np.concatenate([rest, frame_time])
    pace = np.diff(np.concatenate([np.full(len(rest), stretch[0]), stretch])) / np.sqrt(np.diff(at))
    lags = interval / _LAGS * np.arange(-np.floor(_LAGS * reach / interval), np.floor(_LAGS * reach / interval) + 1)
    agreement = np.array([_agreement(at, pace, lag, time, displacement) for lag in lags])
    best = int(np.argmax(agreement))
    if agreement[best] <= _UNSEEN:
        return None
    # Frames are as independent as their noise: the misfit of n of them doubles one n-th above its least.
    misfit = np.clip(1.0 - agreement**2, 0.0, None)
    low, high = max(best - _LAGS, 0), min(best + _LAGS, len(lags) - 1)
    rise = max(0.5 * (misfit[low] + misfit[high]) - misfit[best], 1e-12)
    statistical = interval * np.sqrt(misfit[best] / (rise * len(frame_time)))
    uncertainty = float(np.hypot(interval / np.sqrt(12.0), statistical))
    return ClockOffset(float(lags[best]), uncertainty, "crosshead", float(agreement[best]))


def _agreement(at, pace, lag, time, displacement) -> float:
    """Correlation of the rates, the record's taken ``lag`` later, over the frames that it reaches."""
    within = at + lag <= time[-1]
    moved = (np.diff(np.interp(at + lag, time, displacement)) / np.sqrt(np.diff(at)))[within[1:]]
    seen = pace[within[1:]]
    size = np.sqrt((seen @ seen) * (moved @ moved))
    return float(seen @ moved / size) if size > 0.0 and within.sum() > 0.5 * len(at) else _UNSEEN


def _from_onset(frame_time, stretch, time, force, limits) -> ClockOffset | None:
    """Onset of the force less that of the stretch, both straight lines through small shares of the largest value."""
    during = (time >= frame_time[0]) & (time <= frame_time[-1])
    largest = force[during].max(initial=0.0)
    if during.sum() < 3 or largest <= 0.0:
        return None
    loading = _loading_of_frames(frame_time, time, force)
    if loading is None or force[loading.peak] < 0.5 * largest:
        return None
    time, force, during = (each[loading.start : loading.peak + 1] for each in (time, force, during))
    if len(force) < 3 or not during.any():
        return None
    (low, doubt), (high, _) = (_crossing(time, force, share * largest) for share in _ONSET)
    stretched = stretch - stretch[0]
    first, second = (_crossing(frame_time, stretched, share * stretched.max())[0] for share in _ONSET)
    if high <= low or second <= first:
        return None
    onset = low - (high - low) * _ONSET[0] / (_ONSET[1] - _ONSET[0])
    begin = first - (second - first) * _ONSET[0] / (_ONSET[1] - _ONSET[0])
    end = time[during][int(np.argmax(force[during]))]
    sharpness = (_ONSET[1] - _ONSET[0]) / (high - low) * (end - onset)
    offset = onset - begin
    if offset > 0.0 and sharpness < limits.least_sharpness:
        return None
    interval = float(np.median(np.diff(frame_time)))
    uncertainty = np.linalg.norm([interval / np.sqrt(12.0), 0.5 * (low - onset), doubt])
    return ClockOffset(float(offset), float(uncertainty), ONSET)


def _loading_of_frames(frame_time, time, force) -> Loading | None:
    """The first loading of a record whose peak is not before the frames; None where all are before them."""
    found = [each for each in loadings(force) if time[each.peak] > frame_time[0]]
    return found[0] if found else None


def begins_above(time: Float[np.ndarray, " sample"], force: Float[np.ndarray, " sample"], begin: float) -> bool:
    """Whether a force is beyond its onset already at a time."""
    return bool(np.interp(begin, time, force) > _ONSET[0] * force[time >= begin].max(initial=0.0) > 0.0)


def _crossing(time, course, level) -> tuple[float, float]:
    """(time at which a course rises to a level, half the time over which noise takes it across).

    A course that begins above the level is continued backwards by its first slope that is clear.
    """
    below = np.flatnonzero(course[: int(np.argmax(course)) + 1] < level)
    if len(below):
        last = below[-1]
        late = time[last] + (level - course[last]) / (course[last + 1] - course[last]) * (time[last + 1] - time[last])
        early = min(time[int(np.argmax(course >= level))], late)
        return float(0.5 * (early + late)), float(0.5 * (late - early))
    clear = int(np.argmax(course >= course[0] + level))
    if clear == 0 or time[clear] == time[0]:
        return float(time[0]), 0.0
    return float(time[0] - (course[0] - level) * (time[clear] - time[0]) / (course[clear] - course[0])), 0.0


def check_clock(
    offsets: list[ClockOffset], interval: float, accepted: bool, limits: ForceLimits = LIMITS
) -> list[Finding]:
    """The clocks agree within some frame intervals and within what the estimate can tell.

    Args:
        offsets: as estimated.
        interval: between frames [s].
        accepted: whether the configuration gives the offset, so that a disagreement is only worth a warning.
        limits: how far they may differ.
    """
    alike = [each for each in offsets if each.agreement >= limits.least_agreement]
    findings = [
        Finding(
            f"the {each.by} of the record moves unlike the sheet at any offset of their clocks (correlation "
            f"{each.agreement:.2f}): the record of another specimen, or another frame_rate",
            False,
        )
        for each in offsets
        if each not in alike
    ]
    least = limits.clock_intervals * interval
    apart = [each for each in alike if abs(each.seconds) > max(least, limits.clock_deviations * each.uncertainty)]
    if apart:
        findings.append(
            Finding(
                f"the record's clock is off that of the pictures by {' and by '.join(map(str, apart))}: set "
                "first_frame_time, or force_time_offset to seconds, to estimate, or to 0 if the clocks are right and "
                "the sheet was loaded before its reference frame; a zero of the load cell that is off looks the "
                "same, and force_offset takes it",
                not accepted,
            )
        )
    return findings


def agreed_offset(offsets: list[ClockOffset], limits: ForceLimits = LIMITS) -> ClockOffset | None:
    """The first estimate, where there is one and no other contradicts it."""
    offsets = [each for each in offsets if each.agreement >= limits.least_agreement]
    for other in offsets[1:]:
        apart = limits.clock_deviations * np.hypot(offsets[0].uncertainty, other.uncertainty)
        if abs(offsets[0].seconds - other.seconds) > apart:
            return None
    return offsets[0] if offsets else None
