"""One test of a specimen: its frames on a grid in mm, and the forces of its load steps."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.config.specimens import Specimen
from hypernode.dic.camera_growth import grown_at_rest, grown_ends, without_growth
from hypernode.dic.camera_motion import camera_motion, without
from hypernode.dic.forces.checks import Finding
from hypernode.dic.forces.exchanged import exchanged_forces
from hypernode.dic.forces.importing import Heard, hear_forces, import_forces
from hypernode.dic.forces.matching import Component
from hypernode.dic.frame_clock import frame_clock, times_contradicted
from hypernode.dic.frames import mean_stretch, select_frames, several_loadings, trimmed
from hypernode.dic.increments import said_without_force
from hypernode.dic.narrowing import unlike_positions
from hypernode.dic.noise.steps import StepNoise, noise_of
from hypernode.dic.reading import read_test
from hypernode.dic.relaxing import course_of
from hypernode.dic.series import Series
from hypernode.mechanics.loads import CONSTRAINED, tensile_axis
from hypernode.mechanics.relaxation import ELASTIC, Course, Relaxation
from hypernode.progress import say


@dataclass(frozen=True, kw_only=True)
class LoadCase:
    """One test, in mm, N and s, y upward, on the lines of its own grid.

    Attributes:
        test: what the configuration says of it.
        x, y: lines of the grid, from the corner of the whole measured field.
        size: of that field, before the outermost points were dropped (2,).
        numbers: of the frames used.
        time: of each in the clock of the force record, NaN where nothing tells it (step,).
        stretch: mean stretch of each along the pull, or 1 + shear (step,).
        u: displacement since the reference, NaN where a point was lost.
        force: by component (i, J) the force along i across the whole sheet's section normal to J (step,).
        pairing: uncertainty of each force by that of the frame to which it belongs, over its size (step,).
        preload: mean strain of the first picture that forces were taken for.
        course: of the force over the stretch, where it may tell what of it is a matter of time.
        relaxation: what of the force is a matter of time, once the sheet's tests are judged.
        camera_angle: by which the camera was turned against the reference, and which is taken out [rad] (step,).
        noise: of the displacements, in mm.
        files: every file that was read.
        findings: sentences on what is strange about the forces.
    """

    test: SpecimenTest
    x: Float[np.ndarray, " column"]
    y: Float[np.ndarray, " row"]
    size: Float[np.ndarray, " 2"]
    numbers: Int[np.ndarray, " step"]
    time: Float[np.ndarray, " step"]
    stretch: Float[np.ndarray, " step"]
    u: Float[np.ndarray, "step row column 2"]
    force: dict[Component, Float[np.ndarray, " step"]]
    pairing: Float[np.ndarray, " step"]
    preload: float
    course: Course | None
    relaxation: Relaxation
    camera_angle: Float[np.ndarray, " step"]
    noise: StepNoise
    files: tuple[Path, ...]
    findings: tuple[str, ...]


def import_load_case(specimen: Specimen, test: SpecimenTest, full: Series | None = None) -> LoadCase:
    """Read a test's frames and force record, each frame's force by its picture or its time.

    Args:
        specimen: of which the test is.
        test: what the configuration says of it.
        full: its frames, where they were read already.

    Raises:
        DicError: any input that cannot be used, with file and line.
    """
    full = without_growth(test, full or read_test(test))
    series, angles = _from_where_the_camera_was(test, trimmed(full, specimen.dropped_rings))
    clock = frame_clock(test, series)
    times = clock and {frame.number: float(clock.at(frame.number)) for frame in series.frames}
    heard = None if test.force_file is None else hear_forces(test, series, clock)
    numbers = select_frames(test, series, times, heard.unheard if heard else {})
    case = _without_force(test, full, series, angles, numbers)
    case = replace(case, time=np.array([times[n] if times else np.nan for n in numbers]))
    strange = _strange_frames(specimen, test, series, numbers) + _warned(test, grown_ends(test, full))
    if heard is None:
        say("import", test.folder, "no force is recorded: every stress is known up to one factor")
        return replace(case, findings=(*case.findings, *strange))
    sides = specimen.width, specimen.height
    heard = _questioned(test, full, series, heard, sides)
    found = import_forces(test, sides, specimen.thickness, series, heard, numbers)
    used = [series.frames[0]] + [frame for frame in series.frames if frame.number in numbers]
    return replace(
        case,
        time=found.time,
        force=found.force,
        pairing=found.pairing,
        preload=max(pull.preload for pull in found.pulls.values()),
        course=course_of(test, series, Series(series.x, series.y, used), found.pulls),
        files=tuple(path for path in (found.path, *full.files) if path.is_file()),
        findings=(*case.findings, *strange, *found.findings),
    )


def _questioned(test: SpecimenTest, full: Series, series: Series, heard: Heard, sides: tuple[float, float]) -> Heard:
    """The record with what frames and forces together ask."""
    questions = [
        Finding(grown_at_rest(test, full, heard.pulls), refused=False, explains=True),
        Finding(exchanged_forces(test, series, heard.pulls, sides), refused=False),
    ]
    return replace(heard, findings=[*heard.findings, *(each for each in questions if each.sentence)])


def load_case_of(
    specimen: Specimen, test: SpecimenTest, full: Series, force: dict[Component, Float[np.ndarray, " step"]]
) -> LoadCase:
    """A test whose frames after the reference are its load steps, each with its own force; nothing tells their times.

    Args:
        full: its frames, whatever they are from.
        force: of each load step, as in :class:`LoadCase`.

    Raises:
        DicError: the frames cannot be used.
    """
    full = without_growth(test, full)
    series, angles = _from_where_the_camera_was(test, trimmed(full, specimen.dropped_rings))
    numbers = np.array([frame.number for frame in series.frames[1:]])
    return replace(_without_force(test, full, series, angles, numbers), force=force)


def _without_force(
    test: SpecimenTest, full: Series, series: Series, angles: dict[int, float], numbers: Int[np.ndarray, " step"]
) -> LoadCase:
    """The load steps of a series, which is what is left of the full one, in mm."""
    mm = full.millimetres(test.pixel_size)
    by_number = {frame.number: frame.displacement * mm for frame in series.frames}
    u = np.stack([by_number[number] for number in numbers]) - np.nan_to_num(by_number[series.frames[0].number])
    stretch = dict(zip(by_number, mean_stretch(series, test.load), strict=True))
    return LoadCase(
        test=test,
        x=series.x * mm,
        y=series.y * mm,
        size=np.array([full.x[-1] * mm, full.y[-1] * mm]),
        numbers=numbers,
        time=np.full(len(numbers), np.nan),
        stretch=np.array([stretch[number] for number in numbers]),
        u=u,
        force={},
        pairing=np.zeros(len(numbers)),
        preload=0.0,
        course=None,
        relaxation=ELASTIC,
        camera_angle=np.array([angles[number] for number in numbers]),
        noise=noise_of(test, series, numbers, mm),
        files=tuple(path for path in full.files if path.is_file()),
        findings=full.findings,
    )


def _strange_frames(specimen: Specimen, test: SpecimenTest, series: Series, numbers) -> tuple[str, ...]:
    """Warnings: times that the files say otherwise than the configuration, several loadings, units, increments."""
    axis = tensile_axis(test.load)
    side = None if axis is None else (specimen.width, specimen.height)[axis]
    # Frames that are chosen need not grow from a first small one.
    told = test.increments or test.force_file is not None or test.frames is not None
    return _warned(
        test,
        times_contradicted(test, series),
        several_loadings(test, series, numbers),
        unlike_positions(test, series, side),
        "" if told else said_without_force(mean_stretch(series, test.load) - 1.0),
    )


def _warned(test: SpecimenTest, *sentences: str) -> tuple[str, ...]:
    """Those sentences that are not empty, once they are said."""
    found = tuple(filter(None, sentences))
    for sentence in found:
        say("import", test.folder, f"warning: {sentence}")
    return found


def _from_where_the_camera_was(test: SpecimenTest, series: Series) -> tuple[Series, dict[int, float]]:
    """(the series without what the camera moved and turned since the reference, that angle [rad] by frame).

    Only where held edges show an angle beyond what chance makes: without one, nothing depends on a shift.
    """
    angles = dict.fromkeys((frame.number for frame in series.frames), 0.0)
    if not test.camera_motion or test.load == "general":
        return series, angles
    frames = series.frames[:1]
    for frame in series.frames[1:]:
        motion = camera_motion(series.x, series.y, frame.displacement, CONSTRAINED[test.load])
        if motion.significant:
            angles[frame.number] = motion.angle
            frame = replace(frame, displacement=without(motion, series.x, series.y, frame.displacement))
        frames.append(frame)
    largest = max(angles.values(), key=abs)
    if largest:
        turned = sum(map(bool, angles.values()))
        about = f"held edges are turned by up to {np.degrees(largest):.2g} degrees in {turned} frames"
        say("import", test.folder, f"{about}: taken for the camera's, and taken out (camera_motion: false leaves it)")
    return replace(series, frames=frames), angles
