"""Times of day in a record, as seconds since its first sample."""

import re
from dataclasses import replace

from hypernode.dic.errors import DicError
from hypernode.dic.forces.table import Row, Table

#: Hours, minutes and seconds, with a date in front or without.
_CLOCK = re.compile(
    r"^(?P<date>\S+[ T])?(?P<h>\d{1,2}):(?P<m>[0-5]\d):(?P<s>[0-5]\d(?:[.,]\d+)?)\s*(?P<half>[AaPp][Mm])?$"
)
_MINUTES = re.compile(r"^(?P<m>\d{1,3}):(?P<s>[0-5]\d(?:[.,]\d+)?)$")
_DAY = 86400.0


def with_clock_in_seconds(table: Table) -> Table:
    """The table with times of day in its column of the time made seconds since the first; others as they are.

    Raises:
        DicError: a time of day stands among what is none.
    """
    at = table.find(table.dialect.time)
    if at is None or not table.rows or _seconds(table.rows[0][1][at]) is None:
        return table
    first, last, day, rows = None, None, 0.0, list[Row]()
    for line, cells in table.rows:
        seconds = _seconds(cells[at])
        if seconds is None:
            raise DicError(f"{table.path}:{line}: {cells[at][:40]!r} is no time of day as those above it are")
        if last is not None and seconds + day < last - _DAY / 2:
            day += _DAY
        last = seconds + day
        first = last if first is None else first
        rows.append((line, [*cells[:at], repr(round(last - first, 9)), *cells[at + 1 :]]))
    units = [*table.units[:at], "s", *table.units[at + 1 :]]
    return replace(table, rows=rows, units=units)


def _seconds(cell: str) -> float | None:
    """Seconds since midnight, or of a stopwatch; None where a cell holds no time of day."""
    cell = cell.strip()
    if match := _CLOCK.match(cell):
        hours = int(match["h"]) % (12 if match["half"] else 24)
        hours += 12 if (match["half"] or "").lower() == "pm" else 0
        return 3600.0 * hours + 60.0 * int(match["m"]) + float(match["s"].replace(",", "."))
    if match := _MINUTES.match(cell):
        return 60.0 * int(match["m"]) + float(match["s"].replace(",", "."))
    return None
