"""One table of a displacement file: recognised by its header, read into columns."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hypernode.dic.dialect import NOT_A_NUMBER, Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.text import read_text

#: Lines in which a header is looked for, and bytes of a file that hold them.
HEAD_LINES, HEAD_BYTES = 300, 1 << 17
_DAVIS8 = re.compile(r'^#DaVis \S+ 2D-vector \d+ (\d+) (\d+) "" "(\w+)" "" "(\w+)" "([^"]*)" "([^"]*)"')
_WORDS = {"true": 1.0, "false": 0.0}


@dataclass(frozen=True)
class Layout:
    """Where a file's table begins, how its cells are told apart, and how many rows it says that it has."""

    names: list[str]
    delimiter: str
    decimal: str
    header: int
    rows: int | None = None


def _cells(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]
        except (csv.Error, StopIteration):
            return []
    return [cell.strip() for cell in line.split(delimiter)]


def _bare(name: str) -> str:
    """A column's name without its unit."""
    return re.sub(r"\s*\[[^\]]*\]\s*$", "", name)


def _names(line: str, delimiter: str) -> list[str]:
    return _cells(line.lstrip("# "), delimiter)


def layout_of(lines: list[str], dialect: Dialect) -> Layout | None:
    """Where the table of a dialect begins among the lines of a file; ``None`` where the file is of another."""
    if dialect.content == "davis8":
        match = _DAVIS8.match(lines[0]) if lines else None
        if match is None:
            return None
        unit, decimal = match[3], "," if any("," in line for line in lines[1:]) else "."
        return Layout(
            [f"x [{unit}]", f"y [{match[4]}]", f"u [{match[6]}]", f"v [{match[6]}]"],
            "\t",
            decimal,
            0,
            int(match[1]) * int(match[2]),
        )
    if not dialect.recognised:
        return None
    for index, line in enumerate(lines[:HEAD_LINES]):
        for delimiter in dict.fromkeys(delimiter for delimiter, _ in dialect.layouts):
            names = _names(line, delimiter)
            seen = {*names, *map(_bare, names)}
            if len(names) < 4 or not set(dialect.recognised) <= seen or seen & set(dialect.absent):
                continue
            decimals = {decimal for sign, decimal in dialect.layouts if sign == delimiter}
            comma = len(decimals) > 1 and any("," in each for each in lines[index + 1 :])
            return Layout(names, delimiter, "," if comma or decimals == {","} else ".", index)
    return None


def _refusal(path: Path, lines: list[str], dialect: Dialect) -> DicError:
    """What is wrong with the header of a file that is not of its series' dialect."""
    if not lines:
        return DicError(f"{path}:1: the file is empty")
    if not dialect.recognised:
        return DicError(f"{path}:1: not a file of {dialect.software}, found {lines[0][:60]!r}")
    delimiters = list(dict.fromkeys(delimiter for delimiter, _ in dialect.layouts))
    best = max(delimiters, key=lambda delimiter: max(len(_names(line, delimiter)) for line in lines[:HEAD_LINES]))
    width = [len(_names(line, best)) for line in lines[:HEAD_LINES]]
    at = int(np.argmax(width))
    if max(width) < 4:
        signs = " or ".join(repr(delimiter) for delimiter in delimiters)
        return DicError(f"{path}:1: the header must be separated by {signs}, found {lines[0][:60]!r}")
    names = _names(lines[at], best)
    missing = [name for name in dialect.recognised if name not in {*names, *map(_bare, names)}]
    missing = missing or ["four columns"]
    return DicError(
        f"{path}:{at + 1}: no column {missing[0]!r} among {names}: export positions and displacements as "
        f"{dialect.software} does, or say another format"
    )


