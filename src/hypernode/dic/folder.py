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
from hypernode.dic.header import HEAD_BYTES, cells_of, is_number, shows
from hypernode.dic.numbering import numbered
from hypernode.dic.text import read_text, shown

SUFFIXES = {".csv", ".txt", ".dat", ".asc", ".tsv", *array_files.SUFFIXES}
MATRIX = re.compile(r"^(?P<name>.*)_(?P<field>[A-Za-z]+) ?\[(?P<unit>\w+)\]\.csv$")
_MATLAB = b"MATLAB 7.3 MAT-file"
_TIME = re.compile(r"_(-?\d+[.,]\d+) ?s\.\w+$")
#: Most files in the folder of one load step: a field, forces and what a program adds.
_MOST_OF_A_STEP = 8


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
        raise DicError(_nothing(folder, max(groups.values(), key=len, default=[]), known))
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
    return re.sub(r"\d+", "#", re.sub(_TIME, "_#s", name))


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


def _nothing(folder: Path, paths: list[Path], known) -> str:
    """What was seen in a folder without a series, of which the most files have these names, and what is known."""
    expected = known[0].name if len(known) == 1 else "a format that is known"
    about = f"{folder}: no frames: expected files such as Name0001.csv of {expected}; found"
    inner = sorted(path for path in folder.iterdir() if path.is_dir() and any(path.glob("*.*")))
    if inner and len(paths) < 2:
        return f"{about} the folders {shown(path.name for path in inner)}: {_inner(inner)}"
    if not paths and (single := sorted(path.name for path in folder.glob("*.npy"))):
        return (
            f"{about} {shown(single)}, an array each: put them into one file, numpy.savez('test.npz', x=..., y=..., "
            "u=..., v=..., force=...), u and v by frame and point"
        )
    first, columns, more = "", "x: NAME, y: NAME, u: NAME, v: NAME", ""
    for path in paths[:1]:
        if path.suffix.lower() in array_files.SUFFIXES:
            return f"{about} {shown(path.name for path in paths)}{arrays.said_of(path)}"
        lines = read_text(path, HEAD_BYTES).splitlines() or [""]
        first = f"; {path.name} begins {lines[0][:60]!r}"
        sign = next((sign for sign in ",;\t " if len(cells_of(lines[0], sign)) >= len("xyuv")), ",")
        more = f", delimiter: {sign!r}" if sign != "," else ""
        if all(is_number(cell.replace(",", ".") if sign != "," else cell) for cell in cells_of(lines[0], sign)):
            first += " and has no header"
            columns = "x: 1, y: 2, u: 3, v: 4"
    return (
        f"{about} {shown(path.name for path in paths) or 'no table'}{first}; for any other table set format to table, "
        f'and table to its columns: --set format=table --set "table={{{columns}{more}, unit: mm}}"'
    )


def _inner(folders: list[Path]) -> str:
    """What folders within a folder are: steps of a test, one table in each, or tests."""
    tables = [[path for path in each.iterdir() if path.suffix.lower() in SUFFIXES] for each in folders]
    names = [{re.sub(r"\d+", "#", path.name) for path in each} for each in tables]
    steps = len(folders) > 1 and all(re.fullmatch(r"\D*\d+\D*", each.name) for each in folders)
    whole = all(len(each) == len(tables[0]) for each in tables) and 0 < len(tables[0]) <= _MOST_OF_A_STEP
    if not steps or not whole or any(each != names[0] for each in names):
        return "each test has a folder of its own"
    ordered = sorted(folders, key=lambda each: int(re.search(r"\d+", each.name)[0]))
    frame = max(tables[0], key=lambda path: path.stat().st_size)
    step = f"Step{int(re.search(r'[0-9]+', ordered[0].name)[0]):04d}{frame.suffix}"
    return (
        f"with the same files in each, {shown(sorted(path.name for path in tables[0]))}, they look like the steps of "
        "one test. Copy their "
        f"tables into one folder, {ordered[0].name}/{frame.name} as {step} and so on, and write their forces into one "
        "record, force_disp.csv: the columns Time and Force, or Force x and Force y, a line of units, a line for the "
        "sheet at rest, a line a step. Say frame_rate, steps in a second of its Time (--frame-rate). Where no table "
        "shows the sheet at rest, say implied_reference: true (--set implied_reference=true)"
    )


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
