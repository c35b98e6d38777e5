"""The scatter of an ensemble covers its error where members are independent, and only there."""

import numpy as np
import pytest

from hypernode.tables.ensembles import EnsembleError, ensemble_table
from tests.tables.files import evaluation

SHAPE = (4, 2, 500, 2, 2)


def table(folder, members, true, ends=()):
    ends = dict(enumerate(ends))
    paths = [
        evaluation(
            folder, "case", f"m{k}", {"ending": "converged"} | ends.get(k, {}), {"P_identified": P, "P_true": true}
        )
        for k, P in enumerate(members)
    ]
    return ensemble_table(paths, {"all": "case/*"})


def test_the_spread_of_an_ensemble_that_scatters_about_the_truth_covers_it(tmp_path):
    rng = np.random.default_rng(0)
    true = np.ones(SHAPE)
    (row,) = table(tmp_path, [true + rng.normal(0.0, 0.1, SHAPE) for _ in range(8)], true).frame.to_dict("records")
    assert row["runs"] == 8
    assert row["mean error of members"] == pytest.approx(0.1, rel=0.05)
    assert row["error of the mean"] == pytest.approx(0.1 / 8**0.5, rel=0.05)
    assert row["spread"] == pytest.approx(0.1, rel=0.05)
    assert row["truth within two spreads"] > 0.99


def test_a_common_error_of_all_members_is_not_covered(tmp_path):
    rng = np.random.default_rng(1)
    true = np.ones(SHAPE)
    members = [true + 0.5 + rng.normal(0.0, 0.05, SHAPE) for _ in range(3)]
    (row,) = table(tmp_path, members, true).frame.to_dict("records")
    assert row["truth within two spreads"] < 0.05


def test_an_ensemble_counts_the_verdicts_of_its_members(tmp_path):
    members = [np.full(SHAPE, value) for value in (0.9, 1.1)]
    assert "verdicts" not in table(tmp_path / "a", members, np.ones(SHAPE)).shown
    ends = [{"verdict": "pass"}, {"ending": "stagnated", "verdict": "fail: not converged"}]
    judged = table(tmp_path / "b", members, np.ones(SHAPE), ends)
    assert judged.shown[-1] == "verdicts" and judged.frame["verdicts"].tolist() == ["1 pass, 1 fail"]
    assert judged.frame["not converged"].tolist() == [1]


def test_an_ensemble_of_one_is_refused(tmp_path):
    with pytest.raises(EnsembleError, match=r"'all' \(case/\*\) has 1 members"):
        table(tmp_path, [np.ones(SHAPE)], np.ones(SHAPE))
