"""A machine's record as cells: which dialect it is written in, its header, its units, its rows."""

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from hypernode.dic.errors import DicError
from hypernode.dic.forces.column_units import name_and_unit
from hypernode.dic.forces.dialects import DIALECTS, ForceDialect
from hypernode.dic.header import is_number, with_units
from hypernode.dic.text import readings, shown, without_last_words

_TOO_SHORT = "needs a header, a line of units and at least one sample"
#: Letters of the names of cycles in a message.
LONGEST_LIST = 200
#: Number of a line, and its cells.
Row = tuple[int, list[str]]


@dataclass(frozen=True, kw_only=True)
class Table:
    """A file cut into cells: its header, the units of its columns, and (line, cells) of its samples."""

    path: Path
    dialect: ForceDialect
    line: int
    header: list[str]
    names: list[str]
    units: list[str]
    rows: list[Row]

    def find(self, names: tuple[str, ...]) -> int | None:
        """Column of the first of these names that the header has."""
        return next((self.names.index(name) for name in names if name in self.names), None)


def read_table(path: Path, wanted: str | None, channels: Sequence[str] = (), time: str | None = None) -> Table:
    """The file in the first dialect whose header it has.

    Args:
        path: the file.
        wanted: name of the dialect, where it is known.
        channels: names of the columns with the force, where they are not the dialect's own.
        time: name of the column with the time, where it is not the dialect's own.

    Raises:
        DicError: the file cannot be read, or no dialect has its header.
    """
    known = [_timed(each, time) for each in DIALECTS if wanted in (None, each.name)]
    if not known:
        names = ", ".join(each.name for each in DIALECTS)
        raise DicError(f"{path}: no force format {wanted!r}; there are {names}")
    cuts: dict[str, list[Row]] = {}
    for text in readings(path):
        cut: dict[str, list[Row]] = {}
        for each, delimiter in ((dialect, sign) for dialect in known for sign in dialect.delimiters):
            if delimiter not in cut:
                cut[delimiter] = _cut(path, text, delimiter)
            table = _in_dialect(path, cut[delimiter], each, channels, time)
            if table is not None:
                if not text.endswith(("\n", "\r")):
                    _refuse_cut(table)
                return table
        # Where no reading has a header, the first one is told of.
        cuts = cuts or cut
    if all(len(rows) < 3 for rows in cuts.values()):
        raise DicError(f"{path}: {_TOO_SHORT}")
    line, header = _likely_header(cuts.values())
    if all(cell.strip().lstrip("+-")[:1].isdigit() for cell in header):
        raise DicError(
            f"{path}:{line}: {shown(header)} are numbers, and no line says which columns they are: write one above "
            "them, as Time (s),Force (N)"
        )
    program = "of no known program" if wanted is None else f"not of {known[0].program}"
    raise DicError(
        f"{path}:{line}: {shown(header)} are no known names of a force and of a time or picture, and the header is "
        f"{program}: say which columns they are, --set force_channel=NAME and --set time_channel=NAME, or rename them"
    )


def _likely_header(cuts: Iterable[list[Row]]) -> Row:
    """(line, cells that are not empty) of what stands above the first numbers, in the cut with the most numbers."""
    found = (0, 1, [])
    for rows in cuts:
        at = next((k for k, (_, row) in enumerate(rows) if sum(map(_numeric, row)) > 1), None)
        if at is None:
            continue
        width = _filled(rows[at][1])
        # Names stand above units, and both have a cell for each number.
        above = [k for k in range(at) if _filled(rows[k][1]) >= width > 1] or [at]
        line, cells = rows[above[-2] if len(above) > 1 and above[-1] == above[-2] + 1 else above[-1]]
        # What is cut at a decimal sign has halves that are no numbers.
        numbers = 2 * sum(map(_numeric, rows[at][1])) - width
        found = max(found, (numbers, line, [cell.strip() for cell in cells if cell.strip()]), key=lambda each: each[0])
    if not found[0]:
        line, cells = next(iter(cuts))[0]
        return line, cells
    return found[1:]


def _numeric(cell: str) -> bool:
    return is_number(cell.strip().replace(",", "."))


def _refuse_cut(table: Table) -> None:
    """Nothing, where the last number of a file whose last line has no end is written as those above it are.

    Raises:
        DicError: they have one number of decimals, and it has fewer: a number that is cut off is a number still. Of
            whole numbers one line above tells nothing.
    """
    line, cells = table.rows[-1]
    k = _filled(cells) - 1
    above = [row[k].strip() for _, row in table.rows[:-1] if len(row) > k]
    number = cells[k].strip()
    usual = set(map(_decimals, above))
    whole = usual == {0} and (len(above) == 1 or len(number) < len(above[-1]))
    if len(usual) == 1 and ({_decimals(number)} != usual or whole):
        raise DicError(
            f"{table.path}:{line}: the last line has no end, and {number[:40]!r} may be the beginning of a "
            "longer number: the file is cut off; copy or export it again, or end the line if it is whole"
        )


