"""What of force records is a matter of time, told from the frames used and the machine's own motion."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.data.lost import along
from hypernode.dic.forces.matching import PullRecord
from hypernode.dic.frames import mean_stretch
from hypernode.dic.loadings import loadings
from hypernode.dic.series import Series
from hypernode.mechanics.loads import RESULTANTS, tensile_axis
from hypernode.mechanics.relaxation import ELASTIC, Course, Relaxation, fit_relaxation
from hypernode.progress import say

#: Fewest deformed frames from which the course of the stretch is known well enough to tell time from elasticity.
LEAST_FRAMES = 4
#: Fewest samples of the force record for the same.
LEAST_SAMPLES = 20
#: How much faster one test is than another at least, from which both tell time from elasticity. Paces that are nearer
#: change the force of a usual sheet, which relaxes by a tenth in a decade, by less than the load cell errs.
PACES_APART = 2.0


def course_of(test: SpecimenTest, series: Series, used: Series, pulls: dict) -> Course | None:
    """The force record over the stretch of the reference and of the frames used; None where time cannot be told.

    Between them, and beyond the last until the last picture, the crosshead tells how the stretch goes on, where the
    record has it. Frames after the first load step that are none themselves may serve as a test: neither their
    displacements nor their forces are seen.

    Args:
        test: what the configuration says.
        series, used: every frame that was read, and the reference with those used.
        pulls: records of the forces by component.
    """
    if not test.relaxation or not pulls:
        return None
    if tensile_axis(test.load) is None:
        # The elastic curve is that of uniaxial tension.
        say("import", test.folder, f"what of the force of a {test.load} test is a matter of time is not told")
        return None
    pull: PullRecord = pulls[RESULTANTS[test.load][0]]
    if pull.clock is None and pull.record.time is None:
        say("import", test.folder, "nothing tells the times of the frames: the sheet counts as elastic")
        return None
    every, numbers = mean_stretch(series, test.load), np.array([frame.number for frame in series.frames])
    later = numbers[loadings(every)[0].peak] < max(frame.number for frame in used.frames)
    if later and pull.displacement is None:
        say("import", test.folder, "no crosshead tells the course of the loadings before: the sheet counts as elastic")
        return None
    stretch = mean_stretch(used, test.load)
    known = np.isfinite(stretch) & (stretch > 0.0)
    observed = pull.times(np.array([frame.number for frame in used.frames]))[known]
    last = pull.times(np.array([max(frame.number for frame in series.frames)]))[0]
    time, course = _stretch_course(pull, observed, stretch[known], last)
    heard = numbers[pull.reached(numbers)]
    at, own = pull.times(heard), np.isin(heard, [frame.number for frame in used.frames])
    seen = not_held_out(time, at, own, observed[min(1, len(observed) - 1)])
    if known.sum() <= LEAST_FRAMES or seen.sum() < LEAST_SAMPLES:
        why = (
            f"{known.sum()} frames and {seen.sum()} samples of the force record are too few to tell relaxation "
            f"from elasticity (more than {LEAST_FRAMES} and at least {LEAST_SAMPLES}): "
            "the sheet counts as elastic"
        )
        say("import", test.folder, why)
        return None
    return Course(
        time=time,
        stretch=course,
        force=np.interp(time, pull.time, pull.force),
        steps=observed[1:],
        interval=float(np.median(np.diff(at))),
        seen=seen,
        gain=test.force_gain_uncertainty,
    )


def relaxations_of(tests: Sequence[SpecimenTest], courses: Sequence[Course | None]) -> list[Relaxation]:
    """What of the force of every test of a sheet is a matter of time.

    The slowest and the fastest test under one load decide together, where their paces are far enough apart. Every
    other test is judged by its own record.

    Args:
        tests: of the sheet.
        courses: of each, where it tells time.
    """
    found = {}
    for together in _by_pace(tests, courses):
        judged = fit_relaxation([courses[k] for k in together])
        found |= dict(zip(together, judged, strict=True))
        _say_what_was_found([tests[k] for k in together], judged)
    return [found.get(k, ELASTIC) for k in range(len(tests))]


def _by_pace(tests: Sequence[SpecimenTest], courses: Sequence[Course | None]) -> list[list[int]]:
    """Numbers of the tests that are judged together: the slowest and the fastest under a load, or one."""
    groups, told = [], [k for k, course in enumerate(courses) if course is not None]
    for load in dict.fromkeys(tests[k].load for k in told):
        ordered = sorted((k for k in told if tests[k].load == load), key=lambda k: courses[k].pace)
        slow, fast = ordered[0], ordered[-1]
        if courses[fast].pace >= PACES_APART * courses[slow].pace > 0.0:
            groups.append(sorted((slow, fast)))
            ordered = ordered[1:-1]
        groups += [[k] for k in ordered]
    return groups


def not_held_out(
    time: Float[np.ndarray, " sample"], at: Float[np.ndarray, " frame"], own: Bool[np.ndarray, " frame"], first: float
) -> Bool[np.ndarray, " sample"]:
    """Which samples of a record are not of frames that may serve as a test: a sample is of the frame nearest to it.

    Args:
        time: of the samples [s].
        at: times of the frames [s].
        own: which of them are used.
        first: time of the first load step, until which every sample counts [s].
    """
    return (time <= first) | own[np.abs(time[:, None] - at).argmin(axis=1)]


def _say_what_was_found(tests: Sequence[SpecimenTest], found: Sequence[Relaxation]) -> None:
    first, factor = found[0], max(each.factor.max() for each in found)
    what = f"the force relaxes, from {factor:.3g} times the relaxed one on" if first.found else "the sheet is elastic"
    if not first.found and len(found) == 1:
        what = "the sheet counts as elastic"
    odds = f"{np.exp(min(abs(first.odds), 20.0)):.2g} to 1 {'for' if first.odds > 0.0 else 'against'} relaxation"
    spread = np.sqrt(np.mean(np.concatenate([each.open for each in found]) ** 2))
    whose = "the record has" if len(found) == 1 else "two paces have"
    say(
        "import",
        " and ".join(test.folder for test in tests),
        f"{what}: {whose} evidence of {odds}, and leave{'s' if len(found) == 1 else ''} {spread:.1%} of it open",
    )


def _stretch_course(pull: PullRecord, observed, stretch, last: float):
    """(times of the record's samples, mean stretch there), from the times and stretches of the frames used.

    Args:
        last: time of the last picture, until which the crosshead is believed to pull the sheet.
    """
    time, moved = pull.time, None
    if pull.displacement is not None:
        moved = np.interp(observed, time, pull.displacement)
    if moved is not None and len(moved) > 1 and (np.diff(moved) > 0.0).all():
        during = time[(time >= observed[0]) & (time <= last)]
        return during, along(np.interp(during, time, pull.displacement), moved) @ stretch
    during = time[(time >= observed[0]) & (time <= observed[-1])]
    return during, np.interp(during, observed, stretch)
