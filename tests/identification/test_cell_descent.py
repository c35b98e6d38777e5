"""When numbers of small blocks of cells follow those of large ones."""

from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.fem.mesh import rectilinear
from hypernode.identification.stiffness import ByCell, CellDescent

MESH = rectilinear(np.arange(9.0), np.arange(9.0))


def descent(misfits):
    """A descent whose parts end with these misfits, one after the other."""
    test = SimpleNamespace(sheet=SimpleNamespace(mesh=MESH))
    found, left = CellDescent(test, SimpleNamespace(cells=lambda: (None, None)), Constrained(), [0]), list(misfits)
    found._descend = lambda values, guesses, groups, *_: ByCell(values, [], left.pop(0), groups)
    return found, left


@pytest.mark.parametrize(("of_large", "follow"), [(2.0, True), (2.7, True), (2.9, False), (4.0, False)])
def test_fibres_begin_at_a_factor_and_small_blocks_follow_where_large_ones_halve_its_squares(of_large, follow):
    factor = ByCell(np.full((64, 1), 0.3), [], 4.0, np.zeros(64, int))
    found, left = descent([5.0, of_large, 0.5])
    ended = found.of_blocks([], np.array([[0.0, 0.1], [0.0, -0.1]]), factor)
    assert ended.misfit == (0.5 if follow else of_large) and len(left) == (0 if follow else 1)
    np.testing.assert_allclose(ended.values[0], [0.3, -0.1])


def test_a_factor_alone_goes_on_in_small_blocks():
    found, left = descent([3.0, 1.0])
    assert (found.of_blocks([], np.zeros((1, 1))).misfit, left) == (1.0, [])
