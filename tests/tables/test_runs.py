"""What tables say of several runs together."""

import numpy as np
import pytest

from hypernode.storage.netcdf import write
from hypernode.tables.runs import ensemble_rows

SHAPE = (4, 2, 500, 2, 2)


def evaluations(folder, members, true):
    attributes = {"units": {"length": "1", "stress": "Pa", "force": "Pa", "energy": "Pa"}}
    paths = []
    for index, P in enumerate(members):
        path = folder / f"case/m{index}/evaluation.nc"
        path.parent.mkdir(parents=True)
        write(str(path), {"P_identified": P, "P_true": true}, "evaluation", attributes, parents=[])
        paths.append(str(path))
    return paths


def test_the_spread_of_an_ensemble_that_scatters_about_the_truth_covers_it(tmp_path):
    rng = np.random.default_rng(0)
    true = np.ones(SHAPE)
    members = [true + rng.normal(0.0, 0.1, SHAPE) for _ in range(8)]
    (row,) = ensemble_rows(evaluations(tmp_path, members, true), {"eight": "case/*"})
    assert row["runs"] == "8"
    assert float(row["error, mean of members"]) == pytest.approx(0.1, rel=0.05)
    assert float(row["error of the mean"]) == pytest.approx(0.1 / 8**0.5, rel=0.05)
    assert float(row["spread"]) == pytest.approx(0.1, rel=0.05)
    assert float(row["truth within two spreads"]) > 0.99


def test_a_common_error_of_all_members_is_not_covered(tmp_path):
    rng = np.random.default_rng(1)
    true = np.ones(SHAPE)
    members = [true + 0.5 + rng.normal(0.0, 0.05, SHAPE) for _ in range(3)]
    (row,) = ensemble_rows(evaluations(tmp_path, members, true), {"biased": "case/*"})
    assert float(row["truth within two spreads"]) < 0.05


def test_an_ensemble_of_one_is_refused(tmp_path):
    with pytest.raises(ValueError, match="has 1 members"):
        ensemble_rows(evaluations(tmp_path, [np.ones(SHAPE)], np.ones(SHAPE)), {"one": "case/*"})
