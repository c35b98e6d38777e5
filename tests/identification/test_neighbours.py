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


@pytest.fixture(scope="module")
def known():
    """(estimate at the true field of two materials, its parameters)."""
    data, mesh, _ = sheet(CELLS, square, make_load("biaxial", STRETCHES), noise=NOISE, terms=())
    found = descend(field_problem(data, SETTINGS), SETTINGS, "sheet", None, (), 1e-4)
    soft, stiff = (np.median(found.params[inside], axis=0) for inside in (~square(mesh.centres), square(mesh.centres)))
    params = np.where(square(mesh.centres)[:, None], stiff, soft)
    return found.at(params), params, mesh


def place(column, row):
    return CELLS * row + column


def test_a_pair_that_shares_a_jump_becomes_one_of_each(known):
    found, params, _ = known
    inner, outer = place(8, 6), place(9, 6)
    shared = params.copy()
    shared[[inner, outer]] = 0.5 * (params[inner] + params[outer])
    moved = moved_by_neighbours(found.at(shared))
    np.testing.assert_allclose(moved, params, atol=1e-12)


def test_a_single_cell_that_is_off_becomes_what_it_lies_in(known):
    found, params, _ = known
    off = params.copy()
    off[place(1, 2), 0] += 0.4
    np.testing.assert_allclose(moved_by_neighbours(found.at(off)), params, atol=1e-12)


def test_the_true_field_is_left_as_it_is(known):
    found, _, _ = known
    assert moved_by_neighbours(found) is None


def test_a_line_of_single_cells_is_part_of_a_phase(known):
    """A stroke that is one cell wide has two neighbours of its kind at each cell but its ends."""
    found, params, _ = known
    stroke = params.copy()
    stroke[[place(column, 1) for column in range(1, 10)]] = params[place(6, 6)]
    moved = moved_by_neighbours(found.at(stroke))
    changed = [] if moved is None else np.flatnonzero((moved != stroke).any(axis=1)).tolist()
    assert set(changed) <= {place(1, 1), place(9, 1)}
