"""What a folder holds that has no frames in it, and which option would make its files frames."""

import re
from collections.abc import Sequence
from pathlib import Path

from hypernode.dic import array_files, arrays
from hypernode.dic.dialect import Dialect
from hypernode.dic.dialects import declared
from hypernode.dic.header import HEAD_BYTES, cells_of, is_number
from hypernode.dic.text import read_text, shown

SUFFIXES = {".csv", ".txt", ".dat", ".asc", ".tsv", *array_files.SUFFIXES}
_PACKED = {".zip", ".7z", ".rar", ".tar", ".gz", ".tgz"}
#: Most files in the folder of one load step: a field, forces and what a program adds.
_MOST_OF_A_STEP = 8
#: Lines in which the first row of numbers is looked for.
_LINES = 60
#: Cells of a row from which it is one of a matrix: no export has as many columns without a header.
_MATRIX = 16
#: Delimiters and decimal signs that a row of numbers may have, the surest first.
_LAYOUTS = ((";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), (" ", "."), (" ", ","))
_ONE_FILE = "put them into one file, numpy.savez('test.npz', x=..., y=..., u=..., v=..., force=...)"


def nothing_found(folder: Path, paths: list[Path], known: Sequence[Dialect]) -> str:
    """What was seen in a folder without a series, and what would make it one.

    Args:
        folder: the folder.
        paths: its files of which the most have alike names.
        known: dialects that were looked for.
    """
    expected = known[0].name if len(known) == 1 else "a format that is known"
    about = f"{folder}: no frames: expected files such as Name0001.csv of {expected}; found"
    inner = sorted(path for path in folder.iterdir() if path.is_dir() and any(path.glob("*.*")))
    if inner and len(paths) < 2:
        return f"{about} the folders {shown(path.name for path in inner)}: {_inner(inner)}"
    if not paths and (single := sorted(path.name for path in folder.glob("*.npy"))):
        return f"{about} {shown(single)}, an array each: {_ONE_FILE}, u and v by frame and point"
    packed = sorted(path.name for path in folder.iterdir() if path.suffix.lower() in _PACKED)
    if packed and not paths:
        return f"{about} {shown(packed)}: unpack it"
    held = sorted(path for path in folder.iterdir() if path.suffix.lower() in array_files.SUFFIXES)
    paths = held if held and len(paths) < 2 else paths
    names = shown(path.name for path in paths)
    if not paths:
        return f"{about} no table{_another(_option([], ','))}"
    if paths[0].suffix.lower() in array_files.SUFFIXES:
        return f"{about} {names}{arrays.said_of(paths[0])}"
    lines = read_text(paths[0], HEAD_BYTES).splitlines() or [""]
    first = f"{about} {names}; {paths[0].name} begins {lines[0][:60]!r}"
    header, cells, sign = _first_numbers(lines)
    if cells and not header and len(cells) >= _MATRIX:
        return (
            f"{first} and has no header. Its {len(cells)} columns look like a matrix of one field, which has no "
            f"positions: {_ONE_FILE}, x and y by column and row, u and v by frame, row and column"
        )
    if cells and not header:
        return f"{first} and has no header{_another(_option(['1', '2', '3', '4'], sign))}"
    return first + _another(_option([], sign))


def _another(option: str) -> str:
    return f"; for any other table set format to table, and table to its columns: {option}"


def _option(columns: list[str], sign: str) -> str:
    dialect = declared(*(columns or ["NAME"] * len("xyuv")), sign, None, deformed=False)
    return dialect.option(unit="mm")


def _first_numbers(lines: Sequence[str]) -> tuple[bool, list[str], str]:
    """(whether a header stands above the first row of numbers, the cells of that row, what stands between them)."""
    for at, line in enumerate(lines[:_LINES]):
        for sign, decimal in _LAYOUTS:
            cells = [cell for cell in cells_of(line, sign) if cell]
            if len(cells) >= len("xyuv") and all(
                is_number(c.replace(",", ".") if decimal == "," else c) for c in cells
            ):
                above = cells_of(lines[at - 1].lstrip("# "), sign) if at else []
                return len(above) == len(cells_of(line, sign)), cells, sign
    sign = next((sign for sign in ";\t, " if len(cells_of(lines[0], sign)) >= len("xyuv")), ",")
    return True, [], sign


def _inner(folders: list[Path]) -> str:
    """What folders within a folder are: steps of a test, one table in each, or tests."""
    tables = [[path for path in each.iterdir() if path.suffix.lower() in SUFFIXES] for each in folders]
    names = [{re.sub(r"\d+", "#", path.name) for path in each} for each in tables]
    steps = len(folders) > 1 and all(re.fullmatch(r"\D*\d+\D*", each.name) for each in folders)
    whole = all(len(each) == len(tables[0]) for each in tables) and 0 < len(tables[0]) <= _MOST_OF_A_STEP
    if not steps or not whole or any(each != names[0] for each in names):
        *others, most = sorted(zip(map(len, tables), folders, strict=True))
        if most[0] > 1 and all(count < 2 for count, _ in others):
            return f"{most[1].name!r} has {most[0]} tables: name that folder, with the record of the machine in it"
        return "each test has a folder of its own: name one of them"
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
