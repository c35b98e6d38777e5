"""Terms of a law join and leave by the same evidence; what a candidate knows of its edges serves where it holds."""

import copy
import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.data.believed_noise import BelievedNoise
from hypernode.identification import budgets
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import LawSearch, translated
from hypernode.identification.lines import Lines
from hypernode.identification.trials import Trials
from hypernode.mechanics.loads import make_load
from tests.sheets import believed, observed_coarsely

NOISE, STEPS = 1e-4, [0, 1]
SETTINGS = Constrained(terms=["I1_squared", "I2"], layers=True)
LOAD = make_load("biaxial", [[1.2, 1.05], [1.4, 1.1]])


def one_material(**material):
    """(trials of a homogeneous sheet, one neo-Hookean material for it)."""
    data, _ = observed_coarsely(8, lambda X: np.zeros(len(X)), LOAD, 0.0, **material)
    noise = np.random.default_rng(3).normal(0.0, NOISE, data["u_measured"].shape)
    trials = Trials(believed(data.assign(u_measured=data["u_measured"] + noise), NOISE), SETTINGS, "sheet")
    problem = trials.problem([])
    params = problem.homogeneous.params
    u = dict(enumerate(problem.equilibrium.extension(np.tile(params, (len(problem.mesh.cells), 1)))))
    field = Interfaces.homogeneous(Lines.of(problem.observations.grid, problem.refinement), params)
    return trials, trials.descend("one material", None, problem, field, u, STEPS, budgets.NEAR)


@pytest.fixture(scope="module")
def neo_hookean():
    return one_material()


def with_law(trials, one, *terms):
    """The same material with another law."""
    problem = trials.problem(terms)
    begin = dict(zip(problem.basis.names, problem.homogeneous.params, strict=True))
    field = one.fit.field.with_law(translated(one.fit.field.materials, one.problem, problem, begin))
    return trials.descend(f"with {terms}", one, problem, field, one.u, STEPS, budgets.NEAR)


@pytest.mark.parametrize("term", ["I2", "J"])
def test_a_term_that_explains_nothing_leaves_and_so_does_a_volume_that_changes(neo_hookean, term):
    trials, one = neo_hookean
    assert LawSearch(trials, STEPS, False).plainer(with_law(trials, one, term)).terms == ()


def test_a_volume_that_changes_stays_where_the_test_or_the_configuration_asks_for_it(neo_hookean):
    trials, one = one_material(terms=("J",), values={"log1p_J_area": 0.6, "log1p_J_volume": 0.2})
    kept = with_law(trials, one, "J")
    assert LawSearch(trials, STEPS, False).plainer(kept) is kept
    trials, one = neo_hookean
    kept = with_law(trials, one, "J")
    asked = copy.copy(trials)
    asked.settings = SETTINGS.model_copy(update={"terms": ["J"]})
    assert LawSearch(asked, STEPS, False).plainer(kept) is kept


def test_a_term_that_the_test_asks_for_joins_and_stays():
    trials, one = one_material(terms=("I2",), values={"log1p_I2": 1.0})
    law = LawSearch(trials, STEPS, False)
    kept = law.end(one)
    assert kept.terms == ("I2",)
    assert law.plainer(kept) is kept


def test_of_several_terms_the_one_that_data_tell_least_leaves_first():
    trials, one = one_material(terms=("I2",), values={"log1p_I2": 1.0})
    kept, law = with_law(trials, one, "I2", "fibre"), LawSearch(trials, STEPS, False)
    assert law.plainer(kept).terms == ("I2",)
    assert law.plainer(with_law(trials, one, "fibre", "I2")).terms == ("I2",)


def test_another_law_is_tried_under_what_is_believed_of_errors_by_then(neo_hookean):
    trials, one = neo_hookean
    before = trials.with_terms(one, ("I2",))
    later = dataclasses.replace(one, problem=trials.problem([], floor=NOISE))
    assert trials.with_terms(later, ("I2",)).sigma == later.problem.sigma > before.sigma
    assert trials.with_terms(one, ("I2",)) is before


def test_answers_to_errors_of_edges_serve_the_same_steps_under_the_same_noise(neo_hookean):
    trials, one = neo_hookean
    assert one.edges(trials.problem([], subcells=2), STEPS) is one.fit.edges
    assert one.edges(one.problem, [1]) is None
    measurement = trials.measurement
    louder = Trials(BelievedNoise(factor=2.0).of(measurement), SETTINGS, "sheet")
    assert one.edges(louder.problem([]), STEPS) is None


@pytest.mark.parametrize(
    ("noise", "mostly", "followed"), [(False, False, True), (True, False, False), (False, True, False)]
)
def test_lines_follow_two_laws_before_these_are_compared_where_both_leave_more_than_noise(noise, mostly, followed):
    tried = [SimpleNamespace(leaves_more_than_noise=not noise, leaves_mostly_no_noise=mostly) for _ in range(2)]
    search = LawSearch(None, [0], False, settled=lambda found: ("lines", found))
    assert search._followed(tried) == ([("lines", found) for found in tried] if followed else tried)
    assert search._followed(tried[:1]) == tried[:1]
