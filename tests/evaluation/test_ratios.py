"""How many times as stiff a phase is: between two bounds, or at least so many times."""

import json

import numpy as np
import pytest

from hypernode.evaluation.ratios import beside_unbounded, judge_ratios, ratio_of, ratios
from hypernode.evaluation.spread import Samples, score_spread
from hypernode.explorer.facts import fact
from hypernode.verdict import Level
from tests.evaluation.files import square_mesh

MESH = square_mesh(8)
INSIDE = (np.abs(MESH.centres - 0.5) < 0.2).all(axis=1)
PHASE = INSIDE.astype(int)


def samples(contrast, scatter, count=400):
    """A sheet of two levels; the logarithm of the stiff one scatters."""
    random = np.random.default_rng(0)
    best = np.where(INSIDE, contrast, 1.0)
    drawn = best * np.exp(np.where(INSIDE, scatter * random.normal(size=(count, 1)), 0.0))
    return Samples(best, drawn)


def found(contrast, scatter):
    given = samples(contrast, scatter)
    return ratios(PHASE, given.best, given.values)


def test_a_ratio_that_is_known_lies_between_two_bounds():
    (each,) = found(5.0, 0.05)
    assert each.best == pytest.approx(5.0)
    assert each.least == pytest.approx(5.0 / 1.1, rel=0.01) and each.most == pytest.approx(5.0 / 0.9, rel=0.02)


def test_a_part_that_may_be_rigid_has_a_lower_bound_alone():
    (each,) = found(200.0, 1.5)
    assert each.most is None
    assert each.words.startswith("at least 5")
    told = judge_ratios([each])
    assert told.level is Level.PASSED and "may be rigid" in told.sentence


def test_the_lower_bound_is_that_of_the_compliance_however_stiff_the_part_is_taken_for():
    """A sheet with compliance s seen to 0.01: whatever the fit took for r, two of these are at least 1 / (s + 0.02)."""
    for taken in (1e2, 1e3, 1e5):
        bound = ratio_of(1, taken, 0.01 * taken).least
        assert bound == pytest.approx(1.0 / (1.0 / taken + 0.02))


def test_a_soft_part_has_two_bounds_and_leaves_the_sheet_in_the_spread():
    given = samples(0.02, 0.6)
    phase = 1 - PHASE
    (each,) = ratios(phase, given.best, given.values)
    assert each.phase == 0 and each.best == pytest.approx(0.02) and each.least == 0.0
    assert each.most == pytest.approx(0.02 * 2.2, rel=0.1)
    assert not beside_unbounded(MESH, phase, [each]).any()


def test_a_sheet_whose_cells_all_touch_a_rigid_part_has_a_spread_of_its_own():
    given = samples(200.0, 1.5)
    assert np.isfinite(score_spread(given, None, bounded=np.zeros(len(PHASE), bool)).summary["spread"])


def test_an_uncertain_level_is_no_part_of_the_mean_spread():
    given = samples(2.0, 0.05)
    alone, both = score_spread(given, None), score_spread(given, None, level=0.3 * given.best)
    assert alone.summary["spread"] == both.summary["spread"]
    assert (both.variables["trace_P_spread"] >= 0.3 * given.best).all()


def test_one_phase_has_no_contrast():
    assert ratios(np.zeros_like(PHASE), np.ones(len(PHASE)), np.ones((3, len(PHASE)))) == []
    assert judge_ratios([]).level is Level.NOT_JUDGED


def test_what_may_be_rigid_makes_no_spread_of_the_rest():
    given = samples(200.0, 1.5)
    beside = beside_unbounded(MESH, PHASE, ratios(PHASE, given.best, given.values))
    assert beside[INSIDE].all() and INSIDE.sum() < beside.sum() < len(beside)
    assert score_spread(given, None).summary["spread"] > 0.5
    assert score_spread(given, None, bounded=~beside).summary["spread"] == pytest.approx(0.0, abs=1e-12)


def test_the_ten_numbers_say_at_least_where_there_is_no_upper_bound():
    rigid, known = ([each.stored() for each in found(*given)] for given in ((200.0, 1.5), (5.0, 0.05)))
    assert fact({"inclusion_over_matrix": 187.0, "stiffness_ratios": rigid}, "inclusion_over_matrix").startswith(
        "at least"
    )
    assert fact({"inclusion_over_matrix": 5.0, "stiffness_ratios": known}, "inclusion_over_matrix") == "5.00"
    assert json.loads(json.dumps(rigid)) == rigid
