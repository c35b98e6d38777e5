"""Tables of populations: the median and the worst sheet of every group, and how many pass, warn and fail."""

import numpy as np
import xarray as xr

from hypernode.tables.columns import COLUMNS, VERDICTS, Column
from hypernode.tables.table import Table, judged_notes, make_frame
from hypernode.tables.verdicts import count

#: What makes a group: geometry and materials; its sheets differ in their noise.
GROUP = ("geometry", "inclusion", "matrix")
SHOWN = ("stress error", "contrast error", "Dice", "spread", "misfit of u")
EVERY = "all"


def population_table(collection: xr.Dataset) -> Table:
    """Two rows a group, and two of all sheets.

    The worst sheet of a column is that with the smallest value where a larger one is better, else with the largest.

    Args:
        collection: an opened collection; of its fields none is read.
    """
    columns = {
        name: column.of_statistics
        for name, column in COLUMNS["runs"].items()
        if f"score.{column.key}" in collection.variables
    } | {VERDICTS: Column("", "text")}
    scores = {name: collection[f"score.{column.key}"].values for name, column in columns.items() if name != VERDICTS}
    labels = np.stack([collection[key].values.astype(str) for key in GROUP], axis=1)
    levels = collection["level"].values.astype(str)
    rows = []
    for group in [*dict.fromkeys(map(tuple, labels)), (EVERY,) * len(GROUP)]:
        members = np.ones(len(labels), bool) if group[0] == EVERY else (labels == group).all(axis=1)
        row = dict(zip(GROUP, group, strict=True)) | {"sheets": int(members.sum()), VERDICTS: count(levels[members])}
        for statistic in ("median", "worst"):
            found = {name: _statistic(values[members], columns[name], statistic) for name, values in scores.items()}
            rows.append(row | {"statistic": statistic} | found)
    frame = make_frame(rows, [*GROUP, "sheets", "statistic"], columns)
    shown = [name for name in SHOWN if name in columns] + [VERDICTS]
    return Table(frame, columns, shown, notes=judged_notes(columns, shown))


def _statistic(values: np.ndarray, column: Column, statistic: str) -> float | None:
    known = values[~np.isnan(values)]
    if not known.size:
        return None
    if statistic == "median":
        return float(np.median(known))
    return float(known.min() if column.better == "high" else known.max())
