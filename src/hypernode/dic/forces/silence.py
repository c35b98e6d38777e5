"""When a record says nothing of the force: in its gaps, and while its value stands and the sheet is pulled on."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from hypernode.dic.forces.matching import PullRecord, Silence


@dataclass(frozen=True, kw_only=True)
class SilenceLimits:
    """Where a record counts as silent, and why there.

    Attributes:
        samples: a gap is longer than so many usual distances of samples; recorders skip one or two when they are busy.
        share: of the whole motion of the sheet that may pass between two samples. A straight line through two points of
            a curve is off by an eighth of what its slope changes by between them, so by about a hundredth here.
        counts: a value stands while the force would have changed by so many of its smallest steps; a coarse recorder
            repeats one step until the next.
        rise: the same as a share of the range of the record; what is less makes no difference.
        steeper: the force is taken to go on by so much more than before at most: at the end of a rest nothing is known.
        samples_of_steps: fewest samples whose smallest difference is a step of the recorder and not the sheet's.
    """

    samples: float = 3.0
    share: float = 0.1
    counts: float = 3.0
    rise: float = 0.02
    steeper: float = 3.0
    samples_of_steps: int = 20


LIMITS = SilenceLimits()


def with_silences(
    pull: PullRecord,
    frame_time: Float[np.ndarray, " frame"],
    stretch: Float[np.ndarray, " frame"],
    limits: SilenceLimits = LIMITS,
) -> PullRecord:
    """The record with further times at which it is silent, and without the samples that only repeat a value.

    Args:
        pull: the record.
        frame_time: of the frames whose stretch is known, increasing [s].
        stretch: of each.
        limits: what counts as silent.
    """
    if len(frame_time) < 2 or len(pull.time) < 2:
        return pull
    moved = np.interp(pull.time, frame_time, stretch)
    if pull.displacement is not None and np.ptp(pull.displacement) > 0.0:
        moved = pull.displacement
    found, stands = _standing(pull.time, pull.force, moved, limits)
    silences = [*pull.silences, *found]
    if pull.image is None:
        interval = float(np.median(np.diff(frame_time)))
        silences += _gaps(pull.time, frame_time, stretch, interval, limits)
    if pull.image is not None:
        # Every picture keeps its samples, by which its time is known.
        return replace(pull, silences=tuple(silences))
    told = ~stands
    displacement = None if pull.displacement is None else pull.displacement[told]
    return replace(
        pull, time=pull.time[told], force=pull.force[told], displacement=displacement, silences=tuple(silences)
    )


def not_used(numbers, unheard: dict[int, str]) -> str:
    """A sentence on the frames without a force."""
    reasons = "; ".join(dict.fromkeys(unheard.values()))
    shown = ", ".join(map(str, list(unheard)[:8])) + (", ..." if len(unheard) > 8 else "")
    return f"{reasons}: {len(unheard)} of {len(numbers)} frames have no force and are no load steps ({shown})"


def _gaps(time, frame_time, stretch, interval: float, limits: SilenceLimits) -> list[Silence]:
    """Distances of samples that are longer than a frame, and than usual or than the sheet's motion allows.

    Before the first frame and after the last one the sheet is taken to move on as within the same distance.
    """
    apart = np.diff(time)
    seen = np.diff(np.clip(time, frame_time[0], frame_time[-1]))
    moved = np.abs(np.diff(np.interp(time, frame_time, stretch)))
    moved = np.divide(moved * apart, seen, out=np.zeros_like(moved), where=seen > 0.0)
    far = moved > limits.share * np.ptp(stretch)
    wide = (apart > 1.001 * interval) & (far | (apart > limits.samples * np.median(apart)))
    return [
        Silence(time[k], time[k + 1], f"the record has no sample from {time[k]:.4g} to {time[k + 1]:.4g} s")
        for k in np.flatnonzero(wide)
    ]


def _standing(time, force, moved, limits: SilenceLimits) -> tuple[list[Silence], Bool[np.ndarray, " sample"]]:
    """(silences while one value stands, which samples repeat it); the first of them is a reading still."""
    found, stands = [], np.zeros(len(force), dtype=bool)
    least = max(limits.counts * _smallest_step(force, limits), limits.rise * float(np.ptp(force)))
    begins = np.flatnonzero(np.append(True, np.diff(force) != 0.0))
    ends = np.append(begins[1:], len(force)) - 1
    for begin, end in zip(begins, ends, strict=True):
        if begin == 0 or time[end] == time[begin]:
            continue
        before = min(int(np.searchsorted(time, time[begin] - (time[end] - time[begin]))), begin - 1)
        pulled = moved[begin] - moved[before]
        if pulled == 0.0:
            continue
        further = np.abs(moved[begin : end + 1] - moved[begin]).max() / abs(pulled)
        if abs(force[begin] - force[before]) * min(further, limits.steeper) <= least:
            continue
        stands[begin + 1 : end + 1] = True
        last = end == len(force) - 1
        top = "; the load cell is at its limit" if force[begin] == force.max() else ""
        top += ", or frames were taken earlier than is said (frame_rate)" if top and last else ""
        until = "on" if last else f"to {time[end]:.4g} s"
        why = f"the force stands at {force[begin]:.4g} N from {time[begin]:.4g} s {until}, and the sheet is pulled on"
        found.append(Silence(time[begin], np.inf if last else time[end], why + top, closed=True))
    return found, stands


def _smallest_step(force, limits: SilenceLimits) -> float:
    """Smallest step of the recorder, as its digits and the differences of its values show it."""
    largest = float(np.abs(force).max())
    if largest == 0.0:
        return 0.0
    decade = int(np.floor(np.log10(largest)))
    units = (digit * 10.0**power for power in range(decade, decade - 10, -1) for digit in (5, 2, 1))
    step = next((unit for unit in units if np.abs(force / unit - np.round(force / unit)).max() < 1e-4), 0.0)
    apart = np.diff(np.unique(force))
    return max(step, float(apart.min())) if len(force) >= limits.samples_of_steps and len(apart) else step
