"""Load steps that are left out are predicted from the others as well as noise and the field's spread allow."""

import numpy as np
import pytest
import scipy.linalg

from hypernode.config.methods import Constrained
from hypernode.identification.gauss_newton import descend
from hypernode.identification.left_out import largest_steps, predict_left_out
from hypernode.identification.problem import field_problem
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square

LOAD = make_load("biaxial", [[1.04, 1.05], [1.09, 1.1], [1.14, 1.15]])
SETTINGS = Constrained(terms=[], iterations=12, force_noise=0.003)


def identified(data, settings=SETTINGS):
    return descend(field_problem(data, settings), settings, "square", None, settings.tolerance)


def test_the_largest_step_of_every_load_case_that_has_several_is_left_out():
    assert largest_steps(np.array([0, 0, 0, 1, 2, 2]), np.array([0.1, 0.3, 0.2, 0.3, 0.1, 0.2])) == [1, 5]
    assert largest_steps(np.array([0]), np.array([0.1])) == []


def test_a_field_of_the_sheets_own_law_predicts_a_step_by_chance_and_one_of_another_law_does_not():
    predicted = {}
    for terms, values in (((), {}), (("I1_squared",), {"log1p_I1_squared": 0.9})):
        data, _, _ = sheet(6, square, LOAD, noise=3e-4, terms=terms, values=values.items())
        predicted[terms] = predict_left_out(identified(data))
    own, other = predicted.values()
    assert own.steps == [2] and own.displacement < 1.0 + 3.0 / np.sqrt(2.0 * own.directions) and own.force < 3.0
    assert other.force > 3.0


@pytest.mark.slow
def test_over_many_noises_what_is_expected_of_a_left_out_step_is_what_is_found():
    squares = []
    for seed in range(12):
        data, _, _ = sheet(6, square, LOAD, noise=2e-3, terms=(), seed=seed)
        force = data["edge_force"]
        data["edge_force"] = force * (1.0 + 0.003 * np.random.default_rng(seed).normal(size=force.shape))
        found = predict_left_out(identified(data))
        squares.append([found.displacement**2, found.force**2])
    # Means over twelve draws of as many directions and forces as a step has.
    by_chance = 3.0 * np.sqrt(2.0 / (12 * np.array([found.directions, 2])))
    assert np.all(np.abs(np.mean(squares, axis=0) - 1.0) < by_chance + 0.05)


def test_the_prediction_is_that_of_one_newton_step_without_these_data():
    data, _, _ = sheet(5, square, LOAD, noise=1e-3, terms=())
    found = identified(data)
    linear, objective = found.linear, found.objective
    J, white = (
        linear.product(np.eye(found.params.size)),
        np.concatenate(objective.residuals(found.states, linear.sigma, linear)),
    )
    left = linear.of_steps([2])
    R, _, derivative = objective.regulariser.roots(found.params, objective.jump_cost)
    root = R @ scipy.linalg.block_diag(*derivative)
    H = J[~left].T @ J[~left] + objective.regulariser_weight * root.T @ root + np.diag(objective.ridge)
    error = white[left] + J[left] @ np.linalg.solve(H, J[left].T @ white[left])
    covariance = np.eye(left.sum()) + J[left] @ np.linalg.solve(H, J[left].T)
    predicted, forces = predict_left_out(found), len(found.problem.forces) // 3
    wanted = error[-forces:] @ np.linalg.solve(covariance[-forces:, -forces:], error[-forces:])
    assert predicted.force == pytest.approx(np.sqrt(wanted / forces), rel=0.05)
    usual = max(1.0, np.sqrt(np.mean(white[: -len(found.problem.forces)][~left[: -len(found.problem.forces)]] ** 2)))
    of_u, e = covariance[:-forces, :-forces], error[:-forces]
    rest = np.linalg.solve(of_u, e)
    directions = np.trace(np.eye(len(e)) - np.linalg.inv(of_u))
    assert predicted.directions == pytest.approx(directions, rel=0.15)
    assert predicted.displacement**2 == pytest.approx((e - rest) @ rest / usual**2 / predicted.directions, rel=0.1)


@pytest.mark.slow
def test_nothing_is_predicted_without_noise_or_of_a_single_step():
    data, _, _ = sheet(5, square, make_load("biaxial", [[1.04, 1.05], [1.09, 1.1]]), terms=())
    assert predict_left_out(identified(data)) is None
    data, _, _ = sheet(5, square, make_load("biaxial", [[1.09, 1.1]]), noise=1e-3, terms=())
    assert predict_left_out(identified(data)) is None
