"""One table of a displacement file, read into columns."""

import csv
import re
from io import StringIO
from itertools import repeat
from pathlib import Path

import numpy as np

from hypernode.dic.dialect import NOT_A_NUMBER, Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.header import Layout, bare, cells_of, layout_of, refusal
from hypernode.dic.text import read_text, shown, without_last_words
from hypernode.dic.validity import failed, known_columns, named_columns, question, value_of

#: What says the sign where the file does not show it.
_DECLARED = "; of a declared table, table: {decimal: ...} says the sign"
_NO_POINT = ": delete the line if it is no point"
_WORDS = {"true": 1.0, "false": 0.0}


def read_table(path: Path, dialect: Dialect) -> tuple[dict[str, np.ndarray], np.ndarray, dict[str, str], list[str]]:
    """(cells by role, line of each row, unit by role, preamble) of a file.

    Roles are x, y, u, v, z, w, time, force, ``FRAME``, the columns that mark lost points, and ``failed``: whether one
    that other programs know marks a point.

    Raises:
        DicError: the file is not of this dialect; the message names the line.
    """
    lines = read_text(path).splitlines()
    layout = layout_of(lines, dialect)
    if layout is None:
        raise refusal(path, lines, dialect)
    roles, marks = _roles(path, layout, dialect), _marks(path, layout, dialect)
    number, rows = _rows(lines, layout.header + 1)
    if not rows:
        raise DicError(f"{path}:{layout.header + 2}: no points: export it again, or delete it")
    plain = _plain(rows, layout, [*roles.values(), *marks.values()], dialect.blanks)
    if plain is None:
        table = _row_by_row(path, number, rows, layout, list(roles.values()), dialect)
        marked = _marked(rows, layout, list(marks.values()))
    else:
        table, marked = plain[:, : len(roles)], plain[:, len(roles) :]
    if layout.rows not in (None, len(rows)):
        raise DicError(f"{path}:{number[-1]}: {len(rows)} points, the first line promises {layout.rows}: export again")
    names = layout.names
    units = {role: (re.search(r"\[([^\]]*)\]\s*$", names[k]) or ["", ""])[1] for role, k in roles.items()}
    for name, values in zip(marks, marked.T, strict=True):
        if asked := question(name, values, dialect.valid):
            raise DicError(f"{path}:{layout.header + 1}: {asked}")
    lost = [failed(name, values, dialect.valid) for name, values in zip(marks, marked.T, strict=True)]
    cells = {role: table[:, k] for k, role in enumerate(roles)}
    cells["failed"] = np.any(lost, axis=0) if lost else np.zeros(len(rows), dtype=bool)
    return cells, number, units, lines[: max(layout.header, 0)]


def _rows(lines: list[str], begin: int) -> tuple[np.ndarray, list[str]]:
    """(number of each line from ``begin`` on that is not empty, these lines)."""
    rows = lines[begin:]
    number = np.arange(begin + 1, len(lines) + 1)
    if not all(map(str.strip, rows)):
        filled = [k for k, line in enumerate(rows) if line.strip()]
        number, rows = number[filled], [rows[k] for k in filled]
    rows = without_last_words(rows, str)
    return number[: len(rows)], rows


def _plain(rows: list[str], layout: Layout, columns: list[int], blanks: bool) -> np.ndarray | None:
    """Columns of rows that hold as many cells as the header, numbers all of them, or empty where ``blanks``.

    ``None`` where a row asks for a closer look.
    """
    text, sign, signs = "\n".join(rows), layout.delimiter, len(layout.names) - 1
    if '"' in text or (layout.decimal == "," and "." in text):
        return None
    counted = map(len, map(str.split, rows)) if sign == " " else map(str.count, rows, repeat(sign))
    if set(counted) != {signs + (sign == " ")}:
        return None
    if layout.decimal == ",":
        text = text.replace(",", ".")
    sign = r"\s+" if sign == " " else sign
    absent = ["nan", "NaN", "NAN", *([""] if blanks else [])]
    # Snakemake starts without it.
    import pandas as pd

    try:
        table = pd.read_csv(
            StringIO(text),
            sep=sign,
            header=None,
            usecols=columns,
            quoting=csv.QUOTE_NONE,
            na_values=absent,
            keep_default_na=False,
        )
    except ValueError:
        return None
    numbers = all(kind.kind in "if" for kind in table.dtypes)
    return table[columns].to_numpy(dtype=float) if numbers else None


