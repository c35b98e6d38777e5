"""Clock times of a record as seconds since its first sample."""

import itertools
import re
import statistics
from dataclasses import replace

from hypernode.dic.errors import DicError
from hypernode.dic.forces.table import Table

#: 10:11:57.25, with or without a date before it, and with a comma or a colon before its decimals.
_CLOCK = re.compile(
    r"^(?:.*[ T])?(?P<h>\d{1,2}):(?P<min>[0-5]\d):(?P<s>[0-5]\d(?:[.,:]\d+)?)(?:Z|\s*(?P<half>[AaPp])[Mm])?$"
)
#: Minutes and seconds of a stopwatch.
_MINUTES = re.compile(r"^(?P<min>\d{1,3}):(?P<s>[0-5]\d(?:[.,]\d+)?)$")
_DAY = 86400.0
#: Days since 1900 of the years 1982 to 2078, by which spreadsheets write a time of day.
_DAYS = (30_000.0, 65_000.0)


def with_seconds(table: Table, column: int) -> Table:
    """The table with a column of clock times in seconds since the first; as it is where they are none.

    A time of day that falls by more than half a day has passed midnight.

    Raises:
        DicError: a time of day stands among what is none.
    """
    found = [_seconds(cells[column].strip()) for _, cells in table.rows]
    if not found or found[0] is None:
        return _from_days(table, column)
    if None in found:
        line, cells = table.rows[found.index(None)]
        raise DicError(f"{table.path}:{line}: {cells[column][:40]!r} is no time of day as those above it are")
    seconds, days = [], 0.0
    for each in found:
        if seconds and each + days < seconds[-1] - 0.5 * _DAY:
            days += _DAY
        seconds.append(each + days)
    comma = any("," in cell for _, cells in table.rows for k, cell in enumerate(cells) if k != column)
    return _with_times(table, column, [each - seconds[0] for each in spread(seconds)], comma)


def spread(seconds: list[float]) -> list[float]:
    """Times of samples between two ticks of a clock that is coarser than they are, evenly from tick to tick.

    The first tick may have begun before the record, so that its samples are the last ones of it.

    Args:
        seconds: of each sample, never decreasing.
    """
    ticks = [list(group) for _, group in itertools.groupby(seconds)]
    if len(ticks) < 3 or (usual := statistics.median(map(len, ticks[1:-1]))) < 2:
        return seconds
    step = statistics.median(b[0] - a[0] for a, b in itertools.pairwise(ticks))
    spread = []
    for k, tick in enumerate(ticks):
        count = max(usual, len(tick))
        before = count - len(tick) if k == 0 else 0
        spread += [each + step * (before + i) / count for i, each in enumerate(tick)]
    return spread


def _with_times(table: Table, column: int, seconds: list[float], comma: bool) -> Table:
    texts = [f"{each:.6f}".replace(".", "," if comma else ".") for each in seconds]
    rows = [
        (line, [*cells[:column], text, *cells[column + 1 :]])
        for (line, cells), text in zip(table.rows, texts, strict=True)
    ]
    units = [*table.units[:column], "s", *table.units[column + 1 :]]
    return replace(table, rows=rows, units=units)


def _from_days(table: Table, column: int) -> Table:
    """The table with seconds in the place of a spreadsheet's days since 1900; as it is where it has none."""
    if table.units[column]:
        return table
    try:
        days = [float(cells[column].replace(",", ".")) for _, cells in table.rows]
    except ValueError:
        return table
    if not (_DAYS[0] <= min(days) and max(days) <= _DAYS[1]) or max(days) - min(days) > 0.5:
        return table
    comma = any("," in cells[column] for _, cells in table.rows)
    return _with_times(table, column, [_DAY * (each - days[0]) for each in days], comma)


def _seconds(cell: str) -> float | None:
    """Seconds since midnight, or of a stopwatch; None where a cell holds no time of day."""
    if match := _CLOCK.match(cell):
        hours = int(match["h"]) % 12 + 12 * (match["half"] in "Pp") if match["half"] else int(match["h"])
        return 3600.0 * hours + 60.0 * int(match["min"]) + float(re.sub("[,:]", ".", match["s"]))
    if match := _MINUTES.match(cell):
        return 60.0 * int(match["min"]) + float(match["s"].replace(",", "."))
    return None
