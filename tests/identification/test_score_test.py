"""What a term promises by a score test is what a descent with it gains, and nothing is promised of nothing."""

import numpy as np
import pytest

from hypernode.identification.law_search import open_terms, translated, turned
from hypernode.identification.points import Points
from hypernode.identification.score_test import score_test
from hypernode.identification.term_points import TermPoints
from hypernode.identification.trials import NEAR
from hypernode.mechanics.convex_basis import ConvexBasis
from tests.identification.test_law_search import SETTINGS, STEPS, one_material

#: Coefficient that noise of this size tells with certainty, and far below the neo-Hookean one.
WEAK = 0.03


def gain_and_promise(term, **material):
    """(by how much a descent with a term lowers the cost, by how much the score test says that it would)."""
    trials, one = one_material(**material)
    joined = score_test(one, open_terms((), SETTINGS)).joined(term)
    problem = trials.with_terms(one, (term,))
    begun = turned(translated(one.fit.field.materials, one.problem, problem), problem, term)[0]
    found = trials.descend(f"with {term}", one, problem, one.fit.field.with_law(begun), one.u, STEPS, NEAR)
    scale = one.sigma_left / one.problem.sigma
    return (one.fit.cost - found.fit.cost) / scale**2, joined[0].least(one.problem.strategy.ridge)[1]


def test_a_weak_term_gains_what_it_promises():
    gained, promised = gain_and_promise("I2", terms=("I2",), values={"log1p_I2": WEAK})
    assert gained > 10.0, "noise hides the term, so that nothing is tested"
    assert promised == pytest.approx(gained, rel=0.25)


def test_a_term_that_is_not_there_promises_what_chance_makes():
    gained, promised = gain_and_promise("I2")
    assert 0.0 <= promised < 4.0 and gained < promised + 1.0


@pytest.mark.parametrize("term", ["I1_squared", "I2", "ogden", "fibre"])
def test_columns_are_the_derivative_of_the_stress_where_a_term_is_none(term):
    kept = ConvexBasis((), 1.0)
    points, F = TermPoints(kept, (term,)), np.array([[1.2, 0.1], [0.0, 0.95]])[:, :, None]
    columns, params = points.by_parameters(F, np.zeros((1, 1))), points.among(np.zeros((1, 1)))
    law = Points(points.law)
    coefficient = 0.02 if term != "fibre" else 1.0
    for number, (where, values) in enumerate(points._begun):
        begun = params.copy()
        begun[where] = coefficient * (values / np.linalg.norm(values))[:, None]
        difference = (law.stress_alone(F, begun) - law.stress_alone(F, params)) / coefficient
        size = np.linalg.norm(columns[:, :, number])
        assert np.linalg.norm(columns[:, :, number] - difference) < 0.1 * size + 1e-12


def test_a_law_of_terms_that_are_none_is_the_kept_one():
    kept = ConvexBasis(("I1_squared",), 1.0)
    points, F = TermPoints(kept, ("I2", "fibre")), np.array([[1.2, 0.1], [0.0, 0.95]])[:, :, None]
    params = np.array([[0.3], [0.2]])
    own, every = Points(kept).stress_alone(F, params), Points(points.law).stress_alone(F, points.among(params))
    assert np.linalg.norm(own - every) < 2e-3 * np.linalg.norm(own)
