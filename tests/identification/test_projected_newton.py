"""Steps of a few numbers, some of which have bounds."""

import numpy as np
import pytest

from hypernode.identification import budgets, numerics
from hypernode.identification.projected_newton import projected_steps

FREE = np.array([[-np.inf] * 2, [np.inf] * 2])
POSITIVE = np.array([[0.0, -np.inf], [np.inf] * 2])


def first(x, gradient, curvature, bounds=FREE, floor=(0.0, 0.0)):
    """(where the first step leads, what it should gain)."""
    arrays = (np.asarray(each, dtype=float) for each in (x, gradient, curvature, bounds, floor))
    return next(projected_steps(*arrays))[:2]


def test_without_bounds_the_first_step_is_newtons_and_gains_what_a_quadratic_says():
    A, x, goal = np.array([[2.0, 0.5], [0.5, 1.0]]), np.array([0.3, -0.2]), np.array([0.1, 0.1])
    reached, gain = first(x, A @ (x - goal), A)
    np.testing.assert_allclose(reached, goal)
    assert gain == pytest.approx(0.5 * (x - goal) @ A @ (x - goal))


def test_a_number_at_its_least_value_stays_and_the_others_go_to_their_best_beside_it():
    A, x, goal = np.array([[2.0, 0.9], [0.9, 1.0]]), np.array([0.0, 0.4]), np.array([-0.5, 0.1])
    gradient = A @ (x - goal)
    assert gradient[0] > 0.0
    reached, _ = first(x, gradient, A, bounds=POSITIVE)
    np.testing.assert_allclose(reached, [0.0, x[1] - gradient[1] / A[1, 1]])


def test_what_has_no_slope_at_its_least_value_holds_up_no_other_number():
    gradient, A = np.array([5.0, 0.4]), np.diag([1e-9, 1.0])
    held_up, _ = first([0.0, 0.0], gradient, A)
    assert abs(held_up[1]) < 1e-6
    reached, _ = first([0.0, 0.0], gradient, A, bounds=POSITIVE)
    np.testing.assert_allclose(reached, [0.0, -0.4])


def test_a_number_at_its_least_value_leaves_it_where_the_cost_falls_upwards():
    reached, _ = first([0.0, 0.0], [-0.3, 0.0], np.eye(2), bounds=POSITIVE)
    np.testing.assert_allclose(reached, [0.3, 0.0])


def test_a_number_at_its_largest_value_stays_and_the_others_go_without_it():
    bounds = np.array([[-np.inf] * 2, [1.0, np.inf]])
    reached, _ = first([1.0, 0.0], [-0.5, -0.2], np.array([[2.0, 0.9], [0.9, 1.0]]), bounds=bounds)
    np.testing.assert_allclose(reached, [1.0, 0.2])
    reached, _ = first([1.0, 0.0], [0.5, 0.0], np.eye(2), bounds=bounds)
    np.testing.assert_allclose(reached, [0.5, 0.0])


def test_later_steps_are_shorter_or_more_damped_and_none_is_longer_than_the_largest():
    x, gradient = np.zeros(2), np.array([-50.0, 1.0])
    steps = [reached for reached, _, _ in projected_steps(x, gradient, np.eye(2), FREE, np.zeros(2))]
    lengths = np.abs(steps).max(axis=1)
    assert lengths[0] == numerics.LARGEST_STEP and lengths[-1] < lengths[0]
    assert len(steps) == budgets.CLIPPED_TRIALS * len(numerics.DAMPING_SHARES)


def test_a_step_after_a_damped_one_begins_with_the_damping_that_is_asked_for():
    given = np.zeros(2), np.array([-0.5, 0.1]), np.eye(2), FREE, np.zeros(2)
    every = list(projected_steps(*given))
    later = list(projected_steps(*given, 2))
    assert [number for _, _, number in later] == [number for _, _, number in every if number >= 2]
    np.testing.assert_array_equal(later[0][0], next(reached for reached, _, number in every if number == 2))
