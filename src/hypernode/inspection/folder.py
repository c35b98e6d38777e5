"""A folder as a whole: what it holds, what of its specimen is known or guessed, and what is missing."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hypernode.config.loading import check_config
from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.forces.clock import ClockOffset
from hypernode.dic.forces.record import record_of_frames
from hypernode.dic.frame_clock import frame_clock, times_contradicted
from hypernode.dic.frames import mean_stretch, trimmed
from hypernode.dic.loadings import loadings
from hypernode.dic.series import Series
from hypernode.dic.specimen import ImportedSpecimen, import_specimen
from hypernode.dic.text import without_braces
from hypernode.inspection.content import Content, columns_beside, content_of
from hypernode.inspection.field import Field, least_ring, read_field
from hypernode.inspection.field_remarks import remarks_on
from hypernode.inspection.forces import Course, courses, going_on
from hypernode.inspection.known import ANY_SIZE, Known, guessed, missing, odd
from hypernode.inspection.load import LoadSeen, recognised
from hypernode.inspection.records import Cycle, RecordFile, cycle_of_test, record_files, record_of_test
from hypernode.inspection.size import size_known
from hypernode.mechanics.loads import RESULTANTS
from hypernode.progress import heard

#: Loads that need a force along each axis.
_TWO_FORCES = [load for load, parts in RESULTANTS.items() if len(parts) > 1]
#: Share of the largest elongation by which it falls when a sheet is unloaded or torn, and not by noise.
_FALLS = 0.05


@dataclass(frozen=True, kw_only=True)
class Inspection:
    """What is found out about a folder.

    Attributes:
        folder, name: the folder, and the name of its specimen.
        known: what is known of the specimen, and what is missing or odd.
        content: files of the folder.
        files, others: force records among them, and a sentence on each other table.
        field: the frames; None where they cannot be read.
        kept: the frames without the rings that are dropped.
        load: what their load looks like.
        cycle: the force record of the test.
        courses, offsets: forces of the frames, and estimates of the offset of the record's clock.
        sheet: the specimen as an identification would have it; None where something is missing.
        notes: what the import says of it.
    """

    folder: Path
    name: str
    known: Known
    content: Content
    files: list[RecordFile]
    others: Mapping[Path, str]
    field: Field | None = None
    kept: Series | None = None
    load: LoadSeen | None = None
    cycle: Cycle | None = None
    courses: tuple[Course, ...] = ()
    offsets: tuple[ClockOffset, ...] = ()
    sheet: ImportedSpecimen | None = None
    notes: tuple[str, ...] = ()

    @property
    def millimetres(self) -> float | None:
        """Length of the frames' unit [mm]; None where it is not known."""
        return 1.0 if self.field.series.unit == "mm" else self.known.settings.get("pixel_size")


def inspect(folder: Path, given: Mapping[str, object]) -> Inspection:
    """Find out what a folder holds and whether it can be imported.

    Args:
        folder: with displacement files.
        given: keys of its specimen that are known.

    Raises:
        DicError: there is no such folder.
        ConfigError: a key or a value is not that of a specimen.
    """
    if not folder.is_dir():
        raise DicError(f"{folder}: no such folder")
    name = named_after(folder)
    check_config({"specimens": {name: {**ANY_SIZE, **given, "folder": str(folder)}}}, "command line")
    known = Known(given)
    test = known.specimen(folder)
    content = content_of(test)
    files, others = record_files(content.tables, test)
    seen = Inspection(folder=folder, name=name, known=known, content=content, files=files, others=others)
    if content.frames is None:
        return replace(seen, known=known + missing(content.refusal))
    try:
        # All frames are looked at, whichever are chosen.
        field = read_field(test.model_copy(update={"frames": None}), content.frames)
        seen = replace(seen, field=field, kept=trimmed(field.series, test.dropped_rings))
        # The nearer to what holds the sheet, the more its ends say; only the outermost points mislead.
        seen = replace(seen, load=recognised(trimmed(field.series, min(test.dropped_rings, 1))))
    except DicError as error:
        return replace(seen, known=known + missing(str(error)))
    seen = _with_forces(_with_size(_with_load(seen)))
    return seen if seen.known.missing else _imported(seen)


def named_after(folder: Path) -> str:
    """Name of a folder's specimen: its own, in characters that names of entries may have."""
    name = "".join(c if c.isascii() and (c.isalnum() or c in "_.-") else "_" for c in folder.resolve().name)
    return name.lstrip("_.-") or "specimen"


def _and(seen: Inspection, known: Known, **changes) -> Inspection:
    return replace(seen, known=seen.known + known, **changes)


def _with_load(seen: Inspection) -> Inspection:
    load, given = seen.load, seen.known.settings.get("load")
    if len(seen.field.numbers) < 2:
        return _and(seen, missing("deformed frames: there is one frame, which is the reference of all others"))
    if given is None and load.kind is None:
        return _and(seen, missing(f"which load it is: {load.reason}: --load KIND", "load"))
    if given is None and load.question:
        return _and(seen, missing(load.question, "load"))
    if given is None:
        seen = _and(seen, guessed("load", load.kind, load.reason))
    elif load.kind not in (None, given):
        seen = _and(seen, odd(f"it looks like {load.kind} and not {given}: {load.reason}", "load"))
    elif load.still and "displacement_factor" not in seen.known.settings:
        seen = _and(seen, odd(load.reason, "displacement_factor"))
    return _and(seen, _unloading(seen))


