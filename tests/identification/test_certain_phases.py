"""Grids of many cells without noise: shares of phases tell which cells are of which material."""

import dataclasses
import gc
import weakref

import numpy as np
import pytest
import scipy.sparse

from hypernode.config.methods import Constrained
from hypernode.data.coarsening import coarsened
from hypernode.identification.certain_phases import of_certain_phases
from hypernode.identification.few_materials import Phases
from hypernode.identification.gauss_newton import descend
from hypernode.identification.objective import NormalEquations
from hypernode.identification.problem import field_problem
from hypernode.identification.settings import STRATEGY
from hypernode.identification.shares import Shares, few_phases, left_open
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from tests.sheets import believed, sheet

LOAD = make_load("equibiaxial", [1.05, 1.1, 1.15])
SETTINGS = Constrained(terms=[])


def odd(X):
    """An inclusion whose sides lie between the lines of the coarse grid."""
    return (np.abs(X - (0.49, 0.56)) < (0.23, 0.17)).all(axis=1)


def both_grids(inclusion, cells=16, terms=()):
    """(problem of a sheet, the field of every second line of its grid, true parameters, mesh)."""
    data, mesh, true = sheet(cells, inclusion, LOAD, terms=terms)
    settings = SETTINGS.model_copy(update={"terms": list(terms)})
    coarse = field_problem(coarsened(data), settings)
    return field_problem(data, settings), descend(coarse, settings, "coarse", None, (), 2e-4), true, mesh


@pytest.fixture(scope="module")
def grids():
    return both_grids(odd)


@pytest.fixture
def shares():
    phases = Phases(np.array([0, 0, 1, 2]), np.array([[0.0, 1.0], [0.5, 2.0], [1.5, -1.0]]))
    return Shares(phases, np.array([0, 0, 3]), np.array([1, 2, 0]), np.array([0.2, 0.3, 0.4]))


def test_parameters_of_shares_are_what_the_phases_have_and_their_derivatives_the_differences(shares):
    materials = shares.phases.materials
    np.testing.assert_allclose(shares.params[0], 0.5 * materials[0] + 0.2 * materials[1] + 0.3 * materials[2])
    np.testing.assert_allclose(shares.params[2], materials[1])
    change, rng = 1e-3, np.random.default_rng(0)
    by_share, by_material = rng.normal(size=3), rng.normal(size=materials.shape)
    moved = shares.changed(materials, shares.share + change * by_share).params - shares.params
    np.testing.assert_allclose(moved.ravel(), change * (shares.by_shares @ by_share), atol=1e-12)
    moved = shares.changed(materials + change * by_material, shares.share).params - shares.params
    np.testing.assert_allclose(moved.ravel(), change * (shares.by_materials @ by_material.ravel()), atol=1e-12)


def test_no_share_is_below_none_and_no_cell_has_more_than_all(shares):
    changed = shares.changed(shares.phases.materials, np.array([0.9, 0.6, -0.2]))
    np.testing.assert_allclose(changed.share, [0.6, 0.4, 0.0])
    np.testing.assert_array_equal(changed.most.labels, [1, 0, 1, 2])
    assert changed.free(np.array([1.0, -1.0, 1.0])).tolist() == [True, True, False]


def test_open_are_the_cells_near_a_coarse_interface_and_they_begin_as_stiff_as_it_has_them(grids):
    problem, coarse, true, mesh = grids
    labels = few_phases(coarse, SETTINGS.jump_scale)
    assert labels.max() == 1
    params = coarse.params[np.repeat(np.repeat(np.arange(64).reshape(8, 8), 2, axis=0), 2, axis=1).ravel()]
    mixed = left_open(problem, params, coarse, SETTINGS.jump_scale)
    stiff = true[:, 0] > true[:, 0].mean()
    closed = np.setdiff1d(np.arange(len(mesh.cells)), mixed.cell)
    higher = mixed.phases.materials[mixed.phases.labels[closed], 0] > mixed.phases.materials[:, 0].mean()
    assert 0 < len(closed) < len(mesh.cells) and np.array_equal(higher, stiff[closed])
    within = (mixed.share > 0.0) & (mixed.share < 1.0)
    np.testing.assert_allclose(mixed.params[mixed.cell[within]], params[mixed.cell[within]], atol=1e-9)


def test_every_cell_finds_its_material_where_coarse_cells_are_cut(grids):
    problem, coarse, true, _ = grids
    found = of_certain_phases(problem, problem, SETTINGS, coarse, "odd")
    assert found.material_count == 2 and not found.ambiguous
    assert np.abs(found.params - true).max() < 1e-3
    assert len(found.history) > len(coarse.history)


def test_materials_have_no_more_terms_than_they_need(grids):
    """On the coarse grid terms may stand for interfaces that cut cells."""
    plain, _, true, _ = grids
    data, _, _ = sheet(16, odd, LOAD, terms=())
    richer = SETTINGS.model_copy(update={"terms": ["I1_squared"]})
    coarse = descend(field_problem(coarsened(data), richer), richer, "coarse", None, (), 2e-4)
    found = of_certain_phases(field_problem(data, richer), plain, richer, coarse, "odd")
    assert found.complete and found.basis.terms == ()
    assert np.abs(found.params - true).max() < 1e-3


def test_neither_noise_nor_gradual_stiffness_nor_one_material_is_made_of_shares(grids):
    problem, coarse, _, _ = grids
    data = believed(sheet(16, odd, LOAD, terms=())[0], 7e-4)
    noisy = field_problem(data, SETTINGS)
    assert of_certain_phases(noisy, noisy, SETTINGS, coarse, "noisy") is None
    for inclusion in (lambda X: X[:, 0], lambda X: 0.0 * X[:, 0]):
        problem, coarse, _, _ = both_grids(inclusion, cells=8)
        assert of_certain_phases(problem, problem, SETTINGS, coarse, "other") is None


def test_phases_that_do_not_explain_a_test_are_where_a_descent_begins():
    """Two materials of slopes that are no jumps: the free field has them."""

    def sloping(X):
        return odd(X) + 0.05 * X[:, 0]

    data, _, true = sheet(16, sloping, LOAD, terms=())
    found = identify(data, SETTINGS, "sloping", dataclasses.replace(STRATEGY, most_cells_at_once=100))
    assert found.phases is None and found.unexplained < 1.0
    assert np.abs(found.params - true).max() < 0.02


@pytest.mark.slow
def test_what_is_identified_on_a_grid_of_many_cells_is_of_the_phases_that_explain_it():
    data, _, true = sheet(16, odd, make_load("equibiaxial", [1.1, 1.2]))
    settings = Constrained(terms=["I1_squared"])
    found = identify(data, settings, "odd", dataclasses.replace(STRATEGY, most_cells_at_once=100))
    assert found.material_count == 2
    assert np.abs(found.params - true).max() < 0.02


def test_equations_that_are_done_with_leave_memory_at_once():
    """Whatever their products refer to is large, and garbage is collected seldom."""

    class Linear:
        def curvature(self, change):
            return change

    linear = Linear()
    seen, count = weakref.ref(linear), 6
    gc.disable()
    try:
        B, R = np.tile(np.eye(1), (count, 1, 1)), scipy.sparse.identity(count, format="csr")
        system = NormalEquations(linear.curvature, R, B, np.ones(count), None, STRATEGY)
        system.solve(np.arange(count, dtype=float), 1e-6, 10)
        del system, linear
        assert seen() is None
    finally:
        gc.enable()
