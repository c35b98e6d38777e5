"""What a term promises by a score test is what a descent with it gains, and nothing is promised of nothing."""

import numpy as np
import pytest

from hypernode.identification import budgets, priors
from hypernode.identification.law_search import open_terms, translated, turned
from hypernode.identification.points import Points
from hypernode.identification.score_test import Joined, score_test
from hypernode.identification.term_points import UNITS, TermPoints
from hypernode.mechanics.convex_basis import PARAMETERS, ConvexBasis
from tests.identification.test_law_search import SETTINGS, STEPS, one_material

#: Coefficient that noise of this size tells with certainty, and far below the neo-Hookean one.
WEAK = 0.03


def gain_and_promise(term, **material):
    """(by how much a descent with a term lowers the cost, by how much the score test says that it would)."""
    trials, one = one_material(**material)
    joined = score_test(one, open_terms((), SETTINGS)).joined(term)
    problem = trials.with_terms(one, (term,))
    begun = turned(translated(one.fit.field.materials, one.problem, problem), problem, term)[0]
    found = trials.descend(f"with {term}", one, problem, one.fit.field.with_law(begun), one.u, STEPS, budgets.NEAR)
    scale = one.sigma_left / one.problem.sigma
    return (one.fit.cost - found.fit.cost) / scale**2, joined[0].least(priors.RIDGE)[1]


def test_a_weak_term_gains_what_it_promises():
    gained, promised = gain_and_promise("I2", terms=("I2",), values={"log1p_I2": WEAK})
    assert gained > 10.0, "noise hides the term, so that nothing is tested"
    assert promised == pytest.approx(gained, rel=0.25)


def test_a_term_that_is_not_there_promises_what_chance_makes():
    gained, promised = gain_and_promise("I2")
    assert 0.0 <= promised < 4.0 and gained < promised + 1.0


F = np.array([[1.2, 0.1], [0.0, 0.95]])[:, :, None]
#: Laws that are not neo-Hookean, by their terms, with the terms that may join each.
LAWS = {
    (): (np.zeros(1), ("I1_squared", "I2", "ogden", "fibre")),
    ("I1_squared", "I2"): (np.array([0.3, 0.2, 0.4]), ("ogden", "fibre", "I1_stiffening")),
    ("I2", "fibre"): (np.array([0.3, 0.6, -0.3, 0.2, -2.0]), ("I1_squared", "ogden", "across", "stiffening")),
    ("ogden",): (np.array([0.3, 0.1, 0.2, 0.3]), ("I1_squared", "I2", "fibre")),
}


def stress(law, params):
    return Points(law).stress_alone(F, params[:, None])[..., 0]


@pytest.mark.parametrize("terms", LAWS)
def test_a_law_of_terms_that_are_none_is_the_kept_one(terms):
    kept, (params, others) = ConvexBasis(terms, 1.0), LAWS[terms]
    points = TermPoints(kept, others)
    own, every = stress(kept, params), stress(points.law, points.among(params[:, None])[:, 0])
    assert np.linalg.norm(own - every) < 2e-4 * np.linalg.norm(own)


@pytest.mark.parametrize(("terms", "term"), [(terms, term) for terms in LAWS for term in LAWS[terms][1]])
def test_columns_are_the_derivative_of_the_stress_where_a_term_is_none(terms, term):
    kept, (params, others) = ConvexBasis(terms, 1.0), LAWS[terms]
    points = TermPoints(kept, others)
    columns = points.by_parameters(F, params[:, None])[:, :, points.columns[term], 0]
    for column, weight in zip(np.moveaxis(columns, 2, 0), np.eye(columns.shape[2]), strict=True):
        with_term, without = (law_with(points, term, params, size * weight) for size in (0.02, 0.0))
        difference = (with_term - without) / 0.02
        assert np.linalg.norm(column - difference) < 0.1 * np.linalg.norm(column) + 1e-12


def law_with(points, term, params, coefficients):
    """Stress of the law with one term more in its own numbers, where the others stay."""
    count = len(params)
    begun = points.among(params[:, None]).T
    names = points.law.names
    into = np.vstack([UNITS.T, np.zeros(len(UNITS))]) if term == "fibre" else np.eye(len(coefficients))
    joined = Joined(
        law=points.law,
        materials=begun,
        kept=[names.index(name) for name in points.kept.names],
        new=[names.index(name) for name in PARAMETERS[term]],
        into=into,
        y=params,
        free=np.arange(count),
        own=(np.eye(count), True),
        between=np.zeros((count, len(coefficients))),
        reduced=np.eye(len(coefficients)),
        slope=np.zeros(len(coefficients)),
    )
    _, materials = joined.at(coefficients)
    return stress(points.with_term(term), points.of_term(term, materials)[0])
