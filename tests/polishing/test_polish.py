"""A hyper-network under the finite-element constraint: exact derivatives, and what is kept of a polishing."""

import dataclasses

import numpy as np
import pytest

from hypernode.config.methods import Constrained, Polish
from hypernode.identification.objective import white_residuals
from hypernode.polishing.held_out import Misfit, held_out_steps, why_not_better
from hypernode.polishing.objective import weight_objective
from hypernode.polishing.polish import polish
from tests.polishing.sheets import FORCE_NOISE, LAW, other_weights, problem_of_field

#: Standard deviation of the weights of another material from those of the network.
MOVED = 0.25
STRETCHES = (1.08, 1.14, 1.2)
#: Differences need a sharper equilibrium than a descent does.
SHARP = 1e-11
CONSTRAINED = Constrained(force_noise=FORCE_NOISE)


@pytest.mark.slow
def test_the_gradient_by_the_weights_is_that_of_differences_of_the_cost():
    """The cost is solved anew at every weight; the gradient comes from one adjoint and the network's own derivative."""
    problem, field = problem_of_field(4, "clamped_y", (1.1, 1.2), 1e-3, tolerance=SHARP)
    objective = weight_objective(problem, field, CONSTRAINED, Polish())
    weights = other_weights(field, 0.05)
    guesses = list(problem.observations.u)
    at = objective.linearise(weights, problem.equilibrium.states(field.params(weights), guesses), problem.sigma)
    change = np.random.default_rng(5).normal(size=weights.size)

    def cost(t):
        moved = weights + t * change
        return objective.value(moved, problem.equilibrium.states(field.params(moved), guesses), at.linear)

    h = 1e-5
    assert at.gradient @ change == pytest.approx((cost(h) - cost(-h)) / (2.0 * h), rel=1e-5)


def test_the_curvature_is_that_of_residuals_to_first_order_and_positive():
    problem, field = problem_of_field(4, "clamped_y", (1.1, 1.2), 1e-3, tolerance=SHARP)
    objective = dataclasses.replace(weight_objective(problem, field, CONSTRAINED, Polish()), regulariser_weight=0.0)
    guesses = list(problem.observations.u)

    def states(weights):
        return problem.equilibrium.states(field.params(weights), guesses)

    at = objective.linearise(field.start, states(field.start), problem.sigma)
    a, b = np.random.default_rng(6).normal(size=(2, field.start.size))
    assert a @ at.curvature(b) == pytest.approx(b @ at.curvature(a), rel=1e-9)
    h, moved = 1e-5, []
    for sign in (1.0, -1.0):
        residual = white_residuals(problem, states(field.start + sign * h * a), problem.sigma, at.linear)
        moved.append(np.concatenate(residual))
    slope = (moved[0] - moved[1]) / (2.0 * h)
    _, near = objective.nearness.linearise(field.params(field.start))
    pushed = field.push(field.start, a)
    expected = slope @ slope + pushed @ near(pushed) + objective.ridge * a @ a
    assert a @ at.curvature(a) == pytest.approx(expected, rel=1e-4)


def test_every_second_step_is_held_out_but_never_the_largest_load():
    held = held_out_steps(np.array([0, 0, 0, 0, 0, 1, 1, 2]))
    assert held.tolist() == [False, True, False, True, False, True, False, False]


def test_steps_of_a_problem_are_as_uncertain_as_in_the_whole_test_and_miss_as_much():
    problem, field = problem_of_field(6, "equibiaxial", STRETCHES, 1e-3)
    states = problem.equilibrium.states(field.params(field.start), list(problem.observations.u))
    part, steps = problem.of_steps(np.array([0, 2])), [0, 2]
    assert part.sigma == problem.sigma and {force.step for force in part.forces} == {0, 1}
    u, f = problem.residuals(states)
    u_part, f_part = part.residuals([states[step] for step in steps])
    for step, each in zip(steps, u_part, strict=True):
        np.testing.assert_array_equal(each, u[step])
    np.testing.assert_allclose(f_part, [r for r, force in zip(f, problem.forces, strict=True) if force.step != 1])


