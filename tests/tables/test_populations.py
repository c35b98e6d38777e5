"""A table of a population says how its groups differ: the middle and the worst sheet, and how many are believed."""

import numpy as np
import xarray as xr

from hypernode.tables.populations import population_table

LEVELS = ["pass", "pass", "warn", "fail"]


def collection():
    labels = {"geometry": ["disc", "disc", "disc", "X"], "inclusion": ["stiff"] * 4, "matrix": ["soft"] * 4}
    data = {key: ("sheet", np.array(values)) for key, values in (labels | {"level": LEVELS}).items()}
    data["score.stress_error"] = ("sheet", np.array([0.01, 0.02, 0.09, 0.5]))
    data["score.dice"] = ("sheet", np.array([0.9, 0.8, 0.1, np.nan]))
    data["score.phases_found"] = ("sheet", np.array([1.0, 2.0, 2.0, 1.0]))
    return xr.Dataset(data)


def cell(table, column, geometry, statistic):
    frame = table.frame
    return frame[(frame["geometry"] == geometry) & (frame["statistic"] == statistic)][column].item()


def test_the_worst_error_is_the_largest_and_the_worst_overlap_the_smallest():
    table = population_table(collection())
    assert cell(table, "stress error", "disc", "median") == 0.02
    assert cell(table, "stress error", "disc", "worst") == 0.09
    assert cell(table, "Dice", "disc", "worst") == 0.1
    assert np.isnan(cell(table, "Dice", "X", "median")), "no sheet of the group has the number"


def test_the_middle_of_counts_may_lie_between_two():
    table = population_table(collection())
    assert cell(table, "phases found", "all", "median") == 1.5


def test_verdicts_are_counted_by_group_and_over_all_sheets():
    table = population_table(collection())
    assert cell(table, "verdicts", "disc", "median") == "2 pass, 1 warn"
    assert cell(table, "verdicts", "all", "worst") == "2 pass, 1 warn, 1 fail"
    assert [cell(table, "sheets", name, "worst") for name in ("disc", "X", "all")] == [3, 1, 4]
    assert "verdicts" in table.shown
