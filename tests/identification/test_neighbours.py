"""Cells that a test cannot tell apart become what their neighbours are, and no others do."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.identification.gauss_newton import descend
from hypernode.identification.neighbours import moved_by_neighbours
from hypernode.identification.problem import field_problem
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square

# A descent to a whole field comes first.
pytestmark = pytest.mark.slow
CELLS, NOISE = 12, 2e-3
SETTINGS = Constrained(terms=["I1_squared"], iterations=25)
STRETCHES = [[1.05, 1.05], [1.1, 1.1], [1.15, 1.15]]


def stroke(X):
    """One cell wide, across the sheet below its square."""
    return square(X) | ((X[:, 1] > 1 / CELLS) & (X[:, 1] < 2 / CELLS) & (np.abs(X[:, 0] - 0.5) < 0.4))


def of_two_materials(inclusion):
    """(estimate at the true field of a sheet, its parameters)."""
    data, mesh, _ = sheet(CELLS, inclusion, make_load("biaxial", STRETCHES), noise=NOISE, terms=())
    found = descend(field_problem(data, SETTINGS), SETTINGS, "sheet", None, (), 1e-4)
    inside = inclusion(mesh.centres)
    params = np.where(
        inside[:, None], np.median(found.params[inside], axis=0), np.median(found.params[~inside], axis=0)
    )
    return found.at(params), params


@pytest.fixture(scope="module")
def known():
    return of_two_materials(square)


def place(column, row):
    return CELLS * row + column


def test_a_pair_that_shares_a_jump_becomes_one_of_each(known):
    found, params = known
    inner, outer = place(8, 6), place(9, 6)
    shared = params.copy()
    shared[[inner, outer]] = 0.5 * (params[inner] + params[outer])
    moved = moved_by_neighbours(found.at(shared))
    np.testing.assert_allclose(moved, params, atol=1e-12)


def test_a_single_cell_that_is_off_becomes_what_it_lies_in(known):
    found, params = known
    off = params.copy()
    off[place(1, 2), 0] += 0.4
    np.testing.assert_allclose(moved_by_neighbours(found.at(off)), params, atol=1e-12)


def test_the_true_field_is_left_as_it_is(known):
    found, _ = known
    assert moved_by_neighbours(found) is None


def test_a_line_of_single_cells_that_the_test_shows_stays():
    found, _ = of_two_materials(stroke)
    assert moved_by_neighbours(found) is None
