"""The noise of a test's load steps: stated in the configuration, or estimated from the frames."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.noise.between import between_frames
from hypernode.dic.noise.correlation import independent_factor
from hypernode.dic.noise.estimate import estimate_noise
from hypernode.dic.noise.local import local_fit
from hypernode.dic.noise.shared import FEWEST_STEPS, as_independent, belongs_to_the_sheet, not_shared, shared_by_steps
from hypernode.dic.series import Series
from hypernode.progress import say

#: Share of the variance of what differs from step to step, from which it is that of consecutive frames.
MOST = 0.5
#: Frames after the reference among which a sheet at rest is looked for.
FIRST_FRAMES = 10


@dataclass(frozen=True)
class StepNoise:
    """Errors of the displacements of load steps [mm].

    Attributes:
        scatter: standard deviation of a displacement.
        level: of equivalent independent errors; the errors themselves are correlated between points and between steps.
        source: their origin, one sentence.
        frames: the estimate from the frames if the configuration states another value; None without an estimate.
    """

    scatter: Float[np.ndarray, "step 2"]
    level: Float[np.ndarray, "step 2"]
    source: str
    frames: "StepNoise | None" = None


def noise_of(test: SpecimenTest, series: Series, numbers: Int[np.ndarray, " step"], mm: float) -> StepNoise:
    """The noise of a test's load steps; an estimate is written to the log.

    Args:
        test: its configuration; a stated noise counts as independent.
        series: the frames, in their unit.
        numbers: of the frames that are load steps.
        mm: length of that unit [mm].

    Raises:
        DicError: none is stated, and the frames give no estimate.
    """
    stated = test.stated_noise(mm)
    if stated is None:
        noise = _of_frames(series, numbers, mm)
        say("import", test.folder, noise.source)
        return noise
    level = np.full((len(numbers), 2), stated)
    said = f"the configuration gives a noise of displacements of {stated:.3g} mm"
    try:
        return StepNoise(level, level, said, _of_frames(series, numbers, mm))
    except DicError:
        return StepNoise(level, level, said)


def _of_frames(series: Series, numbers: Int[np.ndarray, " step"], mm: float) -> StepNoise:
    """What the frames tell of it.

    Raises:
        DicError: they tell nothing.
    """
    # Frames at rest are among the first; the others matter as far as they are load steps.
    seen = [frame for k, frame in enumerate(series.frames) if k <= FIRST_FRAMES or frame.number in numbers]
    displacement = np.stack([frame.displacement for frame in seen]) * mm
    steps = [k for k, frame in enumerate(seen) if frame.number in numbers]
    shared = shared_by_steps(displacement[steps])
    if belongs_to_the_sheet(displacement[steps], shared):
        estimate = estimate_noise(not_shared(displacement[steps]), ())
        every = list(range(len(steps)))
        scatter, level = (_believed(values, every) for values in (estimate.level, estimate.equivalent))
        said = f"load steps share {shared:.1%} of what is rough, which belongs to the sheet; the rest: {estimate} [mm]"
        return StepNoise(scatter, level, said)
    own, length = _differing(series, displacement[steps], mm)
    estimate = estimate_noise(displacement, length=length)
    scatter, level = (_believed(values, steps) for values in (estimate.level, estimate.equivalent))
    if own is not None:
        # What is rough only where the sheet is kinked was told from noise by what steps share.
        scatter, level = np.fmax(scatter, own), np.fmax(level, own * [independent_factor(one) for one in length])
        # Kinks add to what is told from signs, and chance to what is told from levels.
        shared = min(shared, float(np.nanmean(1.0 - (own / scatter) ** 2)))
        estimate = replace(estimate, level=scatter, equivalent=level)
    level = as_independent(level, shared)
    counted = f"{level.min():.2g} to {level.max():.2g} mm"
    said = f"{estimate} [mm]; load steps share {shared:.0%} of it, so that each counts as {counted}"
    return StepNoise(scatter, level, said)


def _differing(series: Series, steps: Float[np.ndarray, "step row column 2"], mm: float):
    """(level of what differs from step to step (step, 2), its lengths); None where frames do not tell.

    It is what a step does not share with those beside it. Differences of all frames in time tell it better, where most
    of it differs from frame to frame: what an engine does alike in consecutive frames may change from step to step.
    """
    own, length = local_fit(not_shared(steps)) if len(steps) >= FEWEST_STEPS else (None, None)
    # Too many points may be lost in one of three steps.
    own, length = (own, length) if own is not None and np.isfinite(own).any() else (None, None)
    between = between_frames([frame.displacement for frame in series.frames])
    if between is None or (own is not None and ((between[0] * mm) ** 2 < MOST * np.nanmedian(own, axis=0) ** 2).any()):
        return own, length
    return np.tile(between[0] * mm, (len(steps), 1)), between[1]


def _believed(values: Float[np.ndarray, "frame 2"], steps: list[int]) -> Float[np.ndarray, "step 2"]:
    """Values of the load steps; of one that says nothing, the mean of the frames that do."""
    return np.where(np.isfinite(values[steps]), values[steps], np.nanmean(values, axis=0))
