"""Clock times of a record as seconds since its first sample."""

import re
from dataclasses import replace

from hypernode.dic.forces.table import Table

#: 10:11:57.25, with or without a date before it, and with a comma or a colon before its decimals.
_CLOCK = re.compile(
    r"^(?:.*[ T])?(?P<h>\d{1,2}):(?P<min>\d{2}):(?P<s>\d{2}(?:[.,:]\d+)?)(?:Z| ?(?P<half>[AaPp])[Mm])?$"
)
_DAY = 86400.0


def with_seconds(table: Table, column: int) -> Table:
    """The table with a column of clock times in seconds since the first; as it is where they are none.

    A time of day that falls by more than half a day has passed midnight.
    """
    found = [_CLOCK.match(cells[column].strip()) for _, cells in table.rows]
    if not all(found):
        return table
    seconds, days = [], 0.0
    for match in found:
        hour = int(match["h"]) % 12 + 12 * (match["half"] in "Pp") if match["half"] else int(match["h"])
        now = 3600.0 * hour + 60.0 * int(match["min"]) + float(re.sub("[,:]", ".", match["s"])) + days
        if seconds and now < seconds[-1] - 0.5 * _DAY:
            now, days = now + _DAY, days + _DAY
        seconds.append(now)
    comma = any("," in cell for _, cells in table.rows for k, cell in enumerate(cells) if k != column)
    texts = [f"{each - seconds[0]:.6f}".replace(".", "," if comma else ".") for each in seconds]
    rows = [
        (line, [*cells[:column], text, *cells[column + 1 :]])
        for (line, cells), text in zip(table.rows, texts, strict=True)
    ]
    units = [*table.units[:column], "s", *table.units[column + 1 :]]
    return replace(table, rows=rows, units=units)
