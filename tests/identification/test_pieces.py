"""A piece of a material that the cut into parts lost is found again."""

import numpy as np
import pytest

from hypernode.identification.interfaces import Interfaces, Lines
from hypernode.identification.parting import Parting
from hypernode.identification.pieces import with_pieces
from hypernode.identification.settings import STRATEGY
from hypernode.identification.trials import NEAR, Trials, homogeneous_displacement, largest_and_half
from tests.identification.test_interface_search import CELLS, SETTINGS, disc, observed

LEVEL = 2e-5


def sliver(X):
    """Half a cell high and two cells long, at the upper edge."""
    return (X[:, 1] > 1.0 - 0.5 / CELLS) & (np.abs(X[:, 0] - 0.25) < 1.0 / CELLS)


@pytest.mark.parametrize("missed", [True, False])
def test_a_sliver_at_the_edge_becomes_a_piece_where_there_is_one(missed):
    data, _ = observed(lambda X: np.maximum(disc(X), missed * sliver(X)), level=LEVEL)
    trials = Trials(data, SETTINGS, "sheet", STRATEGY)
    problem = trials.plainest()
    steps, lines = largest_and_half(problem), Lines.of(problem.observations.grid, problem.refinement)
    labels = (disc(problem.observations.grid.centres) > 0.5).astype(int)
    plain = Interfaces.homogeneous(lines, problem.homogeneous.params)
    one = trials.descend("one material", None, problem, plain, homogeneous_displacement(problem), steps, NEAR)
    materials = np.tile(problem.homogeneous.params, (2, 1))
    materials[1, 0] += np.log(2.0)
    kept = trials.descend("a disc", one, problem, Interfaces.around(lines, materials, labels), one.u, steps, 2 * NEAR)
    parting = Parting(trials, steps, False)
    found = with_pieces(parting, kept, parting.in_cells(parting.beside(kept)))
    assert (found is not kept) == missed
    if missed:
        above = found.fit.field.distances.reshape(CELLS + 1, CELLS + 1)[-1] > 0.0
        assert above[[2, 3, 4]].any() and not above[6:].any()
        assert found.fit.misfit < 0.6 * kept.fit.misfit