def _row_by_row(path: Path, number, rows, layout: Layout, columns: list[int], dialect: Dialect) -> np.ndarray:
    """The same of rows with quoted cells or words, or an error that names the line."""
    width, values = len(layout.names), []
    quoted = any('"' in line for line in rows[:2])
    for k, line in zip(number, rows, strict=True):
        where = f"{path}:{k}"
        if quoted:
            fields = cells_of(line, layout.delimiter)
        else:
            fields = line.split(None if layout.delimiter == " " else layout.delimiter)
        if len(fields) != width:
            commas = layout.delimiter == "," and len(fields) == 2 * width
            hint = ", as with decimal commas between commas: export with another separator" if commas else ""
            raise DicError(f"{where}: {len(fields)} fields, the header has {width}{hint or _NO_POINT}")
        values.append([number_in(fields[k], layout.decimal, dialect.blanks, where, line) for k in columns])
    return np.array(values)


def _marks(path: Path, layout: Layout, dialect: Dialect) -> dict[str, int]:
    """Name -> index of the columns that mark failed points: known ones, and those that the configuration names."""
    names = list(map(bare, layout.names))
    return known_columns(names) | named_columns(path, layout.header + 1, names, dialect.valid)


def _marked(rows: list[str], layout: Layout, columns: list[int]) -> np.ndarray:
    """What such columns hold (row, column), of rows with words; NaN where a cell is empty or missing."""
    cells = [cells_of(row, layout.delimiter) for row in rows] if columns else len(rows) * [[]]
    return np.array([[value_of(row[k], layout.decimal) if k < len(row) else np.nan for k in columns] for row in cells])


def number_in(cell: str, decimal: str, blanks: bool, where: str, line: str) -> float:
    """The number in a cell, or that of a word that stands for one.

    Args:
        cell: its text.
        decimal: the decimal sign of the file.
        blanks: whether an empty cell or a word for "not a number" is one.
        where: file and line, for messages.
        line: the line, for messages.

    Raises:
        DicError: the cell holds none.
    """
    word, turned = cell.strip().lower(), decimal == ","
    if word in _WORDS:
        return _WORDS[word]
    if blanks and word in NOT_A_NUMBER:
        return np.nan
    try:
        # Neither a point among decimal commas nor Python's 1_0 is a number.
        return float("_" if "_" in word or (turned and "." in word) else word.replace(",", ".") if turned else word)
    except ValueError:
        seen = ("." in word and "a decimal point among decimal commas") if turned else ("," in word and "decimal comma")
        hint = f" ({seen}? export with decimal points and no sign of thousands{_DECLARED})" if seen else ""
        if not turned and {".", ","} <= set(word):
            hint = " (thousands? export without their sign)"
        elif not any(map(str.isdigit, word)):
            hint = _NO_POINT
        raise DicError(f"{where}: not a number in {line[:60]!r}{hint}") from None


def _roles(path: Path, layout: Layout, dialect: Dialect) -> dict[str, int]:
    """Role -> index of its column."""
    names = list(map(bare, layout.names))
    places = {}
    for role in ("x", "y", "u", "v", "z", "w"):
        wanted = getattr(dialect, role)
        found = [layout.names.index(name) for name in wanted if name in layout.names]
        found = found or [names.index(name) for name in wanted if name in names]
        if found:
            places[role] = found[0]
        elif role in "xyuv":
            raise DicError(
                f"{path}:{layout.header + 1}: no column {' or '.join(getattr(dialect, role))!r} among "
                f"{shown(layout.names)}"
            )
    if not {"z", "w"} <= set(places):
        places = {role: k for role, k in places.items() if role not in "zw"}
    others = [name for name, _ in dialect.lost] + [dialect.time, dialect.force]
    others += ["FRAME"] if dialect.content == "subset" else [dialect.frame] if dialect.content == "stacked" else []
    twice = [layout.names[k] for k in places.values() if layout.names.count(layout.names[k]) > 1]
    if twice:
        raise DicError(f"{path}:{layout.header + 1}: two columns {twice[0]!r}: rename the one that does not count")
    return places | {name: names.index(name) for name in others if name in names}