def read_table(path: Path, dialect: Dialect) -> tuple[dict[str, np.ndarray], np.ndarray, dict[str, str], list[str]]:
    """(cells by role, line of each row, unit by role, preamble) of a file.

    Roles are x, y, u, v, z, w, time, force, ``FRAME`` and the columns that mark lost points.

    Raises:
        DicError: the file is not of this dialect; the message names the line.
    """
    lines = read_text(path).splitlines()
    layout = layout_of(lines, dialect)
    if layout is None:
        raise _refusal(path, lines, dialect)
    roles = _roles(path, layout, dialect)
    body = [(k, line) for k, line in enumerate(lines[layout.header + 1 :], start=layout.header + 2) if line.strip()]
    if not body:
        raise DicError(f"{path}:{layout.header + 2}: no points")
    table = _plain(body, layout, list(roles.values()), dialect.blanks)
    if table is None:
        table = _row_by_row(path, body, layout, list(roles.values()), dialect)
    if layout.rows not in (None, len(body)):
        raise DicError(f"{path}:{body[-1][0]}: {len(body)} points, the first line promises {layout.rows}: export again")
    names = layout.names
    units = {role: (re.search(r"\[([^\]]*)\]\s*$", names[k]) or ["", ""])[1] for role, k in roles.items()}
    return (
        {role: table[:, k] for k, role in enumerate(roles)},
        np.array([number for number, _ in body]),
        units,
        lines[: layout.header],
    )


def _plain(body: list[tuple[int, str]], layout: Layout, columns: list[int], blanks: bool) -> np.ndarray | None:
    """Columns of rows that hold as many cells as the header, numbers all of them, or empty where ``blanks``.

    ``None`` where a row asks for a closer look.
    """
    text, sign = "\n".join(line for _, line in body), layout.delimiter
    if '"' in text or (layout.decimal == "," and "." in text):
        return None
    text = text.replace(",", ".") if layout.decimal == "," else text
    if blanks and sign != " ":
        # Twice, since neighbours share a delimiter.
        for empty, number in 2 * ((sign + sign, f"{sign}nan{sign}"), (f"{sign}\n", f"{sign}nan\n")):
            text = text.replace(empty, number)
        text += "nan" if text.endswith(sign) else ""
    rows, signs = text.split("\n"), len(layout.names) - 1
    if any((len(row.split()) - 1 if sign == " " else row.count(sign)) != signs for row in rows):
        return None
    try:
        return np.loadtxt(rows, delimiter=None if sign == " " else sign, usecols=columns, comments=None, ndmin=2)
    except ValueError:
        return None


def _row_by_row(path: Path, body, layout: Layout, columns: list[int], dialect: Dialect) -> np.ndarray:
    """The same of rows with quoted cells or words, or an error that names the line."""
    width, values = len(layout.names), []
    quoted = any('"' in line for _, line in body[:2])
    for number, line in body:
        if quoted:
            fields = _cells(line, layout.delimiter)
        else:
            fields = line.split(None if layout.delimiter == " " else layout.delimiter)
        if len(fields) != width:
            raise DicError(f"{path}:{number}: {len(fields)} fields, the header has {width}")
        values.append([_number(fields[k], dialect, layout, f"{path}:{number}", line) for k in columns])
    return np.array(values)


def _number(cell: str, dialect: Dialect, layout: Layout, where: str, line: str) -> float:
    """A number, a word that stands for one, or an error that names the line."""
    word, turned = cell.strip().lower(), layout.decimal == ","
    if word in _WORDS:
        return _WORDS[word]
    if dialect.blanks and word in NOT_A_NUMBER:
        return np.nan
    try:
        # Neither a point among decimal commas nor Python's 1_0 is a number.
        return float("_" if "_" in word or (turned and "." in word) else word.replace(",", ".") if turned else word)
    except ValueError:
        seen = ("." in word and "a decimal point among decimal commas") if turned else ("," in word and "decimal comma")
        hint = f" ({seen}? export with decimal points)" if seen else ""
        raise DicError(f"{where}: not a number in {line[:60]!r}{hint}") from None


def _roles(path: Path, layout: Layout, dialect: Dialect) -> dict[str, int]:
    """Role -> index of its column."""
    bare = [_bare(name) for name in layout.names]
    places = {}
    for role in ("x", "y", "u", "v", "z", "w"):
        found = [bare.index(name) for name in getattr(dialect, role) if name in bare]
        if found:
            places[role] = found[0]
        elif role in "xyuv":
            raise DicError(
                f"{path}:{layout.header + 1}: no column {' or '.join(getattr(dialect, role))!r} among {layout.names}"
            )
    if not {"z", "w"} <= set(places):
        places = {role: k for role, k in places.items() if role not in "zw"}
    others = [name for name, _ in dialect.lost] + [dialect.time, dialect.force]
    others += ["FRAME"] if dialect.content == "subset" else []
    return places | {name: bare.index(name) for name in others if name in bare}
