"""One table of a displacement file, read into columns."""

import re
from pathlib import Path

import numpy as np

from hypernode.dic.dialect import NOT_A_NUMBER, Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.header import Layout, bare, cells_of, layout_of, refusal
from hypernode.dic.text import read_text, shown
from hypernode.dic.validity import failed, known_columns, named_columns, value_of

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
    cells = {role: table[:, k] for k, role in enumerate(roles)}
    return (
        cells | {"failed": _failed(path, body, layout, dialect)},
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
        where = f"{path}:{number}"
        if quoted:
            fields = cells_of(line, layout.delimiter)
        else:
            fields = line.split(None if layout.delimiter == " " else layout.delimiter)
        if len(fields) != width:
            raise DicError(f"{where}: {len(fields)} fields, the header has {width}")
        values.append([number_in(fields[k], layout.decimal, dialect.blanks, where, line) for k in columns])
    return np.array(values)


def _failed(path: Path, body: list[tuple[int, str]], layout: Layout, dialect: Dialect) -> np.ndarray:
    """Which rows a column marks as failed points: one that is known to, or that the configuration names."""
    names = list(map(bare, layout.names))
    columns = known_columns(names)
    columns |= named_columns(path, layout.header + 1, names, dialect.valid)
    lost = np.zeros(len(body), dtype=bool)
    if not columns:
        return lost
    rows = [cells_of(line, layout.delimiter) for _, line in body]
    for name, k in columns.items():
        values = np.array([value_of(row[k], layout.decimal) if k < len(row) else np.nan for row in rows])
        lost |= failed(name, values, dialect.valid)
    return lost


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
        hint = f" ({seen}? export with decimal points)" if seen else ""
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
    others += ["FRAME"] if dialect.content == "subset" else []
    twice = [layout.names[k] for k in places.values() if layout.names.count(layout.names[k]) > 1]
    if twice:
        raise DicError(f"{path}:{layout.header + 1}: two columns {twice[0]!r}: rename the one that does not count")
    return places | {name: names.index(name) for name in others if name in names}
