"""What numbers of every cell say of materials."""

from types import SimpleNamespace

import numpy as np

from hypernode.fem.mesh import rectilinear
from hypernode.identification import beside
from hypernode.identification.beside import Beside


def test_the_middle_of_three_levels_joins_either_of_the_others(monkeypatch):
    mesh = rectilinear(np.arange(13.0), np.arange(5.0))
    column = np.round(mesh.centres[:, 0] - 0.5).astype(int)
    # Six columns in the middle, four soft ones, two stiff ones; parts are numbered by their size.
    level = np.select([column < 4, column >= 10], [1, 2], 0)
    stiffness = np.array([[0.1], [-0.2], [0.4]])

    def parts(self, count, squared=False):
        if count == 3:
            return level, stiffness
        # A cut in two that takes the middle for a part of what is stiff.
        return (level == 1).astype(int), np.array([[0.2], [-0.2]])

    monkeypatch.setattr(Beside, "parts", parts)
    monkeypatch.setattr(beside, "stiffness_of", lambda problem, materials: materials[:, 0])
    known = SimpleNamespace(lines=SimpleNamespace(grid=SimpleNamespace(mesh=mesh)))
    first, other = Beside(None, known, [0], None, None, [], {}).cuts(2)
    assert first[0] == "" and "stiffest of three" in other[0]
    np.testing.assert_array_equal(other[1], level == 2)
    np.testing.assert_array_equal(other[2], [[0.1], [0.4]])
