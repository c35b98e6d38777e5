"""Any vendor's folder of displacement files, as a series on one grid."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.array_files import SUFFIXES
from hypernode.dic.copies import Copies, without_copies
from hypernode.dic.declared import Declared, declared_by
from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.folder import dialect_of, find_series
from hypernode.dic.grid import NearGrid
from hypernode.dic.increments import accumulated
from hypernode.dic.points import Points
from hypernode.dic.reference import is_compared_with_itself, refuse_deformed_reference
from hypernode.dic.series import Frame, Series
from hypernode.dic.sheet import Sheet, sheet_of
from hypernode.dic.sources import backwards, frames_in, without_lost_zeros
from hypernode.dic.text import refuse_cut_lines
from hypernode.progress import say

#: Where files show everything.
_NOTHING = Declared()


def read_test(test: SpecimenTest) -> Series:
    """The series of a test, with what was decided about it in the log.

    Raises:
        DicError: as :func:`read_series`.
    """
    series = read_series(Path(test.folder), test.frames, dialect_of(test), declared_by(test))
    if series.unit == "mm" and test.pixel_size is not None:
        serves = "serves for the noise alone" if test.noise_pixels else "is ignored"
        say("import", test.folder, f"the files are in mm: pixel_size {serves}")
    return series


def read_series(folder: Path, numbers=None, dialect: Dialect | None = None, declared: Declared = _NOTHING) -> Series:
    """Read the frames of a folder onto one grid.

    Args:
        folder: the folder.
        numbers: frames to keep besides the reference; all when left out.
        dialect: of the files; they show it when left out.
        declared: what the files do not show.

    Raises:
        DicError: no or several series, missing frames, broken files, points off the reference's grid, a reference that
            is deformed, or a sheet that moves out of its plane.
    """
    found = find_series(folder, dialect)
    dialect = _as_declared(found.dialect, declared)
    available, read = frames_in(found, dialect)
    if declared.newest_first:
        available, read = backwards(available, read)
    first = read(available[0])
    implied = not dialect.reference and not is_compared_with_itself(first)
    reference = _before(available) if implied else available[0]
    wanted = _wanted(folder, numbers, available, reference)
    _tell(folder, dialect, first, reference, implied)
    at_rest = _at_rest(first) if implied else first
    sheet = sheet_of(at_rest, reference, {} if declared.newest_first else found.times, declared.allow_out_of_plane)
    refuse_deformed_reference(sheet, dialect, lambda: read(available[-1]), declared.newest_first)
    frames, moved = [sheet.frame(at_rest, reference)], []
    # Frames that nobody wants tell of those after them whether they are copies or increments.
    for number in (each for each in available if reference < each <= max(wanted, default=reference)):
        needed = number in wanted or declared.increments
        try:
            points = without_lost_zeros(read(number), dialect)
            _refuse_others(first, points)
            frames.append(sheet.frame(points, number))
        except DicError:
            if needed:
                raise
            continue
        moved += [sheet.out_of_plane(points)] if number in wanted else []
    timed = all(frame.time is not None for frame in frames[implied:])
    copies = without_copies(frames, declared.repeated_frames, timed, str(folder))
    _refuse_copies(folder, copies, numbers or (), frames)
    measured = accumulated(copies.frames) if declared.increments else copies.frames
    _tell_axes(folder, sheet, first.unit, max(moved, default=0.0))
    for finding in copies.findings:
        say("import", str(folder), f"warning: {finding}")
    used = dict.fromkeys([available[0], *wanted]) if dialect.content in ("frame", "davis8") else ()
    ends = available[0] + available[-1]
    files = tuple(found.files[ends - n if declared.newest_first else n] for n in used) or tuple(found.files.values())
    return Series(
        sheet.grid.x - sheet.grid.x[0],
        sheet.grid.y - sheet.grid.y[0],
        [frame for frame in measured if frame.number in (reference, *wanted)],
        unit=first.unit,
        out_of_plane=max(moved, default=0.0),
        files=files,
        tilt=sheet.tilt.degrees if sheet.tilt else 0.0,
        inserted=copies.inserted,
        findings=copies.findings,
    )


def _at_rest(first: Points) -> Points:
    """The sheet at rest, which is in no file; without force, where frames say their forces."""
    rest = np.zeros_like(first.displacement)
    return replace(first, displacement=rest, force=None if first.force is None else 0.0, crosshead=None)


def _refuse_others(first: Points, points: Points) -> None:
    """Nothing, where a frame is written as the first one is."""
    if first.path.suffix.lower() not in SUFFIXES:
        refuse_cut_lines((first.path, points.path))
    if (points.unit, points.position.shape[1]) != (first.unit, first.position.shape[1]):
        raise DicError(f"{points.path}: other columns or units ({points.unit}) than {first.path.name}")


def _as_declared(dialect: Dialect, declared: Declared) -> Dialect:
    changes = {"valid": declared.valid, "displacement_factor": declared.displacement_factor or 1.0}
    changes["displacement_axes"] = declared.displacement_axes
    if declared.y_points is not None:
        changes["y_up"] = declared.y_points == "up"
    if declared.implied_reference is not None:
        changes["reference"] = not declared.implied_reference
    return replace(dialect, **changes)


def _refuse_copies(folder: Path, copies: Copies, numbers: Iterable[int], frames: list[Frame]) -> None:
    kept = {frame.number for frame in copies.frames}
    if len(kept) < len(frames) and (gone := [n for n in numbers if n not in kept]):
        raise DicError(f"{folder}: frame {gone[0]} is equal to the last bit to one before it: choose another")


def _wanted(folder: Path, numbers, available: list[int], reference: int) -> list[int]:
    """Numbers of the deformed frames that are kept, each of which is there."""
    wanted = sorted(set(available if numbers is None else numbers) - {reference})
    absent = [n for n in wanted if n not in available]
    if absent:
        near = min(available, key=lambda n: abs(n - absent[0]))
        raise DicError(f"{folder}: frame {absent[0]} is not there; the nearest is {near}")
    return wanted


def _before(available: Sequence[int]) -> int:
    """Number of a sheet at rest that is in no file: as far before the first as the nearest two are apart."""
    return available[0] - int(min(np.diff(available), default=1))


def _tell(folder: Path, dialect: Dialect, first: Points, reference: int, implied: bool) -> None:
    text = (
        f"files of {dialect.software} (format: {dialect.name}), in {first.unit}, y {'up' if dialect.y_up else 'down'}, "
        f"{len(first.position)} points in the first"
    )
    if implied:
        text += f"; the reference is not among them and counts as frame {reference}"
    say("import", str(folder), text)


def _tell_axes(folder: Path, sheet: Sheet, unit: str, out_of_plane: float) -> None:
    tilt, grid = sheet.tilt, sheet.grid
    if tilt:
        text = (
            f"the grid is tilted by {tilt.degrees:.4g} degrees against the axes of the files: positions and "
            "displacements are along its own"
        )
        say("import", str(folder), text)
    if isinstance(grid, NearGrid):
        text = (
            f"points lie off a grid: interpolated onto {len(grid.x)} x {len(grid.y)} points {grid.step[0]:.4g} and "
            f"{grid.step[1]:.4g} {unit} apart; the nearest measured point is {grid.moved[0]:.2g} of a step away in the "
            f"median, {grid.moved[1]:.2g} at most"
        )
        say("import", str(folder), text)
    if sheet.plane:
        say("import", str(folder), f"the sheet moves out of its plane by {out_of_plane:.2%} of its size")
