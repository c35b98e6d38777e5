"""Fields of a few phases: where they are the likelier ones, and contours that end where they cost least."""

import dataclasses

import numpy as np
import pytest
import scipy.sparse

from hypernode.config.methods import Constrained
from hypernode.fem.mesh import rectilinear
from hypernode.identification.contours import ContourModel, doubtful, options_at_contours, relabelled
from hypernode.identification.foresight import Foresight
from hypernode.identification.gauss_newton import descend
from hypernode.identification.left_out import predict_left_out
from hypernode.identification.phases import in_phases, on_finer_grid, one_by_one
from hypernode.identification.problem import field_problem
from hypernode.identification.regulariser import JumpCost, Regulariser
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from tests.sheets import believed, observed_coarsely, sheet, square

LINES = np.linspace(0.0, 1.0, 7)
MESH = rectilinear(LINES, LINES)


def contours(seed):
    """(labels, options, gradient, curvature, lengths, cost between phases) of a random sheet of three phases."""
    random = np.random.default_rng(seed)
    labels = (MESH.centres[:, 0] > 0.3).astype(int) + (MESH.centres[:, 1] > 0.6)
    options = options_at_contours(MESH, labels)
    columns = random.normal(size=(60, len(options.cell)))
    gradient = columns.T @ random.normal(size=60) * 10.0
    regulariser = Regulariser(MESH, ("log_level",), 1 / 6, lambda params: (params[:, 0], np.ones_like(params)))
    cost = JumpCost(scale=0.05, isotropic=True)
    between = 25.0 * regulariser.between(np.array([[0.0], [0.7], [1.1]]), cost)
    return labels, options, gradient, columns.T @ columns, regulariser.lengths(cost), between


def cost_of(labels, first, options, gradient, curvature, lengths, between):
    taken = (labels[options.cell] == options.label).astype(float)
    pairs = scipy.sparse.triu(lengths).tocoo()
    contour = pairs.data @ between[labels[pairs.row], labels[pairs.col]]
    return gradient @ taken + 0.5 * taken @ curvature @ taken + contour


@pytest.mark.parametrize("seed", range(5))
def test_contours_end_where_no_cell_and_no_two_neighbours_would_lower_the_cost(seed):
    labels, options, *model = contours(seed)
    end = relabelled(labels, ContourModel(options, *model), gain=1e-9)
    reached = cost_of(end, labels, options, *model)
    assert reached < cost_of(labels, labels, options, *model)

    def changed(*numbers):
        other = end.copy()
        for k in numbers:
            cell = options.cell[k]
            other[cell] = labels[cell] if end[cell] == options.label[k] else options.label[k]
        return cost_of(other, labels, options, *model)

    free = [k for k in range(len(options.cell)) if end[options.cell[k]] in (labels[options.cell[k]], options.label[k])]
    assert min(changed(k) for k in free) > reached - 1e-6
    pairs = [pair for pair in options.pairs if set(pair) <= set(free) and len(set(options.cell[pair])) == 2]
    assert min(changed(*pair) for pair in pairs) > reached - 1e-6


@pytest.mark.parametrize("seed", range(3))
def test_doubtful_cells_are_those_whose_change_alone_costs_least(seed):
    labels, options, *model = contours(seed)
    start = cost_of(labels, labels, options, *model)
    change = []
    for cell, label in zip(options.cell, options.label, strict=True):
        other = labels.copy()
        other[cell] = label
        change.append(cost_of(other, labels, options, *model) - start)
    most = np.median(change)
    chosen = doubtful(labels, ContourModel(options, *model), most)
    np.testing.assert_allclose(np.array(change)[chosen], sorted(each for each in change if each < most))


def test_a_cell_may_become_what_it_touches_and_nothing_else():
    labels = np.zeros(36, int)
    labels[14] = 1
    options = options_at_contours(MESH, labels)
    assert sorted(options.cell) == [7, 8, 9, 13, 14, 15, 19, 20, 21]
    assert all(label == (cell != 14) for cell, label in zip(options.cell, options.label, strict=True))
    assert len(options_at_contours(MESH, np.zeros(36, int)).cell) == 0


