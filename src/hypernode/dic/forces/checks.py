"""Forces that no sheet can give: findings, each a sentence with what was observed.

Every check is a pure function of the frames up to the last load step. What no elastic sheet and no machine can give is
refused; what is strange only is a warning.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a record: a sentence, and whether the record is refused for it.

    ``explains``: whether it is said with what is refused, since it may be the cause.
    """

    sentence: str
    refused: bool
    explains: bool = False


@dataclass(frozen=True, kw_only=True)
class ForceLimits:
    """Where a force becomes implausible, and why there.

    Attributes:
        least_rise: change of the force over its largest value below which it counts as constant. Sheets pulled from
            rest change by all of it; load cells drift by less than a hundredth.
        begins: share of the largest force at which it has begun. Noise and drift stay below a hundredth.
        least_correlation: of force and stretch. An exponential stiffening to a hundredfold modulus has 0.6 at equal
            steps, noise of n frames has 0 within 1/sqrt(n).
        force_at_rest: share of the largest force that the reference frame may carry. A preload is a tenth of the test
            at most where the reference still counts as free of stress.
        zero_at_rest: the same of a reading that nobody explained. Load cells of class 1 are zero within a thousandth,
            and a sheet that begins to be pulled between two frames reads a hundredth.
        goes_on: largest force after the last frame over that until then. Pictures that end with the test miss what the
            sheet is pulled on in a frame; a frame rate of twice the true one misses half.
        unit_jump: how far the ratio of neighbouring samples may be from a power of ten, in decades: the sheet pulls
            on between two samples.
        jump_over_neighbours: a step between two samples over the largest of three before and after it. A steep curve
            or a slow recorder doubles it; a unit multiplies it by 9 at least.
        samples_of_a_jump: fewest steps between samples among which one may stand out.
        jump_share: a step over the largest force; smaller ones are contact, stick and slip.
        stiffening, impossible_stiffening: largest over smallest secant stiffness of the steps beyond the first. Rubber
            has 3, skin 30; only a unit or a wrong channel has 300.
        softest, stiffest: secant stiffness [MPa]. A sheet below 0.01 MPa tears under its own clamps; carbon fibres
            along the pull have 3e5 MPa.
        clock_intervals, clock_deviations: frame intervals, and standard deviations of the estimate, by which the clocks
            may differ. Pictures and record are started by hand within some frames.
        least_sharpness: force rate at its onset over its mean rate. Below it, a late force may be the toe of a
            stiffening curve, and says nothing of clocks.
        least_agreement: correlation of rates below which two courses are not of one motion.
    """

    least_rise: float = 0.05
    begins: float = 0.02
    least_correlation: float = 0.3
    force_at_rest: float = 0.1
    zero_at_rest: float = 0.03
    goes_on: float = 1.25
    unit_jump: float = 0.05
    jump_over_neighbours: float = 5.0
    samples_of_a_jump: int = 8
    jump_share: float = 0.2
    stiffening: float = 30.0
    impossible_stiffening: float = 300.0
    softest: float = 0.01
    stiffest: float = 3e5
    flowing: float = 300.0
    stretched: float = 1.05
    clock_intervals: float = 3.0
    clock_deviations: float = 3.0
    least_sharpness: float = 0.5
    least_agreement: float = 0.8


LIMITS = ForceLimits()


def check_rise(
    stretch: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"], limits: ForceLimits = LIMITS
) -> list[Finding]:
    """The force [N] changes with the stretch, and in its direction."""
    if len(force) < 2 or np.ptp(stretch) == 0.0:
        return []
    course = f"while the stretch goes from {stretch.min():.4g} to {stretch.max():.4g}"
    largest = np.abs(force).max()
    if np.ptp(force) <= limits.least_rise * largest:
        return [
            Finding(
                f"the force stays between {force.min():.4g} and {force.max():.4g} N {course}: another channel, "
                "a load cell that was not connected, or a zero that force_offset must take away",
                True,
            )
        ]
    correlation = np.corrcoef(stretch, force)[0, 1]
    if correlation >= limits.least_correlation:
        return []
    seen = f"from {force[np.argmin(stretch)]:.4g} to {force[np.argmax(stretch)]:.4g} N {course}"
    if correlation > -limits.least_correlation:
        return [
            Finding(
                f"the force does not follow the stretch ({seen}, correlation {correlation:.2f}): another channel, "
                "--set force_channel=NAME, or frames of other times, --set first_frame_time=SECONDS or --frame-rate HZ",
                True,
            )
        ]
    return [
        Finding(
            f"the force falls {seen}: the sign of the record or its channel is wrong; export tension, and shear to the "
            "right, as positive, turn it, --set force_factor=-1, or set force_channel",
            True,
        )
    ]


