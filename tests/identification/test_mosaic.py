"""A sheet whose cells are each of one material: which cells, which law, and with no statement of whose mesh it is."""

import dataclasses

import numpy as np
import pytest
import scipy.sparse

from hypernode.config.methods import Constrained
from hypernode.data.coarsening import coarsened
from hypernode.identification import budgets
from hypernode.identification.finer_grid import on_measured_grid
from hypernode.identification.interface_numbers import held_of_materials
from hypernode.identification.lines import Lines
from hypernode.identification.mosaic import Mosaic
from hypernode.identification.problem import field_problem
from hypernode.identification.promising import promising
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.strategy import of_parts
from hypernode.identification.topological_derivative import loads_of_changes, rather
from hypernode.identification.trials import Trials
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import make_load
from tests.sheets import SCALE, sheet, square

SETTINGS = Constrained(terms=["I1_squared"], layers=True)
LOAD = make_load("equibiaxial", [1.1, 1.2])


def stress_error(found, true):
    """Of the stress of all cells at an equibiaxial stretch of 1.2."""
    F = np.diag([1.2, 1.2])[:, :, None]
    P = found.basis.stress(F, found.by_parts[:, 0])
    wanted = ConvexBasis((), SCALE).stress(F, true.T)
    return np.linalg.norm(P - wanted) / np.linalg.norm(wanted)


@pytest.mark.parametrize("mesh", ["measured_grid", pytest.param("finer", marks=pytest.mark.slow)])
def test_whole_cells_are_found_exactly_whether_or_not_their_mesh_is_stated(mesh):
    data, grid, true = sheet(12, square, LOAD, terms=())
    found = of_parts(data.assign_attrs(mesh=mesh), SETTINGS, "square").found
    inside = square(grid.centres)
    assert found.material_count == 2 and not found.layered
    assert np.array_equal(found.labels == found.labels[inside][0], inside)
    assert stress_error(found, true) < 1e-3


@pytest.mark.slow
def test_noise_that_a_stranger_may_have_moves_no_cell():
    data, grid, true = sheet(12, square, LOAD, noise=5e-4, terms=())
    found = of_parts(data, SETTINGS, "square").found
    inside = square(grid.centres)
    assert found.material_count == 2
    assert np.array_equal(found.labels == found.labels[inside][0], inside)
    assert stress_error(found, true) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize(
    "noise, move, error", [(0.0, "cells of 2 materials", 1e-3), (1e-4, "on the measured grid", 0.02)]
)
def test_a_grid_of_many_cells_begins_from_every_second_line_and_finds_the_same(noise, move, error, monkeypatch):
    data, grid, true = sheet(16, square, LOAD, noise=noise, terms=())
    monkeypatch.setattr(budgets, "MOST_CELLS_AT_ONCE", 100)
    found = of_parts(data, SETTINGS, "square").found
    inside = square(grid.centres)
    assert np.array_equal(found.labels == found.labels[inside][0], inside)
    assert stress_error(found, true) < error
    assert move in [row["move"] for row in found.trace.rows(found.trial)]


@pytest.fixture(scope="module")
def wrong_cells():
    """(a test, whole cells some of which are of the wrong material, its states, the right labels)."""
    data, grid, _ = sheet(12, square, LOAD)
    problem = field_problem(data, Constrained(terms=[]))
    inside = square(grid.centres)
    wrong = inside.copy()
    # Two cells of each side of the contour, far apart.
    edge = np.flatnonzero(inside)[[0, -1]]
    outside = np.flatnonzero(~inside & (np.abs(grid.centres - 0.5).max(axis=1) < 0.5))
    beside = outside[np.argsort(np.abs(grid.centres[outside] - grid.centres[edge[0]]).sum(axis=1))[:1]]
    wrong[edge], wrong[beside] = False, True
    lines = Lines.of(problem.observations.grid, problem.refinement)
    level = problem.homogeneous.params[0]
    field = Mosaic.of(lines, np.array([[level - 0.2], [level - 0.2 + np.log(2.0)]]), wrong.astype(int))
    test = SeenTest(problem, [0, 1])
    guesses = problem.equilibrium.extension(np.tile(problem.homogeneous.params, (len(wrong), 1)))
    return test, field, test.states(field, guesses), inside


