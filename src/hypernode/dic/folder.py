"""Which files of a folder are frames, of which dialect, and which number each has."""

import re
from dataclasses import dataclass, replace
from pathlib import Path

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic import array_files, arrays
from hypernode.dic.clock_names import times_of
from hypernode.dic.column_names import named_table
from hypernode.dic.dialect import Dialect
from hypernode.dic.dialects import BY_NAME, DIALECTS, declared
from hypernode.dic.errors import DicError
from hypernode.dic.header import HEAD_BYTES, shows
from hypernode.dic.nothing_found import SUFFIXES, nothing_found
from hypernode.dic.numbering import numbered
from hypernode.dic.text import read_text

MATRIX = re.compile(r"^(?P<name>.*)_(?P<field>[A-Za-z]+) ?\[(?P<unit>\w+)\]\.csv$")
_MATLAB = b"MATLAB 7.3 MAT-file"
_TIME = re.compile(r"_(-?\d+[.,]\d+) ?s\.\w+$")


@dataclass(frozen=True)
class Found:
    """The one series of a folder.

    Attributes:
        dialect: of its files.
        files: number -> file; of a series whose files are not frames, a running number.
        times: number -> time [s] that the name of the file says.
    """

    dialect: Dialect
    files: dict[int, Path]
    times: dict[int, float]


def find_series(folder: Path, dialect: Dialect | None = None) -> Found:
    """The series in a folder; of the given dialect, else of the one that its files show.

    Raises:
        DicError: there is no folder, no frame, or more than one series.
    """
    if not folder.is_dir():
        raise DicError(f"{folder}: no such folder")
    paths = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file())
    known = (dialect,) if dialect else DIALECTS
    # Files whose names differ only in digits are of one series, whether or not each of them is as it should be.
    groups: dict[str, list[Path]] = {}
    for path in paths:
        groups.setdefault(_skeleton(path.name), []).append(path)
    series = [(found, group) for group in groups.values() if (found := _dialect_of(group, known))]
    if not series:
        raise DicError(nothing_found(folder, max(groups.values(), key=len, default=[]), known))
    if series[0][0].content in ("matrices",):
        files = sorted(path for found, group in series if found is series[0][0] for path in group)
        series = [(series[0][0], files)]
    if len(series) > 1:
        raise DicError(
            f"{folder}: several series ({', '.join(sorted(group[0].name for _, group in series))}, ...): "
            f"keep one a folder{', or say its format' if len({found.name for found, _ in series}) > 1 else ''}"
        )
    found, group = series[0]
    if found.frame and len(group) == 1:
        return Found(replace(found, content="stacked"), {0: group[0]}, {})
    if found.content in ("matrices", "ncorr") or (found.content == "arrays" and len(group) == 1):
        if found.content == "ncorr" and len(group) > 1:
            raise DicError(f"{folder}: several series ({', '.join(p.name for p in group)}): keep one a folder")
        return Found(found, dict(enumerate(group)), {})
    times = {path: float(match[1].replace(",", ".")) for path in group if (match := _TIME.search(path.name))}
    if len(times) == len(group) and len({_TIME.sub("", path.name) for path in group}) == 1:
        ordered = sorted(group, key=times.get)
        return Found(found, dict(enumerate(ordered, start=1)), {k: times[p] for k, p in enumerate(ordered, start=1)})
    clock = times_of([path.name for path in group])
    if clock is not None:
        return Found(found, *_by_clock(group, clock))
    return Found(found, numbered(folder, group), {})


def _by_clock(group: list[Path], clock: list[float]) -> tuple[dict[int, Path], dict[int, float]]:
    """(number -> file, number -> time) of files that are named by a clock: seconds since the first one where all are
    whole, which a frame rate of 1 fits, else a running number."""
    ordered = sorted(zip(clock, group, strict=True))
    since = [time - ordered[0][0] for time, _ in ordered]
    numbers = [int(time) for time in since] if all(time.is_integer() for time in since) else range(len(since))
    return {n: path for n, (_, path) in zip(numbers, ordered, strict=True)}, dict(zip(numbers, since, strict=True))


def _skeleton(name: str) -> str:
    return re.sub(r"\d+", "#", re.sub(_TIME, "_#s", name)).lower()


def _dialect_of(group: list[Path], known) -> Dialect | None:
    """The dialect of the first file of a group that shows one."""
    for path in group:
        if path.suffix.lower() in array_files.SUFFIXES:
            held = next((each for each in known if each.content == "arrays"), None)
            if held and arrays.holds_frames(path, held.arrays):
                return held
            with open(path, "rb") as handle:
                if handle.read(len(_MATLAB)) == _MATLAB and BY_NAME["ncorr"] in known:
                    return BY_NAME["ncorr"]
            continue
        matrix = MATRIX.match(path.name)
        try:
            lines = read_text(path, HEAD_BYTES).splitlines()
        except DicError:
            continue
        for dialect in known:
            if dialect.content == "matrices":
                if matrix and matrix["field"].upper() in ("U", "V", "X", "Y"):
                    return dialect
            elif shows(lines, dialect):
                stacked = named_table(lines) if known is DIALECTS and dialect.name == "table" else None
                return stacked if stacked and stacked.frame else dialect
        if known is DIALECTS and (named := named_table(lines)):
            return named
    return None


def dialect_of(test: SpecimenTest) -> Dialect | None:
    """The dialect that a test declares; ``None`` where its files are to show it."""
    said = test.arrays.model_dump()
    if test.format == "auto" and not any(said.values()):
        dialect = None
    elif test.format in ("auto", "arrays"):
        dialect = replace(BY_NAME["arrays"], unit=said.pop("unit"), arrays=said)
    elif test.format == "table":
        dialect = declared(**test.table.model_dump())
    else:
        dialect = BY_NAME[test.format]
    return dialect


def raw_files(test: SpecimenTest) -> list[Path]:
    """Every displacement file of a test, and its force record where frames do not hold the force themselves.

    Raises:
        DicError: there is no folder, no frame, or more than one series.
    """
    found = find_series(Path(test.folder), dialect_of(test))
    files = list(found.files.values())
    if test.force_file is None:
        return files
    record = Path(test.folder) / test.force_file
    own = found.dialect.force or found.dialect.preamble_force
    return files if own and not record.is_file() else [*files, record]
