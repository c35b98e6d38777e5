"""The tables of config/accuracy.yaml within their bounds; `make accuracy` makes them first."""

from pathlib import Path

import pandas as pd
import pytest

TABLES = Path(__file__).resolve().parents[2] / "results" / "tables"
#: Group -> largest median and largest value of the stress error [-] of its runs. Of one test they are what was aimed
#: at (docs/decisions/0056). Points gone wrong are taken up by single cells, and the verdict warns.
BOUNDS = {
    "ring, one test": (0.010, 0.020),
    "X, one test": (0.010, 0.020),
    "P, one test": (0.010, 0.020),
    "ring, three tests": (0.008, 0.015),
    "X, three tests": (0.008, 0.015),
    "P, three tests": (0.008, 0.015),
    "drifting load cell": (0.030, 0.040),
    "mistaken points": (0.054, 0.060),
}


@pytest.fixture(scope="module")
def table(request):
    if not request.config.getoption("--accuracy"):
        pytest.skip("accuracy is held with --accuracy, after a run of config/accuracy.yaml")
    return lambda name: pd.read_csv(TABLES / f"{name}.csv")


def column(frame, name):
    """The column whose head begins with a name, before its unit."""
    return next(head for head in frame.columns if head.partition(" [")[0] == name)


@pytest.mark.parametrize("group", BOUNDS)
def test_noisy_tests_are_as_accurate_as_stated_in_the_middle_and_at_worst(table, group):
    frame = table("noisy")
    here = frame[frame["group"] == group].set_index("statistic")[column(frame, "stress error")]
    median, worst = BOUNDS[group]
    assert here["median"] <= median
    assert here["largest"] <= worst


@pytest.mark.parametrize("shape", ["ring", "X", "P"])
def test_three_tests_are_no_worse_than_one(table, shape):
    frame = table("noisy")
    error = frame[frame["statistic"] == "median"].set_index("group")[column(frame, "stress error")]
    assert error[f"{shape}, three tests"] <= 1.1 * error[f"{shape}, one test"]


def test_of_twenty_homogeneous_sheets_one_at_most_has_an_inclusion(table):
    frame = table("detection")
    homogeneous = frame[frame["case"].str.startswith("homogeneous")]
    assert len(homogeneous) == 20
    assert (homogeneous[column(frame, "inclusion")] == "distinguishable").sum() <= 1


def test_contrasts_of_a_fifth_and_more_are_always_seen(table):
    frame = table("detection")
    for contrast in ("1_2", "1_5"):
        discs = frame[frame["case"].str.startswith(f"disc_neo_hookean_{contrast}_n")]
        assert len(discs) == 5 and (discs[column(frame, "inclusion")] == "distinguishable").all()