def test_what_contours_cost_is_what_the_penalty_of_the_field_is():
    labels, _, _, _, lengths, _ = contours(0)
    regulariser = Regulariser(MESH, ("log_level",), 1 / 6, lambda params: (params[:, 0], np.ones_like(params)))
    cost, materials = JumpCost(scale=0.05, isotropic=True), np.array([[0.0], [0.7], [1.1]])
    pairs = scipy.sparse.triu(lengths).tocoo()
    contour = pairs.data @ regulariser.between(materials, cost)[labels[pairs.row], labels[pairs.col]]
    flat = regulariser.value(np.zeros((36, 1)), cost)
    assert contour == pytest.approx(regulariser.value(materials[labels], cost) - flat)


def descended(inclusion, settings, cells=12, noise=7e-4):
    load = make_load("equibiaxial", [1.05, 1.1, 1.15])
    data, mesh, true = sheet(cells, inclusion, load, noise=noise, terms=tuple(settings.terms))
    found = descend(field_problem(data, settings), settings, "sheet", None, (), settings.tolerance)
    return found, mesh, true


def test_a_noisy_sheet_of_two_materials_is_two_phases_with_every_cell_where_it_belongs():
    settings = Constrained(terms=["I1_squared"])
    found, mesh, true = descended(square, settings)
    phases = in_phases(found, "sheet")
    assert phases.phases is not None and len(phases.phases.materials) == 2
    inside = square(mesh.centres)
    assert np.array_equal(phases.phases.labels, inside.astype(int))
    assert phases.information_criterion < found.information_criterion

    def error(each):
        return np.sqrt(np.mean((each.params[:, 0] - true[:, 0]) ** 2))

    assert error(phases) < 0.7 * error(found)


@pytest.fixture(scope="module")
def two_phases():
    """A noisy sheet of two materials, identified as such."""
    return in_phases(descended(square, Constrained(terms=["I1_squared"]), cells=10)[0], "sheet")


def test_cells_that_are_wrong_for_themselves_come_back_in_one_round(two_phases):
    right = two_phases.phases.labels
    cells = np.flatnonzero(right == 1)[[0, -1]]
    labels = right.copy()
    labels[cells] = 0
    wrong = two_phases.at(two_phases.phases.materials[labels])
    wrong = dataclasses.replace(wrong, phases=dataclasses.replace(two_phases.phases, labels=labels))
    # The third is right as it is.
    back = one_by_one(wrong, np.append(cells, 0), np.array([1, 1, 1]))
    np.testing.assert_array_equal(back.phases.labels, right)
    assert back.cost == pytest.approx(two_phases.cost, abs=two_phases.problem.strategy.phase_gain)
    assert one_by_one(two_phases, cells, np.array([0, 0])) is None


def test_a_changed_cell_is_foreseen_to_gain_what_its_misfit_says_and_the_materials_that_follow(two_phases):
    found = two_phases
    foresight, labels = Foresight(found), found.phases.labels.copy()
    assert 0.0 <= foresight.gain(labels) < found.problem.strategy.phase_gain, "the materials have settled"
    cell = int(np.flatnonzero(labels == 1)[0])
    labels[cell] = 0
    changed = dataclasses.replace(found.phases, labels=labels)
    alone = found.cost - found.at(changed.params).cost
    # The same by materials that are moved in earnest, in the direction that is best to first order.
    gain, best = foresight.gain(labels), -np.inf
    for factor in (0.98, 0.99, 1.0, 1.01):
        materials = changed.materials + np.log(factor) * (np.arange(2)[:, None] == 1) * (np.arange(2) == 0)
        moved = found.at(dataclasses.replace(changed, materials=materials).params)
        best = max(best, found.cost - moved.cost)
    assert alone < -found.problem.strategy.phase_foresight
    assert alone <= best <= gain + 0.1 * abs(gain) and gain < -found.problem.strategy.phase_foresight


