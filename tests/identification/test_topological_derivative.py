"""Cells that would rather be of another material are told, and lines that no descent moves are mended."""

import numpy as np
import pytest

from hypernode.identification import budgets
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.topological_derivative import rather, with_other_cells
from hypernode.identification.trials import Trials, homogeneous_displacement, largest_and_half
from tests.identification.test_interface_search import CELLS, SETTINGS, disc, observed

LEVEL = 2e-5


def nothing(X):
    return np.zeros(len(X))


def sliver(X):
    """Half a cell high and two cells long, at the upper edge."""
    return (X[:, 1] > 1.0 - 0.5 / CELLS) & (np.abs(X[:, 0] - 0.25) < 1.0 / CELLS)


def hole(X):
    """A part of the sheet within the disc."""
    return np.abs(X - [0.48, 0.53]).max(axis=1) < 1.0 / CELLS


def begun(truth, believed):
    """(trials, steps, a candidate of two materials where an inclusion is believed) of a sheet with another one."""
    data, _ = observed(truth, level=LEVEL)
    trials = Trials(data, SETTINGS, "sheet")
    problem = trials.plainest()
    steps, lines = largest_and_half(problem), Lines.of(problem.observations.grid, problem.refinement)
    labels = (believed(problem.observations.grid.centres) > 0.5).astype(int)
    plain = Interfaces.homogeneous(lines, problem.homogeneous.params)
    one = trials.descend("one material", None, problem, plain, homogeneous_displacement(problem), steps, budgets.NEAR)
    materials = np.tile(problem.homogeneous.params, (2, 1))
    materials[1, 0] += np.log(2.0)
    field = Interfaces.around(lines, materials, labels)
    return trials, steps, trials.descend("a disc", one, problem, field, one.u, steps, 2 * budgets.NEAR)


def with_sliver(X):
    return np.maximum(disc(X), sliver(X))


def without_middle(X):
    return disc(X) * ~hole(X)


@pytest.mark.parametrize(
    ("truth", "place", "sign"),
    [(with_sliver, [0.25, 1.0], 1.0), (without_middle, [0.5, 0.5], -1.0)],
    ids=["a piece at the edge", "a hole"],
)
def test_a_piece_of_either_material_is_found_where_no_line_leads(truth, place, sign):
    trials, steps, kept = begun(truth, disc)
    found = with_other_cells(trials, kept, steps, False)
    assert found.level < 0.5 * kept.level
    there = np.linalg.norm(kept.problem.observations.grid.nodes - place, axis=1).argmin()
    before, after = (each.fit.field.distances[0, there] for each in (kept, found))
    assert np.sign(after) == sign == -np.sign(before)


def test_no_cell_changes_where_all_are_right():
    trials, steps, kept = begun(disc, disc)
    test = SeenTest(kept.problem, steps, kept.fit.window)
    labels = rather(test, kept.fit.field, test.with_tangents(kept.fit.field, kept.fit.states))
    assert np.array_equal(labels, kept.fit.field.labels())
    assert with_other_cells(trials, kept, steps, False) is kept