def test_a_network_that_explains_its_test_to_the_noise_is_left_as_it_is():
    problem, field = problem_of_field(6, "equibiaxial", STRETCHES, 1e-3)
    found = polish(problem, field, CONSTRAINED, Polish(), list(problem.observations.u), "sheet")
    assert not found.kept and found.ending is None and "explained to their noise" in found.reason
    np.testing.assert_array_equal(found.weights, field.start)
    # By chance the root mean square of four forces exceeds one by no more than two of its standard deviations.
    assert found.misfits["used"]["before"]["displacement"] < 1.05
    assert found.misfits["used"]["before"]["force"] < 1.0 + 2.0 / np.sqrt(8.0)


@pytest.mark.slow
def test_a_network_of_another_material_is_polished_until_steps_it_has_not_seen_agree():
    """Used data are then missed by little but noise, and held-out ones by less than half of what they were."""
    problem, field = problem_of_field(6, "equibiaxial", STRETCHES, 1e-3, moved=MOVED)
    settings = Polish(iterations=20, deviation=0.5)
    found = polish(problem, field, CONSTRAINED, settings, list(problem.observations.u), "sheet")
    used, held = found.misfits["used"], found.misfits["held_out"]
    assert found.kept and not np.array_equal(found.weights, field.start)
    assert used["before"]["force"] > 10.0 and used["after"]["force"] < 2.5
    for name in ("displacement", "force"):
        assert held["after"][name] <= max(held["before"][name], 1.0)
    assert held["after"]["force"] < 0.5 * held["before"]["force"]
    # What is kept is what is stored: the network in the precision of its file gives the states that were judged.
    stored = field.stored(found.weights)
    np.testing.assert_array_equal(found.weights, stored)
    states = problem.equilibrium.states(field.params(stored), list(found.u))
    np.testing.assert_allclose(np.stack([state.u for state in states]), found.u, atol=1e-6)


def test_without_iterations_a_network_is_judged_and_left_as_it_is():
    problem, field = problem_of_field(6, "equibiaxial", STRETCHES, 1e-3, moved=MOVED)
    found = polish(problem, field, CONSTRAINED, Polish(iterations=0), list(problem.observations.u), "sheet")
    assert not found.kept and "after" not in found.misfits["held_out"]
    assert found.misfits["held_out"]["before"]["force"] > 10.0


def test_a_test_of_one_step_holds_nothing_out_and_so_nothing_is_polished():
    problem, field = problem_of_field(6, "equibiaxial", STRETCHES, 1e-3, moved=MOVED)
    single = problem.of_steps(np.array([2]))
    found = polish(single, field, CONSTRAINED, Polish(), list(single.observations.u), "sheet")
    assert not found.kept and "held out" in found.reason and not found.held_out.any()


@pytest.mark.parametrize(
    ("after", "kept"),
    [
        ((0.5, 0.0), True),
        ((0.5, 3.0), False),
        ((1.4, 0.0), False),
        ((1.0, 1.0), False),
    ],
)
def test_held_out_steps_must_agree_better_in_displacements_and_forces_by_more_than_chance(after, kept):
    """Before, displacements are missed by 1.2 and forces by one of their noise."""
    before = Misfit(np.full(1000, 1.2), np.full(4, 1.0))
    found = Misfit(np.full(1000, after[0]), np.full(4, after[1]))
    if after == (1.0, 1.0):
        # As much less as noise alone makes of predictions that differ by so much.
        random = np.random.default_rng(7).normal(size=1000)
        before = Misfit(random, np.ones(4))
        found = Misfit(before.displacement + np.random.default_rng(8).normal(0.0, 0.02, 1000), np.ones(4))
    assert (not why_not_better(before, found)) == kept


def test_the_level_of_a_network_is_a_factor_on_its_stress():
    params = np.concatenate([[0.0], np.full(LAW.node.size, 0.2)])
    F = np.array([[1.2, 0.1], [0.0, 0.95]])
    P = np.asarray(LAW.stress(F, params))
    np.testing.assert_allclose(LAW.stress(F, params + np.eye(len(params))[0] * np.log(3.0)), 3.0 * P, rtol=1e-12)
