"""A field of stiffness is cut into the levels that it is least far from."""

from itertools import combinations

import numpy as np
import pytest

from hypernode.fem.mesh import rectilinear
from hypernode.identification.partition import centres, levels, without_small


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_levels_are_the_best_of_all(count):
    values = np.random.default_rng(count).normal(size=11)
    ordered = np.sort(values)

    def far(cuts):
        return sum(np.abs(part - np.median(part)).sum() for part in np.split(ordered, cuts))

    best = min(far(cuts) for cuts in combinations(range(1, len(values)), count - 1))
    assert np.abs(values[:, None] - levels(values, count)).min(axis=1).sum() == pytest.approx(best)


def test_a_part_of_few_cells_joins_what_is_around_it():
    mesh = rectilinear(np.arange(7.0), np.arange(7.0))
    labels = np.zeros(36, int)
    labels[[7, 8]] = 1
    labels[[21, 22, 27, 28]] = 2
    found = without_small(mesh, labels)
    assert (found[[7, 8]] == 0).all() and (found[[21, 22, 27, 28]] == 2).all()


def test_cells_of_two_numbers_are_parted_where_either_differs():
    random = np.random.default_rng(2)
    true = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]])
    label = np.repeat([0, 1, 2], [60, 25, 15])
    found = centres(true[label] + random.normal(0.0, 0.02, (100, 2)), 3)
    distance = np.linalg.norm(true[:, None] - found, axis=2)
    assert sorted(distance.argmin(axis=1)) == [0, 1, 2] and distance.min(axis=1).max() < 0.02
