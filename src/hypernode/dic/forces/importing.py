"""The forces of a test's load steps, checked before anything is computed with them."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.forces.checks import Finding, check_jumps, check_reach, check_rest, check_rise, check_units
from hypernode.dic.forces.dialects import PULL
from hypernode.dic.forces.drift import drift_findings
from hypernode.dic.forces.growth import growth_findings
from hypernode.dic.forces.magnitude import check_stiffness, crosshead_findings, section_findings
from hypernode.dic.forces.matching import Component, PullRecord, counted_otherwise, pulls_of, shift_of
from hypernode.dic.forces.one_clock import on_one_clock
from hypernode.dic.forces.pairing import pairing_of
from hypernode.dic.forces.record import ForceRecord, read_force_record, record_of_frames
from hypernode.dic.forces.silence import not_used, with_silences
from hypernode.dic.frame_clock import FrameClock
from hypernode.dic.frames import mean_gradient, working_stretch
from hypernode.dic.increments import refuse_where_reached, totals_added
from hypernode.dic.loadings import loadings
from hypernode.dic.series import Series
from hypernode.mechanics.loads import RESULTANTS
from hypernode.progress import say

#: Stretch along a force over shear, below which the force is taken for that of the shear.
_HARDLY_STRETCHED = 0.1


@dataclass(frozen=True, kw_only=True)
class Forces:
    """Forces of the load steps.

    Attributes:
        path: of the record, or of the folder whose frames hold the force themselves.
        pulls: by component of the resultant, the record in its own clock, with that of the frames.
        time: of every load step in the clock of the record [s]; NaN where nothing tells it.
        force: by component, of every load step [N].
        pairing: uncertainty of each by that of its frame, over its size; the largest of the components.
        findings: sentences on what is strange about them.
    """

    path: Path
    pulls: dict[Component, PullRecord]
    time: Float[np.ndarray, " step"]
    force: dict[Component, Float[np.ndarray, " step"]]
    pairing: Float[np.ndarray, " step"]
    findings: tuple[str, ...]


@dataclass(frozen=True)
class Heard:
    """The record of a test in the clock of its frames, before load steps are chosen.

    Attributes:
        record: as it was read.
        pulls: by component.
        unheard: number of each frame of which it tells no force -> why not.
        findings: what is strange about the clocks.
    """

    record: ForceRecord
    pulls: dict[Component, PullRecord]
    unheard: dict[int, str]
    findings: list[Finding]


def hear_forces(test: SpecimenTest, series: Series, clock: FrameClock | None) -> Heard:
    """Read the record of a test and match it with the frames.

    Args:
        test: what the configuration says of it.
        series: the frames that were read, the reference first.
        clock: when they were taken; None where nothing tells.

    Raises:
        DicError: the record cannot be read or lacks a force that the load needs.
    """
    record = _record(test, series)
    channels = ", ".join(record.channels)
    say("import", test.folder, f"{record.path.name}: read as {record.program}: {channels}")
    numbers = np.array([frame.number for frame in series.frames])
    pulls = pulls_of(test, record, _components(test, record), clock, numbers.tolist())
    _refuse_across_a_shear(test, record, series, pulls)
    pulls, findings = on_one_clock(test, pulls, series)
    if test.picture_shift is None and (shift := shift_of(test, record, numbers.tolist())):
        findings.append(Finding(counted_otherwise(shift), False))
    unheard = {}
    for part, pull in pulls.items():
        course = working_stretch(series, test.load, *part)
        seen = np.isfinite(course) & (pull.image is None or np.isin(numbers, pull.image))
        time = pull.times(numbers[seen])
        if pull.image is None and check_reach(time, pull.time, pull.force):
            # The clocks are apart, which is refused when the forces are checked.
            continue
        pulls[part] = with_silences(pull, time, course[seen])
        unheard |= pulls[part].unheard(numbers)
    findings += [Finding(not_used(numbers, unheard), False)] if unheard else []
    return Heard(record, pulls, unheard, findings)


def import_forces(
    test: SpecimenTest,
    sides: tuple[float, float],
    thickness: float,
    series: Series,
    heard: Heard,
    chosen: Int[np.ndarray, " step"],
) -> Forces:
    """The forces of the load steps, once they are checked.

    Args:
        test: what the configuration says of it.
        sides: of the sheet, along x and y [mm].
        thickness: of the sheet [mm].
        series: the frames that were read, the reference first.
        heard: their record.
        chosen: numbers of the frames that are load steps.

    Raises:
        DicError: the record does not reach a load step, or holds what no sheet can give.
    """
    pulls, findings = heard.pulls, list(heard.findings)
    numbers = np.array([frame.number for frame in series.frames])
    several, pairing = len(pulls) > 1, np.zeros(len(chosen))
    for part, pull in pulls.items():
        course, area = working_stretch(series, test.load, *part), sides[1 - part[1]] * thickness
        if not test.increments:
            refuse_where_reached(test.folder, course - 1.0, numbers, pull)
        added = _totals_added(pull, numbers, course) if test.increments else []
        found = added + _checked(pull, numbers, course, area, chosen, explained=test.force_offset is not None)
        if not any(each.refused for each in found):
            paired = pairing_of(test, pull, series, part)
            pairing = np.maximum(pairing, paired.relative(pull, chosen))
            found += crosshead_findings(test, pull, series, part, sides) + section_findings(pull, area)
            found += paired.findings + growth_findings(test, pull, series, part) + drift_findings(test, pull)
        about = f"along {'xy'[part[0]]}: " if several else ""
        findings += [replace(each, sentence=about + each.sentence) for each in found]
    first = next(iter(pulls.values()))
    time = first.times(chosen) if first.time is not None else np.full(len(chosen), np.nan)
    force = {part: pull.forces(chosen) for part, pull in pulls.items()}
    path = heard.record.path
    said = _reported(test.folder, path, findings)
    return Forces(path=path, pulls=pulls, time=time, force=force, pairing=pairing, findings=said)


def _record(test: SpecimenTest, series: Series) -> ForceRecord:
    """The machine's record; where there is no file, what the frames themselves say of the force."""
    path = Path(test.folder) / test.force_file
    if path.is_file() or not any(frame.force is not None for frame in series.frames):
        return read_force_record(
            path, test.force_format, test.force_channel, test.force_set, test.force_cycle, test.time_channel
        )
    return record_of_frames(Path(test.folder), series)


