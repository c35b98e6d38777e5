"""Tables of what jobs cost: wall time and peak memory, from the workflow's benchmark records."""

import json
from pathlib import Path

from hypernode.tables.columns import Column
from hypernode.tables.table import Table, make_frame

COLUMNS = {"wall time": Column("s", "number", unit="s"), "peak memory": Column("max_rss", "number", unit="MB")}


def timing_table(benchmarks: list[str]) -> Table:
    """One row a job.

    Args:
        benchmarks: records ``benchmarks/CASE/STAGE.jsonl`` of jobs that all methods of a case share, and
            ``benchmarks/CASE/METHOD/STAGE.jsonl``.
    """
    rows = []
    for path in sorted(map(Path, benchmarks)):
        case, *method = path.parts[path.parts.index("benchmarks") + 1 : -1]
        values = json.loads(path.read_text(encoding="utf-8").splitlines()[-1])
        cost = {name: values.get(column.key) for name, column in COLUMNS.items()}
        # A job that ends at once is gone before its memory is looked at.
        cost = {name: None if value == "NA" else value for name, value in cost.items()}
        rows.append({"case": case, "method": method[0] if method else "(all)", "stage": path.stem} | cost)
    return Table(make_frame(rows, ["case", "method", "stage"], COLUMNS), COLUMNS, list(COLUMNS))