def test_cells_that_were_given_the_wrong_material_change_it_at_once(wrong_cells):
    test, field, states, inside = wrong_cells
    assert np.array_equal(rather(test, field, states), inside)


def test_changes_that_promise_something_are_few_and_the_right_ones_are_among_them(wrong_cells):
    test, field, states, inside = wrong_cells
    options = field.options()
    materials = test.loads(field, states, [])
    loads = [
        scipy.sparse.hstack([loads_of_changes(test, field, u, options), load], format="csr")
        for (u, _, _), load in zip(states, materials, strict=True)
    ]
    some = promising(test, states, loads, np.zeros(len(options.cell)), np.diag(held_of_materials(field)))
    wrong = np.flatnonzero(field.of_cells != inside)
    assert np.isin(wrong, options.cell[some]).all()
    assert some.sum() < 0.7 * len(some)


def test_a_material_that_is_nowhere_is_left_out(wrong_cells):
    _, field, _, inside = wrong_cells
    three = dataclasses.replace(field, materials=np.vstack([field.materials[:1], field.materials]), given=2 * inside)
    labels = np.where(inside, 2, 0)
    left = three.with_labels(labels)
    assert left.count == 2
    np.testing.assert_array_equal(left.materials[left.of_cells], three.materials[labels])
    np.testing.assert_array_equal(left.given, left.of_cells)


def test_the_adjoint_is_the_transposed_jacobian(wrong_cells):
    test, field, states, _ = wrong_cells
    loads, random = test.loads(field, states, []), np.random.default_rng(0)
    jacobians = [answer.over(0.1) for answer in test.answers(states, loads)]
    columns = [random.normal(size=(len(J), 3)) for J in jacobians]
    wanted = sum(J.T @ each for J, each in zip(jacobians, columns, strict=True))
    np.testing.assert_allclose(test.adjoint(states, loads, 0.1, columns), wanted, rtol=1e-9)


def test_whole_cells_of_a_coarser_grid_are_where_lines_of_the_measured_one_begin():
    data, grid, _ = sheet(16, square, LOAD, terms=())
    settings = SETTINGS.model_copy(update={"terms": []})
    coarse, fine = (Trials(each, settings, "square") for each in (coarsened(data), data))
    problem = coarse.problem([])
    lines, labels = Lines.of(problem.observations.grid, problem.refinement), square(problem.mesh.centres).astype(int)
    level = problem.homogeneous.params[0]
    field = Mosaic.of(lines, np.array([[level], [level + 0.5]]), labels)
    u = dict(enumerate(problem.equilibrium.extension(np.tile(problem.homogeneous.params, (len(labels), 1)))))
    found = on_measured_grid(fine, coarse.descend("cells", None, problem, field, u, [0, 1], 5), [0, 1], False)
    assert found.fit.field.count == 2 and len(found.fit.field.distances) == 1
    assert (found.fit.field.labels() == square(grid.centres)).mean() > 0.95


def test_labels_that_lines_told_cost_as_much_as_these_and_every_other_label_more():
    data, grid, _ = sheet(8, square, LOAD)
    problem = field_problem(data, Constrained(terms=[]))
    lines, labels = Lines.of(problem.observations.grid, problem.refinement), square(grid.centres).astype(int)
    alone = Mosaic.of(lines, np.zeros((2, 1)), labels)
    told = dataclasses.replace(alone, given=labels, code=7.0)
    other = labels.copy()
    other[np.flatnonzero(labels)[0]] = 0
    changed = dataclasses.replace(told, of_cells=other)
    assert told.places == 7.0 < changed.places
    longer = dataclasses.replace(alone, of_cells=np.where(np.arange(len(labels)) == 0, 1, labels))
    # Two sides of a cell in a corner, and the place of another region.
    assert longer.places - alone.places == pytest.approx(2.0 * np.log(2.0) + np.log(len(labels)))