def _components(test: SpecimenTest, record: ForceRecord) -> list[Component]:
    """Which resultants of the load the record tells.

    Raises:
        DicError: it lacks one that the load needs.
    """
    wanted = list(RESULTANTS[test.load])
    if record.axes == (PULL,):
        if len(wanted) > 1:
            way_out = (
                "say which column is which, force_channel: {x: ..., y: ...}; or the sheet is pulled along one axis, "
                "and looks otherwise: say the load (load), or turn a component that points the other way "
                "(displacement_axes: [-x, y] or [x, -y])"
            )
            if record.path.is_dir():
                way_out = "put the machine's record with both into the folder, force_file"
            raise DicError(
                f"{record.path}: one force ({record.channels[0]!r}), and a {test.load} test has one along x and one "
                f"along y: {way_out}"
            )
        return wanted
    known = [part for part in wanted if "xy"[part[0]] in record.axes]
    if len(known) < len(wanted) and test.load != "general":
        raise DicError(
            f"{record.path}: no force along {'xy'[wanted[-1][0]]}, which a {test.load} test needs: force_channel"
        )
    return known


def _refuse_across_a_shear(test: SpecimenTest, record: ForceRecord, series: Series, parts) -> None:
    """The force along an axis is that which stretches the sheet along it, and none that shears it.

    Raises:
        DicError: a general test that shears the sheet and hardly stretches it along a force.
    """
    if test.load != "general":
        return
    moved = np.array([[np.nanmax(np.abs(mean_gradient(series, i, J)), initial=0.0) for J in (0, 1)] for i in (0, 1)])
    for i, J in parts:
        if moved[i, J] < _HARDLY_STRETCHED * moved[[0, 1], [1, 0]].max():
            raise DicError(
                f"{record.path}: a force along {'xy'[i]}, along which the sheet hardly stretches ({moved[i, J]:.2g}) "
                f"while it is sheared by {moved[[0, 1], [1, 0]].max():.2g}: the resultant of a shear is known where "
                "the upper end moves along x, load: shear; else leave this force out, force_channel or force_file: null"
            )


def _checked(pull: PullRecord, numbers, course, area: float, chosen, explained: bool) -> list[Finding]:
    """What is strange about one force, against the course of the stretch with which it should grow."""
    seen = (numbers <= chosen.max()) & np.isfinite(course)
    if pull.image is None and (elsewhere := check_reach(pull.times(numbers[seen]), pull.time, pull.force)):
        return elsewhere
    at_steps = np.array([course[numbers == number][0] for number in chosen])
    reached = pull.reached(numbers[seen])
    forces = pull.forces(numbers[seen][reached]) if reached.any() else np.empty(0)
    findings = check_rise(course[seen][reached], forces)
    findings += _other_loadings(pull) if findings else []
    findings += check_units(pull.time, pull.force) or check_jumps(pull.time, pull.force)
    findings += check_stiffness(at_steps, pull.forces(chosen), area, chosen)
    return findings + (check_rest(forces, explained) if reached[0] else [])


def _totals_added(pull: PullRecord, numbers, course) -> list[Finding]:
    """What speaks against increments that were added up, from the frames that the record reaches."""
    seen = pull.reached(numbers) & np.isfinite(course)
    sentence = totals_added(course[seen], pull.forces(numbers[seen])) if seen.any() else ""
    return [Finding(sentence, False)] if sentence else []


def _other_loadings(pull: PullRecord) -> list[Finding]:
    """When a record pulls more than once: its frames may be of another time than they are taken for."""
    found = loadings(pull.force)
    if pull.image is not None or len(found) < 2:
        return []
    begins = ", ".join(f"{pull.time[each.start]:.3g}" for each in found[:5]) + (", ..." if len(found) > 5 else "")
    return [Finding(f"the record pulls {len(found)} times, from {begins} s on", False, explains=True)]


def _reported(folder: str, path: Path, findings: list[Finding]) -> tuple[str, ...]:
    """The sentences of what is only strange, each said; whatever is refused comes together in one error."""
    if any(finding.refused for finding in findings):
        raise DicError(f"{path}: " + "; and ".join(each.sentence for each in findings if each.refused or each.explains))
    for finding in findings:
        say("import", folder, f"warning: {path.name}: {finding.sentence}")
    return tuple(finding.sentence for finding in findings)
