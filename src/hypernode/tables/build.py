"""From what a configuration asks for to the table."""

from hypernode.tables.ensembles import ensemble_table
from hypernode.tables.runs import group_table, read_runs, run_table
from hypernode.tables.settings import settings_table
from hypernode.tables.table import Table
from hypernode.tables.timing import timing_table


def build_table(files: list[str], settings: dict) -> Table:
    """The table of a kind.

    Args:
        files: result files of the runs in it, or benchmark records of the jobs.
        settings: ``kind`` (runs, validation, references, ensemble, timing or settings), with ``columns`` and
            ``groups``, or ``entries``.
    """
    kind = settings["kind"]
    if kind == "settings":
        return settings_table(settings["entries"])
    if kind == "timing":
        return timing_table(files)
    if kind == "ensemble":
        return ensemble_table(files, settings["groups"])
    runs = read_runs(files)
    if settings["groups"]:
        return group_table(runs, kind, settings["columns"], settings["groups"])
    return run_table(runs, kind, settings["columns"])
