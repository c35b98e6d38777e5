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
def test_fibres_of_small_blocks_follow_where_large_ones_halve_the_squares_of_a_factor(of_large, follow):
    factor = ByCell(np.zeros((64, 1)), [], 1.0, np.zeros(64, int), of_large=4.0)
    found, left = descent([5.0, of_large, 0.5])
    ended = found.of_blocks([], np.zeros((2, 1)), factor)
    assert (ended.misfit, ended.of_large) == ((0.5 if follow else of_large), of_large)
    assert len(left) == (0 if follow else 1)


def test_a_factor_alone_goes_on_in_small_blocks_and_says_what_large_ones_left():
    found, left = descent([3.0, 1.0])
    ended = found.of_blocks([], np.zeros((1, 1)))
    assert (ended.misfit, ended.of_large, left) == (1.0, 3.0, [])