def _decimals(number: str) -> int:
    """How many letters follow the last point or comma."""
    return len(number) - 1 - max(number.rfind("."), number.rfind(",")) if set(number) & set(".,") else 0


def _timed(dialect: ForceDialect, time: str | None) -> ForceDialect:
    """A dialect whose column of the time has the name that the configuration gives, with its unit or without."""
    if time is None:
        return dialect
    name = time.strip().lower()
    return replace(dialect, time=(name, name_and_unit(name, "brackets")[0]))


def _cut(path: Path, text: str, delimiter: str) -> list[Row]:
    """(line on which it ends, cells) of every row."""
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, skipinitialspace=True)
    try:
        rows = [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise DicError(f"{path}:{reader.line_num}: cannot be read: {error}") from None
    # A unit in brackets behind a blank is part of the name before it.
    return [(line, with_units(row)) for line, row in rows] if delimiter == " " else rows


def _in_dialect(
    path: Path, rows: list[Row], dialect: ForceDialect, channels: Sequence[str], time: str | None
) -> Table | None:
    """The table below the first line that is this dialect's header; None where there is none."""
    first = rows[0][1] if rows else []
    if dialect.begins and not (first and first[0].strip().lower().startswith(dialect.begins)):
        return None
    forces = [] if channels else dialect.force.values()
    wanted = [names for names in (() if time else dialect.time, *forces) if names]
    wanted += [(name,) for name in (*dialect.also, *(dialect.cycles or ()))]
    wanted += [dialect.image] if dialect.image else []
    for at, (line, row) in enumerate(rows[: dialect.preamble + 1]):
        pairs = [name_and_unit(cell, dialect.units) for cell in row]
        names = [name for name, _ in pairs]
        timed = time is None or time.strip().lower() in {*names, *(cell.strip().lower() for cell in row)}
        if not timed or not all(any(name in names for name in group) for group in wanted):
            continue
        units = [unit for _, unit in pairs]
        below = at + 1
        if dialect.units == "row":
            units = [cell.strip().strip("()[]").strip() for cell in rows[below][1]] if below < len(rows) else []
            below += 1
            if len(units) != len(names):
                raise DicError(f"{path}:{line + 1}: {len(units)} units for {len(names)} columns")
        elif not any(units):
            continue
        header = [cell.strip() for cell in row]
        samples = _samples(path, header, rows[below:])
        return Table(path=path, dialect=dialect, line=line, header=header, names=names, units=units, rows=samples)
    return None


def _samples(path: Path, header: list[str], rows: list[Row]) -> list[Row]:
    """The rows that are not empty, each with as many cells as the header, but for empty ones at their ends."""
    # LabVIEW's last column has a cell where somebody wrote into it.
    samples, width = [], _filled(header[:-1] if header[-1].lower() == "comment" else header)
    rows = [row for row in rows if _filled(row[1])]
    for line, cells in without_last_words(rows, lambda row: row[1][0]):
        if any("\n" in cell for cell in cells):
            begin = line - sum(cell.count("\n") for cell in cells)
            raise DicError(f"{path}:{max(begin, 1)}: a quoted cell does not end in its line: {','.join(cells)[:60]!r}")
        if not width <= len(cells) or _filled(cells) > len(header):
            hint = ", as with decimal commas that are not quoted" if _filled(cells) > len(header) else ""
            raise DicError(f"{path}:{line}: not a sample: {len(cells)} cells, the header has {len(header)}{hint}")
        samples.append((line, cells))
    if not samples:
        raise DicError(f"{path}: {_TOO_SHORT}")
    return samples


def _filled(cells: list[str]) -> int:
    """Number of cells without the empty ones at the end."""
    return max((k for k, cell in enumerate(cells, start=1) if cell.strip()), default=0)


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
        by_cycle.setdefault((cells[at[0]].strip(), cells[at[1]].strip()), []).append((line, cells))
    chosen = [key for key in by_cycle if set_name in (None, key[0]) and cycle in (None, key[1])]
    if len(chosen) != 1:
        sets: dict[str, list[str]] = {}
        for name, each in by_cycle:
            sets.setdefault(name, []).append(each)
        listed = "; ".join(f"{name}: {', '.join(cycles)}" for name, cycles in sets.items())
        listed = listed if len(listed) <= LONGEST_LIST else f"{listed[:LONGEST_LIST]} ..."
        raise DicError(
            f"{table.path}: {len(chosen) or 'none'} of {len(by_cycle)} cycles fit force_set = {set_name} and "
            f"force_cycle = {cycle}: choose one of {listed}"
        )
    return replace(table, rows=by_cycle[chosen[0]])
