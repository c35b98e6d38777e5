"""Where displacements are not explained is said, and chance makes no such place."""

import copy
import dataclasses

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.fem.mesh import rectilinear
from hypernode.identification.gauss_newton import descend
from hypernode.identification.local_misfit import local_misfit
from hypernode.identification.observations import observe
from hypernode.identification.problem import field_problem
from hypernode.identification.settings import STRATEGY
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square

NOISE = 1e-3
SETTINGS = Constrained(terms=[], iterations=4)
LOAD = make_load("equibiaxial", [1.05, 1.1])


@pytest.fixture(scope="module")
def found():
    data, _, _ = sheet(12, square, LOAD, noise=NOISE, terms=())
    return descend(field_problem(data, SETTINGS), SETTINGS, "square", None, 0.0)


def missed_by(found, error):
    """The same field where it misses what was measured by this much (step, node, 2)."""
    measured = found.problem.observations.u
    states = [dataclasses.replace(state, u=u + e) for state, u, e in zip(found.states, measured, error, strict=True)]
    return local_misfit(dataclasses.replace(found, states=states, linear=None))


def drawn(seed):
    return np.random.default_rng(seed).normal(0.0, NOISE, (2, 169, 2))


def test_around_a_cell_are_the_nodes_of_the_cells_that_touch_it():
    lines = np.arange(6.0)
    around = rectilinear(lines, lines).around().toarray()
    assert around.max() == 1.0
    assert sorted(set(around.sum(axis=1))) == [9.0, 12.0, 16.0]
    assert around[12].sum() == 16.0 and around[0].sum() == 9.0


def test_noise_makes_no_place_that_is_not_explained(found):
    alarms = [missed_by(found, drawn(seed)).unexplained.any() for seed in range(150)]
    assert sum(alarms) <= 2, "one in seven hundred is expected"


def test_every_residual_is_over_the_error_that_is_expected_there(found):
    expected = found.problem.observations.expected * np.where(np.arange(169) % 2, 0.5, 1.0)[:, None]
    observations = dataclasses.replace(found.problem.observations, expected=expected)
    problem = copy.copy(found.problem)
    problem.observations = observations
    objective = dataclasses.replace(found.objective, problem=problem)
    missed = missed_by(dataclasses.replace(found, objective=objective), drawn(2)).residuals
    assert np.nanstd(missed[:, ::2]) == pytest.approx(1.0, abs=0.15)
    assert np.nanstd(missed[:, 1::2]) == pytest.approx(2.0, abs=0.3)


def test_a_place_that_is_missed_is_found_where_it_is_although_the_mean_hides_it(found):
    mesh = found.problem.observations.grid
    inside = (np.abs(mesh.nodes - [0.75, 0.25]) < 0.13).all(axis=1)
    error = drawn(1)
    error[:, inside] += 2.5 * NOISE
    missed = missed_by(found, error)
    near = (np.abs(mesh.centres - [0.75, 0.25]) < 0.3).all(axis=1)
    assert missed.unexplained.any() and not missed.unexplained[~near].any()
    assert missed.values[missed.unexplained].min() > 1.3 > np.median(missed.values)


def test_without_noise_no_place_is_judged():
    data, _, _ = sheet(5, square, LOAD, terms=())
    assert local_misfit(descend(field_problem(data, SETTINGS), SETTINGS, "square", None, 0.0)) is None


@pytest.mark.parametrize("at_lines", [True, False])
def test_where_elements_err_more_than_noise_a_place_is_judged_if_they_do_so_beside_lines_alone(at_lines):
    data, _, _ = sheet(12, square, LOAD, noise=NOISE, terms=())
    observations = observe(data.assign_attrs(mesh="finer"), 1, STRATEGY, floor=2.0 * NOISE, at_lines=at_lines)
    assert not observations.noisy and bool(observations.by_places) is at_lines