def check_reach(
    frame_time: Float[np.ndarray, " frame"],
    time: Float[np.ndarray, " sample"],
    force: Float[np.ndarray, " sample"],
    limits: ForceLimits = LIMITS,
) -> list[Finding]:
    """The machine pulls [N] while the frames are taken, and not at other times of its record [s] only."""
    begin, end = frame_time.min(initial=np.inf), frame_time.max(initial=-np.inf)
    during = force[(time >= begin) & (time <= end)]
    peak = int(np.argmax(force))
    if not during.size or begin <= time[peak] <= end or np.ptp(during) > limits.least_rise * np.ptp(force):
        return []
    below = np.flatnonzero(force[:peak] - np.median(during) < limits.begins * (force[peak] - np.median(during)))
    starts = f" (the force begins at about {time[below[-1]]:.3g} s)" if len(below) else ""
    return [
        Finding(
            f"from {begin:.4g} to {end:.4g} s, when the frames are taken, the force stays between {during.min():.4g} "
            f"and {during.max():.4g} N, and at {time[peak]:.4g} s it is {force[peak]:.4g} N: set first_frame_time to "
            f"the time of the first frame in the clock of the record, --set first_frame_time=SECONDS{starts}, and "
            "check frame_rate",
            True,
        )
    ]


def check_end(
    end: float, time: Float[np.ndarray, " sample"], force: Float[np.ndarray, " sample"], limits: ForceLimits = LIMITS
) -> list[Finding]:
    """The force [N] does not go on to grow after the last frame [s], as it does where frames are taken too early."""
    later = np.where(time > end, force, -np.inf)
    peak, until = int(np.argmax(later)), force[time <= end].max(initial=0.0)
    if not until > 0.0 or later[peak] <= limits.goes_on * until:
        return []
    return [
        Finding(
            f"after the last frame, at {end:.4g} s, the force goes on from {until:.4g} to {force[peak]:.4g} N at "
            f"{time[peak]:.4g} s: pictures that ended before the test, or a frame_rate that is too large",
            False,
        )
    ]


def check_rest(
    force: Float[np.ndarray, " frame"], explained: bool = True, limits: ForceLimits = LIMITS
) -> list[Finding]:
    """The reference, the first of the frames, carries no force [N]: it is the state without stress.

    Args:
        force: of the frames, without the reading at rest that is known.
        explained: whether the configuration says what the record reads at rest.
        limits: what counts as a force.
    """
    largest = np.abs(force[1:]).max(initial=0.0)
    share = abs(force[0]) / largest if len(force) > 1 and largest > 0.0 else 0.0
    if share <= (limits.force_at_rest if explained else limits.zero_at_rest):
        return []
    sentence = f"the force at the reference frame is {force[0]:.4g} N, {share:.0%} of the largest: "
    if explained:
        return [Finding(sentence + "a preload, a zero for force_offset, or a clock for first_frame_time", False)]
    return [
        Finding(
            f"{sentence}is it the zero of the load cell, --set force_offset={force[0]:.4g}; a preload, whose forces "
            "are then those of the same stretch from rest, --set force_offset=0; or is the sheet pulled already, so "
            "that the clocks differ, --set first_frame_time=SECONDS?",
            True,
        )
    ]


def check_jumps(
    time: Float[np.ndarray, " sample"], force: Float[np.ndarray, " sample"], limits: ForceLimits = LIMITS
) -> list[Finding]:
    """The force [N] does not jump between two samples by far more than between those around them, to stay or back."""
    steps = np.abs(np.diff(force))
    if len(steps) < limits.samples_of_a_jump:
        return []
    padded = np.pad(steps, 3)
    around = np.max([padded[k : k + len(steps)] for k in (0, 1, 5, 6)], axis=0)
    usual = np.median(steps[steps > 0.0]) if steps.any() else 0.0
    least = np.maximum(limits.jump_over_neighbours * np.maximum(around, usual), limits.least_rise * np.abs(force).max())
    # Across a gap the force goes on, and by as much as it is long.
    apart = np.diff(time)
    jumps = np.flatnonzero((steps > least) & (apart < 2.0 * np.median(apart)))
    if not len(jumps):
        return []
    at = jumps[0]
    return [
        Finding(
            f"the force jumps from {force[at]:.4g} to {force[at + 1]:.4g} N at {time[at + 1]:.4g} s, by more than "
            f"{limits.jump_over_neighbours:g} times what it does before and after: a spike, a slip, or a zero that was "
            "set anew; --set 'frames=[...]' chooses load steps elsewhere",
            False,
            explains=True,
        )
    ]


def check_units(
    time: Float[np.ndarray, " sample"], force: Float[np.ndarray, " sample"], limits: ForceLimits = LIMITS
) -> list[Finding]:
    """No sample [N] is a power of ten times the one before it."""
    steps = np.abs(np.diff(force))
    ratio = np.divide(force[1:], force[:-1], out=np.zeros_like(steps), where=force[:-1] != 0.0)
    decades = np.log10(ratio, out=np.zeros_like(steps), where=ratio > 0.0)
    power = np.round(decades)
    padded = np.pad(steps, 3)
    around = np.max([padded[k : k + len(steps)] for k in (0, 1, 2, 4, 5, 6)], axis=0)
    jumps = (power != 0) & (np.abs(decades - power) <= limits.unit_jump)
    jumps &= (steps > limits.jump_over_neighbours * around) & (steps > limits.jump_share * np.abs(force).max())
    if len(steps) < 3 or not jumps.any():
        return []
    at = int(np.argmax(jumps))
    return [
        Finding(
            f"the force jumps from {force[at]:.4g} to {force[at + 1]:.4g} N at {time[at + 1]:.4g} s, a factor of "
            f"{10 ** abs(power[at]):g} between two samples: the unit changes, or a sign of thousands is taken for a "
            "decimal one",
            True,
        )
    ]
