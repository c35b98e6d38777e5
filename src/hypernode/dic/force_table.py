"""A machine's record as cells: which dialect it is written in, its header, its units, its rows."""

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from hypernode.dic.errors import DicError
from hypernode.dic.force_dialects import DIALECTS, Dialect
from hypernode.dic.text import read_text

_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\[\]()]*)[\])]$")
_SUFFIX = re.compile(r"^(?P<name>.*)_(?P<unit>[^_]+)$")


@dataclass(frozen=True)
class Table:
    """A file cut into cells: its header, the units of its columns, and (line, cells) of its samples."""

    path: Path
    dialect: Dialect
    line: int
    header: list[str]
    names: list[str]
    units: list[str]
    rows: list[tuple[int, list[str]]]

    def find(self, names: tuple[str, ...]) -> int | None:
        """Column of the first of these names that the header has."""
        return next((self.names.index(name) for name in names if name in self.names), None)


def read_table(path: Path, wanted: str | None, channels: Sequence[str] = ()) -> Table:
    """The file in the first dialect whose header it has.

    Args:
        path: the file.
        wanted: name of the dialect, where it is known.
        channels: names of the columns with the force, where they are not the dialect's own.

    Raises:
        DicError: the file cannot be read, or no dialect has its header.
    """
    text = read_text(path)
    known = [each for each in DIALECTS if wanted in (None, each.name)]
    if not known:
        names = ", ".join(each.name for each in DIALECTS)
        raise DicError(f"{path}: no force format {wanted!r}; there are {names}")
    first = None
    for each in known:
        for delimiter in each.delimiters:
            rows = _cut(path, text, delimiter)
            first = first or rows
            table = _in_dialect(path, rows, each, channels)
            if table is not None:
                return table
    shown = (first or [[]])[0] if first else []
    if len(first or []) < 3:
        raise DicError(f"{path}: needs a header, a line of units and at least one sample")
    raise DicError(
        f"{path}:1: no column 'Force' or 'Time' among {str(shown)[:200]}, and the header of no known program "
        f"({', '.join(each.program for each in known)}): rename the columns, or set force_format and force_channel"
    )


def _cut(path: Path, text: str, delimiter: str) -> list[list[str]]:
    try:
        return list(csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, skipinitialspace=True))
    except csv.Error as error:
        raise DicError(f"{path}: cannot be read: {error}") from None


def _in_dialect(path: Path, rows: list[list[str]], dialect: Dialect, channels: Sequence[str]) -> Table | None:
    """The table below the first line that is this dialect's header; None where there is none."""
    if dialect.begins and not (rows and rows[0] and rows[0][0].strip().lower().startswith(dialect.begins)):
        return None
    forces = [] if channels else dialect.force.values()
    wanted = [names for names in (dialect.time, *forces) if names]
    wanted += [(name,) for name in (*dialect.also, *(dialect.cycles or ()))]
    wanted += [dialect.image] if dialect.image else []
    for at, row in enumerate(rows[: dialect.preamble + 1]):
        pairs = [_name_and_unit(cell, dialect.units) for cell in row]
        names = [name for name, _ in pairs]
        if not all(any(name in names for name in group) for group in wanted):
            continue
        units = [unit for _, unit in pairs]
        below = at + 1
        if dialect.units == "row":
            units = [cell.strip().strip("()[]").strip() for cell in rows[below]] if below < len(rows) else []
            below += 1
            if len(units) != len(names):
                raise DicError(f"{path}:{below}: {len(units)} units for {len(names)} columns")
        elif dialect.units == "brackets" and not any(units):
            continue
        body = [(k, cells) for k, cells in enumerate(rows[below:], start=below + 1) if any(map(str.strip, cells))]
        return Table(path, dialect, at + 1, [cell.strip() for cell in row], names, units, body)
    return None


def _name_and_unit(cell: str, units: str) -> tuple[str, str]:
    pattern = {"brackets": _BRACKETS, "suffix": _SUFFIX}.get(units)
    match = pattern.match(cell.strip()) if pattern else None
    return (match["name"].strip().lower(), match["unit"].strip()) if match else (cell.strip().lower(), "")


def choose_cycle(table: Table, set_name: str | None, cycle: str | None) -> Table:
    """The table with the rows of one set and cycle only.

    Raises:
        DicError: not exactly one cycle of the file has these names; the message lists those it has.
    """
    if table.dialect.cycles is None:
        if set_name is not None or cycle is not None:
            raise DicError(
                f"{table.path}: a record of {table.dialect.program} has no cycles: leave out force_set and force_cycle"
            )
        return table
    at = [table.names.index(name) for name in table.dialect.cycles]
    by_cycle: dict[tuple[str, str], list] = {}
    for line, cells in table.rows:
        if len(cells) <= max(at):
            raise DicError(f"{table.path}:{line}: not a sample: {','.join(cells)[:60]!r}")
        by_cycle.setdefault((cells[at[0]].strip(), cells[at[1]].strip()), []).append((line, cells))
    chosen = [key for key in by_cycle if set_name in (None, key[0]) and cycle in (None, key[1])]
    if len(chosen) != 1:
        sets: dict[str, list[str]] = {}
        for name, each in by_cycle:
            sets.setdefault(name, []).append(each)
        listed = "; ".join(f"{name}: {', '.join(cycles)}" for name, cycles in sets.items())
        raise DicError(
            f"{table.path}: {len(chosen) or 'none'} of {len(by_cycle)} cycles fit force_set = {set_name} and "
            f"force_cycle = {cycle}: choose one of {listed}"
        )
    return replace(table, rows=by_cycle[chosen[0]])