def _unloading(seen: Inspection) -> Known:
    """Frames that follow the largest stretch, where it falls by more than they scatter."""
    test = seen.known.specimen(seen.folder)
    stretch = mean_stretch(seen.kept, test.load)
    if test.load_steps is None or not np.nanmax(stretch, initial=1.0) > 1.0 or len(loadings(stretch)) > 1:
        return Known()
    peak = int(np.nanargmax(stretch))
    after = stretch[peak + 1 :]
    if not (stretch[peak] - after > _FALLS * (stretch[peak] - 1.0)).any():
        return Known()
    return odd(
        f"after frame {seen.field.numbers[peak]} the mean stretch falls from {stretch[peak]:.4g} to "
        f"{np.nanmin(after):.4g} (unloading, or a tear): the {len(after)} frames after it are no load steps",
        "frames",
    )


def _with_size(seen: Inspection) -> Inspection:
    test = seen.known.specimen(seen.folder)
    seen = _and(seen, remarks_on(seen.field, seen.known.settings))
    seen = _and(seen, size_known(seen.known.settings, seen.field, test.load))
    ring = least_ring(seen.field.series)
    if test.outline == "cut" and (ring is None or ring > test.dropped_rings):
        columns, rows = len(seen.field.series.x), len(seen.field.series.y)
        end = "no rectangle among the points has edges that are measured: export one without the sheet's curved sides"
        if ring is not None:
            end = f"--set edge_ring={ring} leaves {columns - 2 * ring} x {rows - 2 * ring} points"
        return _and(seen, missing(f"less than half of an outermost line of points is measured; {end}", "edge_ring"))
    return seen


def _with_forces(seen: Inspection) -> Inspection:
    test = seen.known.specimen(seen.folder)
    cycle, known = _record(seen, test)
    seen = _and(seen, known, cycle=cycle)
    clock = frame_clock(test, seen.field.series)
    if cycle is None:
        return seen
    if contradicted := times_contradicted(test, seen.field.series):
        seen = _and(seen, odd(contradicted, "frame_rate"))
    if cycle.record.image is None and clock is None:
        return _and(seen, missing(_no_clock(seen, cycle), "frame_rate"))
    sides = (test.width, test.height) if seen.known.sized else None
    for sentence in going_on(test, seen.kept, cycle.record, clock, sides):
        seen = _and(seen, odd(sentence, "frame_rate"))
    found, offsets = courses(test, seen.kept, cycle.record, clock)
    return replace(seen, courses=tuple(found), offsets=tuple(offsets))


def _record(seen: Inspection, test: SpecimenTest) -> tuple[Cycle | None, Known]:
    """(the record of the test, what is known or missing of it): a file, or what the frames themselves hold."""
    series, settings = seen.field.series, seen.known.settings
    if not seen.files and "force_file" not in settings and any(frame.force is not None for frame in series.frames):
        try:
            record = record_of_frames(seen.folder, series)
        except DicError as error:
            return None, missing(str(error), "force_file")
        # A file of arrays says no unit at all, and the stiffness shows whether it is N.
        about = "the forces are those in the displacement files, some of which say N and mean V"
        arrays = seen.field.dialect == "arrays"
        return Cycle(None, None, record), Known() if arrays else odd(about, "force_file")
    file, known = record_of_test(seen.files, seen.others, test, settings)
    if file is None:
        return None, known
    cycle, more = cycle_of_test(file, test)
    return cycle, known + more


def _no_clock(seen: Inspection, cycle: Cycle) -> str:
    numbers, time = seen.field.numbers, cycle.record.time
    least = (numbers[-1] - numbers[0]) / (time[-1] - time[0]) if time[-1] > time[0] else 0.0
    return (
        f"the number of frames in a second, their numbers counted: nothing says when they were taken; {numbers[0]} to "
        f"{numbers[-1]} fit into the {time[-1] - time[0]:.4g} s of the record from {least:.3g} on: --frame-rate HZ"
    )


def _otherwise(seen: Inspection) -> str:
    """What else a load may be that was taken from the frames and needs two forces, as its record has one."""
    guess = seen.known.guesses.get("load")
    if guess is None or seen.known.settings["load"] not in _TWO_FORCES:
        return ""
    sentence = f"; the load is taken from the frames ({guess}), --load KIND says another"
    for column in columns_beside(seen.content.frames)[:1]:
        sentence += (
            f"; points that a program failed at may be told by a column, --set 'valid={{{column}: [LOW, HIGH]}}'"
        )
    return sentence


def _imported(seen: Inspection) -> Inspection:
    """The import itself, which has the last word."""
    with heard() as said:
        try:
            specimen = seen.known.specimen(seen.folder)
            sheet = import_specimen(specimen, full=None if specimen.frames else seen.field.series)
            without_braces(map(str, sheet.files))
        except DicError as error:
            return _and(seen, missing(f"{error}{_otherwise(seen)}"))
    told = {remark.sentence for remark in seen.known.odd}
    findings = [odd(each) for case in sheet.cases for each in case.findings if each not in told]
    # Frames, noise and records stand in other attributes, and warnings among what is odd.
    elsewhere = {*seen.field.said, *(case.noise.source for case in sheet.cases)}
    notes = [each for each in said if each not in elsewhere and ": read as " not in each]
    notes = tuple(each for each in notes if not each.startswith("warning: "))
    return _and(seen, sum(findings, Known()), sheet=sheet, notes=notes)
