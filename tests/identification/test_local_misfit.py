"""Where displacements are not explained is said, and chance makes no such place."""

import copy
import dataclasses

import numpy as np
import pytest
import scipy.sparse

from hypernode.config.methods import Constrained
from hypernode.fem.mesh import rectilinear
from hypernode.identification.gauss_newton import descend
from hypernode.identification.local_misfit import beyond_edges, local_misfit
from hypernode.identification.observations import observe
from hypernode.identification.problem import field_problem
from hypernode.identification.window_error import changed_by_window
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
    observations = observe(data.assign_attrs(mesh="finer"), 1, floor=2.0 * NOISE, at_lines=at_lines)
    assert not observations.noisy and bool(observations.by_places) is at_lines


def seen_through_a_window(**attrs):
    data, _, _ = sheet(12, square, LOAD, noise=1e-5, window=0.2, terms=())
    return observe(data.assign_attrs(attrs), 1, floor=0.0)


def test_a_point_of_a_cut_edge_may_be_off_by_what_the_window_changes_most_anywhere():
    observations = seen_through_a_window(outline="cut")
    changed = changed_by_window(observations.grid, observations.u, 0.2, "average").max(axis=1)
    for errors, most, boundary in zip(beyond_edges(observations), changed, observations.boundaries, strict=True):
        assert errors.shape[1] == boundary.mask.sum() and len(errors.data) == errors.shape[1]
        assert set(errors.data) == set(most)


@pytest.mark.parametrize("attrs", [{"outline": "edge"}, {"outline": "cut", "correlation_window": 0.0}])
def test_an_edge_of_the_sheet_or_one_seen_point_by_point_is_not_off_by_what_is_beyond(attrs):
    assert beyond_edges(seen_through_a_window(**attrs)) == []


def test_what_errors_of_edges_make_of_residuals_is_taken_out_and_the_rest_stays(found):
    errors = [
        scipy.sparse.identity(338, format="csr")[:, boundary.prescribed]
        for boundary in found.problem.observations.boundaries
    ]
    linear, rows = found.linear, found.linear.of_steps([0])
    answered = linear.steps[0].whiten(linear.steps[0]._answered(errors[0]))
    by_edges, other = np.zeros((2, linear.shape[0]))
    by_edges[rows] = 1e6 * answered[:, 3] / np.linalg.norm(answered[:, 3])
    assert np.linalg.norm(linear.without(by_edges, errors)) < 1e-2 * np.linalg.norm(by_edges)
    drawn = np.random.default_rng(0).normal(size=rows.sum())
    other[rows] = drawn - answered @ np.linalg.lstsq(answered, drawn)[0]
    assert linear.without(other, errors) == pytest.approx(other, abs=1e-6)
