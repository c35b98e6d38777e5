"""Tables of ensembles: runs of one case that differ in their seeds, and whether their scatter covers their error."""

import json
from fnmatch import fnmatch

import numpy as np

from hypernode.errors import ExpectedError
from hypernode.storage.netcdf import read
from hypernode.tables.columns import Column
from hypernode.tables.runs import GROUP, VERDICTS, judged_levels
from hypernode.tables.table import Table, judged_notes, make_frame
from hypernode.verdict import Ending

COLUMNS = {
    "mean error of members": Column("", "percent", judged_at="prescribed"),
    "error of the mean": Column("", "percent", judged_at="prescribed"),
    "spread": Column("", "percent", judged_at="prescribed"),
    "truth within two spreads": Column("", "share", judged_at="prescribed"),
} | GROUP


class EnsembleError(ExpectedError, ValueError):
    """A group of runs is no ensemble; the message names it and says what it lacks."""


def ensemble_table(evaluations: list[str], groups: dict[str, str]) -> Table:
    """One row a group: error of its members and of their mean, spread, calibration.

    Fields are P at common F, all modes and stretches. The spread is the standard deviation over the members; it is
    calibrated where the truth lies within two spreads of the mean in about 95 % of the places.

    Args:
        evaluations: evaluation files.
        groups: label -> pattern of ``case/method``.

    Raises:
        EnsembleError: a group has fewer than two members with a known truth.
    """
    files = {}
    for path in sorted(evaluations):
        file = read(path)
        run = json.loads(file.attrs["run"])
        files[f"{run['case']}/{run['method']}"] = file
    rows = []
    for label, pattern in groups.items():
        members = [file for run, file in files.items() if fnmatch(run, pattern) and "P_true" in file]
        if len(members) < 2:
            raise EnsembleError(
                f"tables: the ensemble '{label}' ({pattern}) has {len(members)} members with a known truth, and needs "
                "two; widen its pattern, or the table's 'runs'"
            )
        summaries = [json.loads(file.attrs["summary"]) for file in members]
        stopped = sum(summary.get("ending", Ending.CONVERGED) != Ending.CONVERGED for summary in summaries)
        rows.append(
            {"ensemble": label, "runs": len(members)}
            | dict(zip(COLUMNS, _calibration(members), strict=False))
            | {"not converged": stopped, VERDICTS: judged_levels(summaries)}
        )
    frame = make_frame(rows, ["ensemble", "runs"], COLUMNS)
    # Counts of verdicts say more than how many did not converge, which the CSV file has.
    shown = [name for name in COLUMNS if name not in GROUP]
    if (frame[VERDICTS] != "").any():
        shown.append(VERDICTS)
    return Table(frame, COLUMNS, shown, notes=judged_notes(COLUMNS, shown))


def _calibration(members) -> tuple[float, ...]:
    """(error of a member, of the mean, spread: all relative; share of places within two spreads)."""
    P, true = np.stack([file["P_identified"].values for file in members]), members[0]["P_true"].values
    mean, spread = P.mean(axis=0), P.std(axis=0, ddof=1)
    size = np.sqrt(np.mean(true**2))
    return (
        np.mean([np.sqrt(np.mean((member - true) ** 2)) for member in P]) / size,
        np.sqrt(np.mean((mean - true) ** 2)) / size,
        np.sqrt(np.mean(spread**2)) / size,
        np.mean(np.abs(mean - true) <= 2.0 * spread),
    )
