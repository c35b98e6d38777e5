"""Tables of what jobs cost: wall time and peak memory, from the workflow's benchmark records."""

import json
from pathlib import Path

from hypernode.tables.columns import Column
from hypernode.tables.table import Table, make_frame

COLUMNS = {"wall time": Column("s", "number", "s"), "peak memory": Column("max_rss", "number", "MB")}


def timing_table(evaluations: list[str]) -> Table:
    """One row a job of these runs.

    Args:
        evaluations: evaluation files; the records are found from their place in the results folder.
    """
    rows = []
    for path in sorted(map(Path, evaluations)):
        case, method = path.parts[-3:-1]
        records = path.parents[2] / "benchmarks" / case
        for record in sorted([*records.glob("*.jsonl"), *(records / method).glob("*.jsonl")]):
            values = json.loads(record.read_text(encoding="utf-8").splitlines()[-1])
            cost = {name: values.get(column.key) for name, column in COLUMNS.items()}
            # A job that ends at once is gone before its memory is looked at.
            cost = {name: None if value == "NA" else value for name, value in cost.items()}
            rows.append({"case": case, "method": method, "stage": record.stem} | cost)
    return Table(make_frame(rows, ["case", "method", "stage"], COLUMNS), COLUMNS, list(COLUMNS))