def test_a_left_out_step_of_phases_is_predicted_as_their_materials_alone_would_answer(two_phases):
    phases = two_phases
    linear, columns = phases.linear, phases.phases.columns.toarray()
    load = linear.adjoint(np.random.default_rng(1).normal(size=linear.shape[0]))
    J = linear.product(columns)
    answer = phases.answers(linear.curvature).solve_columns(load[:, None], 0.0, 0)[:, 0]
    ridge = columns.T @ (phases.objective.ridge[:, None] * columns)
    assert answer == pytest.approx(columns @ np.linalg.solve(J.T @ J + ridge, columns.T @ load), rel=1e-6)
    predicted = predict_left_out(phases)
    assert abs(predicted.displacement - 1.0) < 4.0 / np.sqrt(2.0 * predicted.observed) and predicted.force < 3.0


def test_stiffness_that_changes_from_place_to_place_is_no_phases():
    settings = Constrained(terms=[])
    found, _, _ = descended(lambda X: X[:, 0], settings)
    assert in_phases(found, "slope").trial is found.trial and found.phases is None


def test_a_noisy_sheet_of_one_material_is_one_phase():
    settings = Constrained(terms=["I1_squared"])
    found, _, true = descended(lambda X: np.zeros(len(X)), settings)
    phases = in_phases(found, "plain")
    assert len(phases.phases.materials) == 1 and np.abs(phases.params[:, 0] - true[:, 0]).max() < 0.02


def test_three_stiffnesses_are_three_phases():
    settings = Constrained(terms=[])
    found, mesh, _ = descended(lambda X: 0.5 * (X[:, 0] > 0.3) + 0.5 * (X[:, 0] > 0.7), settings)
    phases = in_phases(found, "bands").phases
    assert len(phases.materials) == 3
    order = np.argsort(np.argsort(phases.materials[:, 0]))
    expected = (mesh.centres[:, 0] > 0.3).astype(int) + (mesh.centres[:, 0] > 0.7)
    assert np.array_equal(order[phases.labels], expected)


def test_without_noise_no_phases_are_looked_for():
    settings = Constrained(terms=[])
    found, _, _ = descended(square, settings, noise=0.0)
    assert in_phases(found, "clean").trial is found.trial


def test_a_finer_grid_takes_over_phases_and_finds_its_own_contour():
    settings = Constrained(terms=[])
    coarse, _, _ = descended(lambda X: X[:, 0] > 0.3, settings, cells=8)
    load = make_load("equibiaxial", [1.05, 1.1, 1.15])
    data, mesh, _ = sheet(16, lambda X: X[:, 0] > 0.3, load, noise=7e-4, terms=())
    found = on_finer_grid(field_problem(data, settings), settings, coarse, "fine")
    assert np.array_equal(found.phases.labels, (mesh.centres[:, 0] > 0.3).astype(int))
    assert len(found.history) > len(coarse.history)


@pytest.mark.slow
def test_what_is_identified_of_a_noisy_sheet_of_two_materials_are_its_phases():
    data, mesh, _ = sheet(12, square, make_load("equibiaxial", [1.1, 1.2]), noise=7e-4)
    found = identify(data, Constrained(terms=["I1_squared"]), "square")
    assert found.phases is not None and len(np.unique(found.params, axis=0)) == 2
    assert np.array_equal(found.phases.labels, square(mesh.centres).astype(int))


def test_no_phases_are_looked_for_where_interfaces_may_cut_cells():
    settings = Constrained(terms=[])
    data, _ = observed_coarsely(8, square, make_load("equibiaxial", [1.05, 1.1]), 0.0)
    problem = field_problem(believed(data, 1e-3).assign_attrs(mesh="finer"), settings)
    assert problem.sharp
    found = descend(problem, settings, "sheet", None, (), settings.tolerance)
    assert in_phases(found, "sheet").trial is found.trial
