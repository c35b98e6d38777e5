"""Tables of runs: one row a run, or a few statistics of each group of runs."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fnmatch import fnmatch

import numpy as np

from hypernode.storage.netcdf import read, units_of
from hypernode.tables.columns import COLUMNS, DEFAULT, VERDICT, VERDICTS, Column
from hypernode.tables.table import Table, best_values, judged_notes, make_frame
from hypernode.tables.verdicts import count
from hypernode.verdict import Ending

#: Statistic of a group -> function of its values.
STATISTICS = {"mean": np.mean, "spread": np.std, "median": np.median, "largest": np.max}
#: Statistics of which a smaller or larger one is better, as its column says.
COMPARED = ("mean", "median")
VERDICT_NOTE = (
    "verdict: how far a run can be believed by its own numbers, the worst of its criteria; the command hypernode "
    "verdict prints a sentence on each that is not met."
)
BEST_NOTE = "Bold: best of a case."
#: Columns of groups.
GROUP = {"not converged": Column("", "count"), VERDICTS: Column("", "text")}


@dataclass(frozen=True)
class Run:
    """What the files of one run say of it: their summaries together, and the unit of length."""

    case: str
    method: str
    summary: dict
    length: str

    def matches(self, pattern: str) -> bool:
        """Whether ``case/method`` fits a pattern."""
        return fnmatch(f"{self.case}/{self.method}", pattern)

    @property
    def converged(self) -> bool:
        """False where the run says that it ended otherwise; methods that search for no field say nothing."""
        return self.summary.get("ending", Ending.CONVERGED) == Ending.CONVERGED


def judged_levels(summaries: Iterable[Mapping]) -> str:
    """How many of these runs pass, warn and fail: ``7 pass, 2 warn``; empty where none has a verdict."""
    return count(summary[VERDICT].partition(":")[0] for summary in summaries if VERDICT in summary)


def read_runs(paths: list[str]) -> list[Run]:
    """The runs of result files that carry a ``summary``; several files of one run are taken together."""
    runs = {}
    for path in sorted(paths):
        file = read(path)
        run, summary = (json.loads(file.attrs[key]) for key in ("run", "summary"))
        key = (run["case"], run["method"])
        earlier = runs[key].summary if key in runs else {}
        runs[key] = Run(*key, earlier | summary, units_of(file)["length"])
    return list(runs.values())


def _columns(kind: str, runs: list[Run]) -> dict[str, Column]:
    """Columns of a kind, with the unit of length that these runs have."""
    length = " or ".join(sorted({run.length.replace("1", "-") for run in runs})) or "-"
    return {
        name: replace(column, unit=length) if column.unit == "length" else column
        for name, column in COLUMNS[kind].items()
    }


def run_table(runs: list[Run], kind: str, chosen: list[str]) -> Table:
    """One row a run, the best of a case marked.

    The column ``verdict`` is shown beyond those chosen: no choice of columns hides what a run is worth.

    Args:
        runs: the rows.
        kind: ``runs``, ``validation`` or ``references``.
        chosen: names in :data:`COLUMNS` of that kind; its default ones where empty.
    """
    columns = _columns(kind, runs)
    labels = ["case", "method"]
    rows = [
        {"case": run.case, "method": run.method}
        | {name: run.summary.get(column.key) for name, column in columns.items()}
        for run in runs
    ]
    frame = make_frame(rows, labels, columns)
    shown, notes = list(chosen or DEFAULT[kind]), []
    if frame[VERDICT].notna().any():
        shown = [*shown, VERDICT] if VERDICT not in shown else shown
        notes.append(VERDICT_NOTE)
    best = best_values(frame, {name: columns[name] for name in shown}, "case")
    notes = [*judged_notes(columns, shown), *notes, *([BEST_NOTE] if best else [])]
    return Table(frame, columns, shown, best=best, notes=notes)


def group_table(runs: list[Run], kind: str, chosen: list[str], groups: dict[str, str]) -> Table:
    """Mean, spread, median and largest value of every group of runs, the best group marked.

    How many runs pass, warn and fail is shown beyond the columns chosen.

    Args:
        runs: all runs.
        kind: ``runs``, ``validation`` or ``references``.
        chosen: names in :data:`COLUMNS` of that kind; its default ones where empty.
        groups: label -> pattern of ``case/method``.
    """
    numbers = {name: column for name, column in _columns(kind, runs).items() if column.style != "text"}
    columns = {name: column.of_statistics for name, column in numbers.items()} | GROUP
    rows = []
    for label, pattern in groups.items():
        members = [run for run in runs if run.matches(pattern)]
        both = {
            "not converged": sum(not run.converged for run in members),
            VERDICTS: judged_levels(run.summary for run in members),
        }
        for statistic, function in STATISTICS.items():
            row = {"group": label, "runs": len(members), "statistic": statistic} | both
            for name, column in columns.items():
                values = [v for run in members if (v := run.summary.get(column.key)) is not None and v == v]
                if values:
                    row[name] = float(function(values))
            rows.append(row)
    frame = make_frame(rows, ["group", "runs", "statistic"], columns)
    shown = list(chosen or DEFAULT[kind][:7])
    if (frame[VERDICTS] != "").any():
        shown.append(VERDICTS)
    compared = frame[frame["statistic"].isin(COMPARED)]
    best = best_values(compared, {name: columns[name] for name in shown}, "statistic")
    notes = [*judged_notes(columns, shown), *(["Bold: best group."] if best else [])]
    return Table(frame, columns, shown, best=best, notes=notes)
